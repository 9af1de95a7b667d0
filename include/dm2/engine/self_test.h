/* The self-test at the start of a program: does this build, on this machine, compute as IEEE 754 says?
 *
 * The fingerprint hashes what the generator and the engine themselves make of a small built-in deck, because
 * a compiler may fuse or reorder operations in one function and leave the same operations as they are in
 * another. Every conforming build of a release has the same fingerprint, the constant below. Client and
 * server compare the fingerprint before they compute together; a state holds the fingerprint of its program.
 */
#ifndef DM2_ENGINE_SELF_TEST_H
#define DM2_ENGINE_SELF_TEST_H

#include <stdint.h>

#include "dm2/base/status.h"

/* The fingerprint of this release, which `make fingerprint` renews after a change of results. */
#define SELF_TEST_FINGERPRINT 0xaac3560e4ba7bb78U

/* Computes the fingerprint of this build: of the operations of fingerprint_compute (base/fingerprint.h), and
 * of the elements and pairs of a turned lattice and a polycrystal, at the start and after 5 steps.
 * DM2_MEMORY; the errors of the engine where arithmetic is so wrong that a step fails. */
enum dm2_status self_test_compute(uint64_t *fingerprint, struct dm2_error *err);

/* Compares the fingerprint of this build with SELF_TEST_FINGERPRINT. DM2_PROTOCOL: they differ, or the engine
 * fails; the text names both. DM2_MEMORY. */
enum dm2_status self_test_check(struct dm2_error *err);

#endif

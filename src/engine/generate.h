/* The generator: the elements of every body, in one global order that gives them their ids. Every server runs
 * the whole generator and keeps the elements of its own cells, so that no element is sent at the start
 * (paper, section 5.1). */
#ifndef DM2_ENGINE_GENERATE_H
#define DM2_ENGINE_GENERATE_H

#include "dm2/base/status.h"
#include "dm2/engine/element.h"
#include "dm2/engine/model.h"

/* Receives one element; the record belongs to the generator. Any status but DM2_OK ends the generation. */
typedef enum dm2_status (*element_sink)(void *context, const struct element *element, struct dm2_error *err);

/* Calls sink for each element that the deck makes, ids one after another from config.start.next_id on, body
 * by body in deck order, grain by grain, row by row, along the row; grains are numbered in the same order.
 * DM2_DECK where a powder cannot be packed, a body has no element, or the elements or the grains are more
 * than 2^32 - 1; DM2_MEMORY; and the status of a sink that ended the generation. Needs the kinds and the
 * reaction of the model. */
enum dm2_status generate_elements(const struct model *model, element_sink sink, void *context,
                                  struct dm2_error *err);

/* The material that the element of this id and grain starts with in its body. */
int generate_material(const struct body_config *b, uint32_t id, uint32_t grain);

/* The probes of regions that hold a place, of an element of a body with this spacing; both in cm. */
uint8_t generate_probes(const struct config *c, const double r[2], double spacing);

#endif

/* Refuses builds whose flags change the results of + - * / and sqrt on doubles, as far as the compiler tells
 * by a macro. The self-test at the start of a program (engine/self_test.h) refuses the other such builds. */
#ifndef DM2_BASE_EXACT_BUILD_H
#define DM2_BASE_EXACT_BUILD_H

#include <float.h>

#ifdef __FAST_MATH__
#error "dm2 computes as IEEE 754 says: build without -ffast-math and -Ofast"
#endif
#if defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__ > 0
#error "dm2 computes as IEEE 754 says: build without -ffinite-math-only, -ffast-math and -Ofast"
#endif
#ifdef __ASSOCIATIVE_MATH__
#error "dm2 computes as IEEE 754 says: build without -fassociative-math"
#endif
#ifdef __RECIPROCAL_MATH__
#error "dm2 computes as IEEE 754 says: build without -freciprocal-math"
#endif
#ifdef __NO_SIGNED_ZEROS__
#error "dm2 computes as IEEE 754 says: build without -fno-signed-zeros and -funsafe-math-optimizations"
#endif
#ifdef __ROUNDING_MATH__
#error "dm2 computes as IEEE 754 says, in rounding to nearest: build without -frounding-math"
#endif
#if !defined FLT_EVAL_METHOD || FLT_EVAL_METHOD != 0
#error "dm2 rounds every result to a double: build without -mfpmath=387, on a 32-bit x86 with -mfpmath=sse"
#endif

#endif

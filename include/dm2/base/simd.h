/* Four doubles at a time, in the vector types that gcc and clang share. Every operation is the scalar
 * operation in each lane, so a loop over vectors gives the bits of the plain loop. Operations on vectors are
 * macros, because vectors are not passed to functions.
 *
 * DM2_WIDE marks a function that is compiled for AVX2 and for the plain instruction set; the program chooses
 * the version when it starts (glibc on x86-64). Elsewhere the compiler translates vectors to the instructions
 * of its target. */
#ifndef DM2_BASE_SIMD_H
#define DM2_BASE_SIMD_H

#include <stdint.h>

typedef double simd_real __attribute__((vector_size(32)));
typedef int64_t simd_int __attribute__((vector_size(32)));
enum { SIMD_LANES = 4 };

/* Lane by lane: a where the comparison `mask` holds, else b. */
#define SIMD_CHOOSE(mask, a, b) ((simd_real)(((simd_int)(a) & (mask)) | ((simd_int)(b) & ~(mask))))

/* |x| of each lane. */
#define SIMD_MAGNITUDE(x)                                                                                    \
    ((simd_real)((simd_int)(x) & (simd_int){INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX}))

/* The nearest integer of each lane, halves to even, for |x| < 2^51. Adding 1.5 * 2^52 leaves the rounded
 * integer in the low bits of the double, and works in vectors, where a conversion to 64-bit integers would
 * not. */
static const double simd_shifter = 0x1.8p52;
#define SIMD_FIXED(x) ((simd_int)((x) + simd_shifter) - (simd_int)((simd_real){0.0} + simd_shifter))

/* Two doubles, the components of one element's vector. */
typedef double simd_real2 __attribute__((vector_size(16)));
typedef int64_t simd_int2 __attribute__((vector_size(16)));

/* Components c and c + 1, c even, of an array that mem_alloc aligned. */
#define SIMD_AT(array, c) (*(const simd_real2 *)(const void *)((array) + (c)))

union simd_int_halves {
    simd_int all;
    simd_int2 half[2];
};

/* SIMD_JOIN: two halves as one vector. SIMD_EVEN, SIMD_ODD: lanes 0 and 2, or 1 and 3, of a and b in turn: a0
 * b0 a2 b2. SIMD_LOW, SIMD_HIGH: the first, or second, halves of a and of b. */
#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define DM2_HAS_SHUFFLE
#endif
#endif
#ifdef DM2_HAS_SHUFFLE
#define SIMD_JOIN(low, high) __builtin_shufflevector(low, high, 0, 1, 2, 3)
#define SIMD_EVEN(a, b)      __builtin_shufflevector(a, b, 0, 4, 2, 6)
#define SIMD_ODD(a, b)       __builtin_shufflevector(a, b, 1, 5, 3, 7)
#define SIMD_LOW(a, b)       __builtin_shufflevector(a, b, 0, 1, 4, 5)
#define SIMD_HIGH(a, b)      __builtin_shufflevector(a, b, 2, 3, 6, 7)
#else
#define SIMD_JOIN(low, high) ((simd_real){(low)[0], (low)[1], (high)[0], (high)[1]})
#define SIMD_EVEN(a, b)      __builtin_shuffle(a, b, (simd_int){0, 4, 2, 6})
#define SIMD_ODD(a, b)       __builtin_shuffle(a, b, (simd_int){1, 5, 3, 7})
#define SIMD_LOW(a, b)       __builtin_shuffle(a, b, (simd_int){0, 1, 4, 5})
#define SIMD_HIGH(a, b)      __builtin_shuffle(a, b, (simd_int){2, 3, 6, 7})
#endif

/* For the functions that a DM2_WIDE function calls: each of its versions must have them inlined. */
#define DM2_INLINE static inline __attribute__((always_inline))

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define DM2_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define DM2_WIDE
#endif

#endif

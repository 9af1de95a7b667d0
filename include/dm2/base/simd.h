/* Four doubles at a time, with the vector types that gcc and clang share. Every operation is the scalar
 * operation in each lane, so that a loop over vectors gives the bits of the scalar loop.
 *
 * DM2_WIDE marks a function that is compiled for AVX2 and for the baseline instruction set; glibc on x86-64
 * selects the version when the program starts. Elsewhere the compiler translates the vectors to the
 * instructions of the target. */
#ifndef DM2_BASE_SIMD_H
#define DM2_BASE_SIMD_H

#include <stdint.h>

typedef double simd_real __attribute__((vector_size(32)));
typedef int64_t simd_int __attribute__((vector_size(32)));
enum { SIMD_LANES = 4 };

/* In each lane a where the comparison `mask` holds, else b. A macro, because vectors are not passed to
 * functions. */
#define SIMD_CHOOSE(mask, a, b) ((simd_real)(((simd_int)(a) & (mask)) | ((simd_int)(b) & ~(mask))))

/* Two doubles, the components of one element's vector. */
typedef double simd_real2 __attribute__((vector_size(16)));
typedef int64_t simd_int2 __attribute__((vector_size(16)));

union simd_int_halves {
    simd_int all;
    simd_int2 half[2];
};

/* SIMD_JOIN: two halves as one. SIMD_EVEN, SIMD_ODD: lanes 0 and 2, or 1 and 3, of a and b in turn: a0 b0 a2
 * b2. SIMD_LOW, SIMD_HIGH: the first, or second, halves of a and of b. */
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

/* Marks a function that a DM2_WIDE function calls, because each version must inline the function. */
#define DM2_INLINE static inline __attribute__((always_inline))

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define DM2_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define DM2_WIDE
#endif

#endif

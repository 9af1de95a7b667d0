/* exp, log, sine and cosine from + - * / and exact scaling only, so that their results have the same bits
 * with every compiler and C library; the results of libm differ between versions. */
#ifndef DM2_BASE_REAL_H
#define DM2_BASE_REAL_H

#include <stdint.h>
#include <string.h>

#include "dm2/base/exact_build.h"

/* 2^k for -1022 <= k <= 1023, from its bits. */
static inline double real_pow2(int k)
{
    uint64_t bits = (uint64_t)(k + 1023) << 52;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* e^x with a relative error below 4e-16 for |x| <= 700; 0 below that range and 2^1023 above it. Inline,
 * because the pair law calls real_exp. x = k ln2 + z with |z| <= 0.347, and a Taylor polynomial of degree 13
 * in z. */
static inline double real_exp(double x)
{
    const double shifter = 0x1.8p52;
    if (!(x > -700.0))
        return x == x ? 0.0 : x;
    if (x > 700.0)
        return 0x1p1023;
    double kd = (x * 0x1.71547652b82fep0 + shifter) - shifter;
    double z = (x - kd * 0x1.62e42fefa0000p-1) - kd * 0x1.cf79abc9e3b3ap-40;
    double z2 = z * z, z4 = z2 * z2;
    double p01 = 1.0 + z, p23 = 0.5 + z * 0x1.5555555555555p-3;
    double p45 = 0x1.5555555555555p-5 + z * 0x1.1111111111111p-7;
    double p67 = 0x1.6c16c16c16c17p-10 + z * 0x1.a01a01a01a01ap-13;
    double p89 = 0x1.a01a01a01a01ap-16 + z * 0x1.71de3a556c734p-19;
    double pab = 0x1.27e4fb7789f5cp-22 + z * 0x1.ae64567f544e4p-26;
    double pcd = 0x1.1eed8eff8d898p-29 + z * 0x1.6124613a86d09p-33;
    double low = p01 + z2 * p23, mid = p45 + z2 * p67, high = p89 + z2 * pab;
    return ((low + z4 * mid) + (z4 * z4) * (high + z4 * pcd)) * real_pow2((int)kd);
}

/* Natural logarithm of a positive finite x, relative error below 4e-16 away from 1. -inf for 0, NaN for x <
 * 0. */
double real_log(double x);

/* x^n for x >= 0: exact products for n = 1 and 2, else exp(n log x). */
double real_pow(double x, double n);

/* Sine and cosine for |x| <= 1e5 radians, absolute error below 2e-16 + 1e-16 |x|. */
double real_sin(double x);
double real_cos(double x);

#endif

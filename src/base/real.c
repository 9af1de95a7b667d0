/* Elementary functions from + - * / only, besides frexp and rint, which are exact and so have the same
 * results everywhere. */
#include "dm2/base/real.h"

#include <math.h>

double real_log(double x)
{
    if (!(x > 0.0))
        return x == 0.0 ? -INFINITY : NAN;
    int e;
    double m = frexp(x, &e);
    if (m < 0x1.6a09e667f3bcdp-1) {
        m *= 2.0;
        e -= 1;
    }
    /* log m = 2 atanh s; |s| <= 0.1716, so that s^23 is below 3e-18 */
    double s = (m - 1.0) / (m + 1.0), q = s * s, sum = 0.0;
    for (int k = 21; k >= 3; k -= 2)
        sum = (sum + 1.0 / k) * q;
    return e * 0x1.62e42fefa0000p-1 + ((2.0 * s + 2.0 * s * sum) + e * 0x1.cf79abc9e3b3ap-40);
}

double real_pow(double x, double n)
{
    if (n == 1.0)
        return x;
    if (n == 2.0)
        return x * x;
    if (x == 0.0)
        return n > 0.0 ? 0.0 : (n == 0.0 ? 1.0 : INFINITY);
    return real_exp(n * real_log(x));
}

/* sin z and cos z for |z| <= pi/4 */
static double sine_kernel(double z)
{
    double q = z * z, sum = 0.0;
    for (int k = 17; k >= 3; k -= 2)
        sum = (1.0 + sum) * (-q / ((double)k * (k - 1)));
    return z + z * sum;
}

static double cosine_kernel(double z)
{
    double q = z * z, sum = 0.0;
    for (int k = 18; k >= 2; k -= 2)
        sum = (1.0 + sum) * (-q / ((double)k * (k - 1)));
    return 1.0 + sum;
}

static double circular(double x, int quarter)
{
    double kd = rint(x * 0x1.45f306dc9c883p-1);
    double z = ((x - kd * 0x1.921fb54400000p0) - kd * 0x1.0b4611a600000p-34) - kd * 0x1.3198a2e037073p-69;
    switch (((int)kd + quarter) & 3) {
    case 0:
        return sine_kernel(z);
    case 1:
        return cosine_kernel(z);
    case 2:
        return -sine_kernel(z);
    default:
        return -cosine_kernel(z);
    }
}

double real_sin(double x)
{
    return circular(x, 0);
}

double real_cos(double x)
{
    return circular(x, 1);
}

/* Rest is skipped, as in kernels/quiet.py. */
#include "native.h"

long next_above(const double *values, const double *maxima, long start, long n, double limit)
{
    for (long i = start; i < n;) {
        if (i % BLOCK == 0 && maxima[i / BLOCK] <= limit) {
            i += BLOCK;
            continue;
        }
        if (values[i] > limit) return i;
        i++;
    }
    return n;
}

double largest(const double *x, const double *maxima, long begin, long end)
{
    double best = 0.0;
    for (long i = begin; i < end;) {
        if (i % BLOCK == 0 && i + BLOCK <= end) {
            best = larger(best, maxima[i / BLOCK]);
            i += BLOCK;
        } else
            best = larger(best, fabs(x[i++]));
    }
    return best;
}

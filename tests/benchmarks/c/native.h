/* What the C programs share: the algorithms of pipeline/kernels, as the limit for what numba makes of them. */
#pragma once
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define G 9.80665
#define LANES 16
#define BLOCK 64

static inline double larger(double a, double b) { return a > b ? a : b; }

static inline double smaller(double a, double b) { return a < b ? a : b; }

/* linear.c */
void transition(double w, double zeta, double t, double *r);
double peak_inside(double u, double v, double f0, double f1, double w, double zeta, double span, double c0, double c1,
                   double cu, double cv);
double trial(double low, double high, double at_low, double at_high);
void narrow(double *low, double *high, double *at_low, double *at_high, int *side, double t, double value);

/* quiet.c */
long next_above(const double *values, const double *maxima, long start, long n, double limit);
double largest(const double *x, const double *maxima, long begin, long end);

/* A step of rocking about an edge that holds, and the instants within it, as in kernels/rock_phase.py. */
#pragma once
#include "native.h"

#define ANGLE 0
#define SPEED 1

/* Rotation, rate, and sine and cosine of alpha - phi. */
typedef struct {
    double phi, rate, sn, cs;
} Rock;

/* What drives a stretch: excitation and normal force, linear, and the edge's sign and constant. */
typedef struct {
    double a0, a1, n0, n1, s, c;
} Load;

static inline Rock rock_step(Rock y, const Load *f, double t, double h)
{
    double half = 0.5 * h, sixth = h / 6.0, c = f->c, rate = y.rate, sn = y.sn, cs = y.cs;
    double pa = f->s * (f->a0 + f->a1 * t), pn = f->n0 + f->n1 * t;
    double ma = f->s * (f->a0 + f->a1 * (t + half)), mn = f->n0 + f->n1 * (t + half);
    double qa = f->s * (f->a0 + f->a1 * (t + h)), qn = f->n0 + f->n1 * (t + h);
    double k1 = -c * (pn * sn + pa * cs), ds1 = -rate * cs, dc1 = rate * sn;
    double r2 = rate + half * k1, s2 = sn + half * ds1, c2 = cs + half * dc1;
    double k2 = -c * (mn * s2 + ma * c2), ds2 = -r2 * c2, dc2 = r2 * s2;
    double r3 = rate + half * k2, s3 = sn + half * ds2, c3 = cs + half * dc2;
    double k3 = -c * (mn * s3 + ma * c3), ds3 = -r3 * c3, dc3 = r3 * s3;
    double r4 = rate + h * k3, s4 = sn + h * ds3, c4 = cs + h * dc3, k4 = -c * (qn * s4 + qa * c4);
    double sa = sn + sixth * (ds1 + 2.0 * (ds2 + ds3) - r4 * c4), ca = cs + sixth * (dc1 + 2.0 * (dc2 + dc3) + r4 * s4);
    double back = 1.5 - 0.5 * (sa * sa + ca * ca);
    Rock end = {y.phi + sixth * (rate + 2.0 * (r2 + r3) + r4), rate + sixth * (k1 + 2.0 * (k2 + k3) + k4), sa * back,
                 ca * back};
    return end;
}

/* The length of the step after which phi or its rate reaches a level; at_low, at_high: less the level at both ends. */
static double locate(Rock y, const Load *f, double t, double low, double high, double at_low, double at_high, int what,
                     double level)
{
    double tau = high;
    for (int k = 0, side = 0; k < 60 && at_high != at_low; k++) {
        double before = tau;
        tau = trial(low, high, at_low, at_high);
        Rock at = rock_step(y, f, t, tau);
        double value = (what == ANGLE ? at.phi : at.rate) - level;
        narrow(&low, &high, &at_low, &at_high, &side, tau, value);
        if (value == 0.0 || fabs(tau - before) <= 1e-15 * tau) break;
    }
    return tau;
}

/* When within a step the other edge lands; -1 if it does not. */
static inline double landing(Rock y, const Load *f, double t, double h, Rock end)
{
    if (y.phi > 0.0) {
        if (end.phi < 0.0) return locate(y, f, t, 0.0, h, y.phi, end.phi, ANGLE, 0.0);
        if (y.rate < 0.0 && end.rate > 0.0) {
            double dip = locate(y, f, t, 0.0, h, y.rate, end.rate, SPEED, 0.0), lowest = rock_step(y, f, t, dip).phi;
            if (lowest < 0.0) return locate(y, f, t, 0.0, dip, y.phi, lowest, ANGLE, 0.0);
        }
    } else if (end.phi <= 0.0) {
        double low = 0.5 * h;
        for (int k = 0; k < 50; k++, low *= 0.5) {
            double phi = rock_step(y, f, t, low).phi;
            if (phi > 0.0) return locate(y, f, t, low, h, phi, end.phi, ANGLE, 0.0);
        }
        return 0.0;
    }
    return -1.0;
}

/* When what holds a resting body towards either side is first exceeded, and the side; 0 if it is not. */
static inline double lift_off(const Load *f, double t, double span, double hold1, double hold2, double *side)
{
    double time = -1.0;
    *side = 0.0;
    for (double s = 1.0; s >= -1.0; s -= 2.0) {
        double hold = s > 0.0 ? hold1 : hold2, then;
        double begin = -s * (f->a0 + f->a1 * t) - hold * (f->n0 + f->n1 * t);
        double end = -s * (f->a0 + f->a1 * span) - hold * (f->n0 + f->n1 * span);
        if (begin > 0.0) then = t;
        else if (end > 0.0) then = t + (span - t) * smaller(1.0, -begin / (end - begin));
        else continue;
        if (time < 0.0 || then < time) time = then, *side = s;
    }
    return time;
}

/* The damped oscillator in closed form, as in kernels/linear.py, and the false position of kernels/roots.py. */
#include "native.h"

/* Responses after t to a unit displacement, velocity, step and ramp; zeta < 1. */
void transition(double w, double zeta, double t, double *r)
{
    double x = w * t;
    if (x * (1.0 + zeta) < 0.5) {
        double a = 2.0 * zeta * x, b = x * x, previous = 0.0, term = t, h = t, h1 = t * t / 2.0, h2 = t * t * t / 6.0;
        for (int k = 0; k <= 40; k++) {
            double following = -(a * (k + 1) * term + b * previous) / ((k + 2.0) * (k + 1.0));
            previous = term;
            term = following;
            h += term;
            h1 += term * t / (k + 3.0);
            h2 += term * t * t / ((k + 3.0) * (k + 4.0));
            if (fabs(term) + fabs(previous) < 1e-17 * t) break;
        }
        r[0] = 1.0 - w * w * h1;
        r[1] = h;
        r[2] = h1;
        r[3] = h2;
        return;
    }
    double wd = w * sqrt((1.0 - zeta) * (1.0 + zeta)), decay = exp(-zeta * x), h = decay * sin(wd * t) / wd;
    double g = decay * cos(wd * t) + zeta * w * h, h1 = (1.0 - g) / (w * w);
    r[0] = g;
    r[1] = h;
    r[2] = h1;
    r[3] = (t - h - 2.0 * zeta * w * h1) / (w * w);
}

double trial(double low, double high, double at_low, double at_high)
{
    double t = (low * at_high - high * at_low) / (at_high - at_low);
    return low < t && t < high ? t : 0.5 * (low + high);
}

/* The bracket with the value at t as its new end; an end that stays twice is worth half (Illinois). */
void narrow(double *low, double *high, double *at_low, double *at_high, int *side, double t, double value)
{
    if ((value > 0.0) == (*at_high > 0.0)) {
        *high = t, *at_high = value;
        if (*side == 1) *at_low *= 0.5;
        *side = 1;
    } else {
        *low = t, *at_low = value;
        if (*side == -1) *at_high *= 0.5;
        *side = -1;
    }
}

/* y = c0 + c1 t + cu u + cv u' after t, and its first two derivatives */
static void follow(double u, double v, double f0, double f1, double w, double zeta, double t, double c0, double c1,
                   double cu, double cv, double *y)
{
    double r[4], b = w * w, c = 2.0 * zeta * w;
    transition(w, zeta, t, r);
    double un = u * r[0] + v * r[1] + f0 * r[2] + f1 * r[3];
    double vn = -u * b * r[1] + v * (r[0] - c * r[1]) + f0 * r[1] + f1 * r[2];
    double pull = f0 + f1 * t - c * vn - b * un;
    y[0] = c0 + c1 * t + cu * un + cv * vn;
    y[1] = c1 + cu * vn + cv * pull;
    y[2] = cu * pull + cv * (f1 - c * pull - b * vn);
}

static double stationary(double u, double v, double f0, double f1, double w, double zeta, double c0, double c1,
                         double cu, double cv, double low, double high, double at_low, double at_high)
{
    double near = 1e-5 * (high - low), t = trial(low, high, at_low, at_high), y[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 60; k++) {
        follow(u, v, f0, f1, w, zeta, t, c0, c1, cu, cv, y);
        double move = y[2] != 0.0 ? -y[1] / y[2] : high - low;
        if (y[1] == 0.0) break;
        if ((y[1] > 0.0) == (at_high > 0.0)) high = t;
        else low = t;
        int inside = low <= t + move && t + move <= high;
        if (inside && fabs(move) <= near) return fabs(y[0] + 0.5 * y[1] * move);
        t = inside ? t + move : 0.5 * (low + high);
    }
    return fabs(y[0]);
}

/* The first time at which the rate of cu u + cv u', heading for zero from this sign, turns back; -1: never; zeta < 1 */
static double turn(double u, double v, double f0, double f1, double w, double zeta, double cu, double cv, double sign)
{
    double b = w * w, c = 2.0 * zeta * w, pull = f0 - c * v - b * u, jerk = f1 - c * pull - b * v;
    double q = cu * pull + cv * jerk, rate = cu * jerk - cv * (c * jerk + b * pull);
    if (!(q * sign < 0.0)) return -1.0;
    double root = w * sqrt((1.0 - zeta) * (1.0 + zeta));
    return atan2(fabs(q) * root, (sign > 0.0 ? rate : -rate) - zeta * w * fabs(q)) / root;
}

double peak_inside(double u, double v, double f0, double f1, double w, double zeta, double span, double c0, double c1,
                   double cu, double cv)
{
    double low = 0.0, begin[3], end[3], inside[3];
    follow(u, v, f0, f1, w, zeta, 0.0, c0, c1, cu, cv, begin);
    if (begin[1] == 0.0) {
        low = 1e-6 * span;
        follow(u, v, f0, f1, w, zeta, low, c0, c1, cu, cv, begin);
    }
    follow(u, v, f0, f1, w, zeta, span, c0, c1, cu, cv, end);
    if (begin[1] == 0.0 && end[1] == 0.0) return 0.0;
    if (begin[1] * end[1] < 0.0)
        return stationary(u, v, f0, f1, w, zeta, c0, c1, cu, cv, low, span, begin[1], end[1]);
    double back = turn(u, v, f0, f1, w, zeta, cu, cv, begin[1]);
    if (!(low < back && back < span)) return 0.0;
    follow(u, v, f0, f1, w, zeta, back, c0, c1, cu, cv, inside);
    if (begin[1] * inside[1] >= 0.0) return 0.0;
    return larger(stationary(u, v, f0, f1, w, zeta, c0, c1, cu, cv, low, back, begin[1], inside[1]),
                  stationary(u, v, f0, f1, w, zeta, c0, c1, cu, cv, back, span, inside[1], end[1]));
}

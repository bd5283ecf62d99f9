/* The Taylor series of a slip, and the instant of its stop, as in kernels/line_phase.py. */
#pragma once
#include "native.h"

#define TERMS 24

/* A body on dry friction, and the coefficients of its velocity and of its displacement in powers of time. */
typedef struct {
    double w, zeta, mu, step, b, c, r[4], ease, factorials[TERMS + 1], series[2][TERMS];
    int size;
} Line;

static void make_line(Line *line, double w, double zeta, double mu, double step)
{
    double share = step * w * (zeta + sqrt(zeta * zeta + 1.0)), last = share / 6.0;
    line->w = w, line->zeta = zeta, line->mu = mu, line->step = step, line->b = w * w, line->c = 2.0 * zeta * w;
    transition(w, zeta, step, line->r);
    line->ease = 1.0 / (1.0 - 0.5 * line->c * step - 0.125 * line->b * step * step);
    line->factorials[0] = 1.0;
    for (int k = 1; k <= TERMS; k++) line->factorials[k] = line->factorials[k - 1] / k;
    for (line->size = 3; line->size < TERMS && last > 1e-17;) last *= share / ++line->size;
}

static void expand(Line *line, double u, double v, double f0, double f1)
{
    double b = line->b, c = line->c, before = v, now = f0 - c * v - b * u, next = f1 - c * now - b * before;
    line->series[0][0] = line->series[1][0] = v;
    line->series[0][1] = now, line->series[1][1] = 0.5 * now;
    before = now, now = next;
    for (int k = 2; k < line->size; k++) {
        line->series[0][k] = now * line->factorials[k], line->series[1][k] = now * line->factorials[k + 1];
        next = -c * now - b * before;
        before = now, now = next;
    }
}

static double after(const Line *line, double t, double *way)
{
    double v = 0.0, moved = 0.0;
    for (int k = line->size - 1; k >= 0; k--) v = v * t + line->series[0][k], moved = moved * t + line->series[1][k];
    *way = moved * t;
    return v;
}

static double zero(const Line *line, double u, double f0, double f1, int order, double low, double high,
                   double at_high, double guess, double *what)
{
    double near = 1e-5 * high, t = low < guess && guess < high ? guess : 0.5 * (low + high), b = line->b, c = line->c;
    for (int k = 0; k < 100; k++) {
        double moved, v = after(line, t, &moved), a = f0 + f1 * t - c * v - b * (u + moved), jerk = f1 - c * a - b * v;
        double value = order == 1 ? v : a, rate = order == 1 ? a : jerk, bend = order == 1 ? jerk : -c * jerk - b * a;
        *what = order == 1 ? u + moved : v;
        if (value == 0.0) break;
        if ((value > 0.0) == (at_high > 0.0)) high = t;
        else low = t;
        double below = 2.0 * rate * rate - value * bend, move = below != 0.0 ? -2.0 * value * rate / below : high - low;
        int inside = low < t + move && t + move < high;
        if (inside && fabs(move) <= near) {
            *what += move * (value + 0.5 * move * rate);
            return t + move;
        }
        if (high - low <= 4e-16 * high) break;
        t = inside ? t + move : 0.5 * (low + high);
    }
    return t;
}

static double first_stop(const Line *line, double u, double v, double s, double f0, double f1, double span, double un,
                         double vn, double *there)
{
    double first = s * line->series[0][1], half = s * line->series[0][2], low = 0.0, high = span, way;
    int moving = s * v > 0.0;
    int dips = first < 0.0 && s * (f0 + f1 * span - line->c * vn - line->b * un) > 0.0;
    if (s * vn > 0.0 && !(moving && dips)) return -1.0;
    if (!moving) {
        int k = 0;
        for (low = 0.5 * span; k < 60 && s * after(line, low, &way) <= 0.0; k++) low *= 0.5;
        if (k == 60) {
            *there = u;
            return 0.0;
        }
    } else if (s * vn > 0.0) {
        double speed;
        high = zero(line, u, f0, f1, 2, 0.0, span, s, -0.5 * first / half, &speed);
        if (s * speed > 0.0) return -1.0;
    }
    double inner = sqrt(larger(0.0, first * first - 4.0 * s * v * half));
    double guess = first < 0.0 ? 2.0 * s * v / (inner - first) : -0.5 * (first + inner) / half;
    return zero(line, u, f0, f1, 1, low, high, -s, guess, there);
}


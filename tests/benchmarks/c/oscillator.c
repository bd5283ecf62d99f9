/* Oscillators in lanes, as in kernels/oscillator.py: exact recursion, then a search of the steps that can hold a peak. */
#include "native.h"

#define CHUNK 128
#define STRIDE 4

/* The largest |p| on the cubic with these ends and rates there. */
static double cubic_top(double p0, double d0, double p1, double d1, double h)
{
    double first = h * d0 / 3.0, last = h * d1 / 3.0, middle = (p1 - last) - (p0 + first);
    double top = larger(fabs(p0), fabs(p1)), inner = middle * middle - first * last;
    if (inner < 0.0) return top;
    double q = first - middle + copysign(sqrt(inner), first - middle), bend = first - 2.0 * middle + last;
    double where[2] = {q / bend, first / q};
    for (int k = 0; k < 2; k++)
        if (0.0 < where[k] && where[k] < 1.0) {
            double t = where[k], left = 1.0 - t;
            double here = p0 * left * left * left + 3.0 * (p0 + first) * left * left * t;
            top = larger(top, fabs(here + 3.0 * (p1 - last) * left * t * t + p1 * t * t * t));
        }
    return top;
}

/* f^2 + (f' / w)^2 of f = u'' in the interval that begins here; pull is -f. */
static inline double energy_of(double pull, double v, double difference, double w, double twice, double ramp)
{
    double jerk = ramp * difference - twice * pull + w * v;
    return pull * pull + jerk * jerk;
}

/* How far |u|, |y| may exceed those at the samples, and w^2 |u|, |y| the largest |a|, between samples. */
static inline void gaps(double energy, double pull, double difference, double dt, double b, double twice, double ramp,
                        double norm, double *gap)
{
    double eighth = 0.125 * dt * dt, second = smaller(energy, pull + eighth * b * (1.0 + twice) * energy);
    gap[0] = eighth * second, gap[1] = eighth * b * (twice * energy + second);
    gap[2] = twice * ramp * difference + norm * energy, gap[3] = second;
}

static inline int beyond(double near_u, double near_y, double most, double b, const double *gap, long apart,
                         double max_u, double max_y)
{
    return (near_u + gap[0] > max_u && most + gap[2 * apart] > b * max_u) ||
           (near_y + gap[apart] > max_y && most + gap[3 * apart] > max_y);
}

/* max_u, max_y (m): largest |u| and |a + u''| within the record; w (1 + 2 zeta) dt <= 1.5, zeta < 1, m / LANES whole */
void oscillators(const double *base, long n, double dt, const double *w, const double *zeta, long m, double *max_u,
                 double *max_y)
{
    long parts = (n - 2) / CHUNK + 1;
    double *kept = malloc(sizeof(double) * 8 * LANES * parts), *outline = calloc(3 * parts, sizeof(double));
    double *a = malloc(sizeof(double) * (n + 1));
    memcpy(a, base, sizeof(double) * n);
    a[n] = a[n - 1];
    for (long i = 0; i < n - 1; i++) {
        double *row = outline + 3 * (i / CHUNK);
        row[0] = larger(row[0], larger(fabs(a[i]), fabs(a[i + 1])));
        row[1] = larger(row[1], fabs(a[i + 1] - a[i]));
        row[2] = larger(row[2], fabs(a[i + 2] - a[i + 1] - (a[i + 1] - a[i])));
    }
    for (long first = 0; first < m; first += LANES) {
        double uu[LANES], uv[LANES], u0[LANES], u1[LANES], vu[LANES], vv[LANES], v0[LANES], v1[LANES];
        double b[LANES], c[LANES], f[LANES], twice[LANES], ramp[LANES], norm[LANES], u[LANES], v[LANES];
        double *high_u = max_u + first, *high_y = max_y + first;
        for (int k = 0; k < LANES; k++) {
            double r[4], z = zeta[first + k];
            f[k] = w[first + k], b[k] = f[k] * f[k], c[k] = 2.0 * z * f[k];
            twice[k] = 2.0 * z, ramp[k] = 1.0 / (f[k] * dt), norm[k] = pow(z + sqrt(1.0 + z * z), 2.0);
            transition(f[k], z, dt, r);
            uu[k] = r[0], uv[k] = r[1], u0[k] = r[3] / dt - r[2], u1[k] = -r[3] / dt;
            vu[k] = -b[k] * r[1], vv[k] = r[0] - c[k] * r[1], v0[k] = r[2] / dt - r[1], v1[k] = -r[2] / dt;
            u[k] = v[k] = high_u[k] = high_y[k] = 0.0;
        }
        for (long part = 0; part < parts; part++) {
            double top_u[LANES], top_y[LANES], top_e[LANES], *s = kept + 8 * LANES * part, *row = outline + 3 * part;
            long i = part * CHUNK, end = (part + 1) * CHUNK < n - 1 ? (part + 1) * CHUNK : n - 1;
            for (int k = 0; k < LANES; k++) {
                double pull = a[i] + (c[k] * v[k] + b[k] * u[k]);
                s[k] = u[k], s[LANES + k] = v[k], top_u[k] = fabs(u[k]), top_y[k] = fabs(a[i] - pull);
                top_e[k] = energy_of(pull, v[k], a[i + 1] - a[i], f[k], twice[k], ramp[k]);
            }
            while (i < end) {
                int steps = i + STRIDE <= end ? STRIDE : 1;
                for (int j = 0; j < steps; j++, i++)
                    for (int k = 0; k < LANES; k++) {
                        double un = uu[k] * u[k] + uv[k] * v[k] + (u0[k] * a[i] + u1[k] * a[i + 1]);
                        double vn = vu[k] * u[k] + vv[k] * v[k] + (v0[k] * a[i] + v1[k] * a[i + 1]);
                        u[k] = un, v[k] = vn;
                        top_u[k] = larger(top_u[k], fabs(un));
                        top_y[k] = larger(top_y[k], fabs(c[k] * vn + b[k] * un));
                    }
                for (int k = 0; k < LANES; k++) {
                    double pull = a[i] + (c[k] * v[k] + b[k] * u[k]);
                    top_e[k] = larger(top_e[k], energy_of(pull, v[k], a[i + 1] - a[i], f[k], twice[k], ramp[k]));
                }
            }
            for (int k = 0; k < LANES; k++) {
                double energy = sqrt(top_e[k]) + (STRIDE - 1) * row[2] * ramp[k], gap[4];
                gaps(energy, top_y[k] + row[0], row[1], dt, b[k], twice[k], ramp[k], norm[k], gap);
                s[2 * LANES + k] = smaller(top_u[k] + gap[0], (row[0] + gap[2]) / b[k]);
                s[3 * LANES + k] = smaller(top_y[k] + gap[1], row[0] + gap[3]);
                for (int j = 0; j < 4; j++) s[(4 + j) * LANES + k] = gap[j];
                high_u[k] = larger(high_u[k], top_u[k]), high_y[k] = larger(high_y[k], top_y[k]);
            }
        }
        for (long part = 0; part < parts; part++)
            for (int k = 0; k < LANES; k++) {
                const double *s = kept + 8 * LANES * part + k;
                if (s[2 * LANES] <= high_u[k] && s[3 * LANES] <= high_y[k]) continue;
                double p = s[0], q = s[LANES], z = zeta[first + k], fourth = dt * dt * dt * dt / 384.0;
                double pull = a[part * CHUNK] + (c[k] * q + b[k] * p);
                long end = (part + 1) * CHUNK < n - 1 ? (part + 1) * CHUNK : n - 1;
                for (long i = part * CHUNK; i < end; i++) {
                    double pn = uu[k] * p + uv[k] * q + (u0[k] * a[i] + u1[k] * a[i + 1]);
                    double qn = vu[k] * p + vv[k] * q + (v0[k] * a[i] + v1[k] * a[i + 1]);
                    double next = a[i + 1] + (c[k] * qn + b[k] * pn), y0 = a[i] - pull, y1 = a[i + 1] - next;
                    double near_u = larger(fabs(p), fabs(pn)), near_y = larger(fabs(y0), fabs(y1)), gap[4];
                    double most = larger(fabs(a[i]), fabs(a[i + 1])), rise = a[i + 1] - a[i], rate = rise / dt;
                    if (beyond(near_u, near_y, most, b[k], s + 4 * LANES, LANES, high_u[k], high_y[k])) {
                        double energy = sqrt(energy_of(pull, q, rise, f[k], twice[k], ramp[k]));
                        double slack = fourth * b[k] * (1.0 + twice[k]) * energy;
                        gaps(energy, larger(fabs(pull), fabs(next)), fabs(rise), dt, b[k], twice[k], ramp[k], norm[k],
                             gap);
                        if (beyond(near_u, near_y, most, b[k], gap, 1, high_u[k], high_y[k])) {
                            if (cubic_top(p, q, pn, qn, dt) + slack > high_u[k])
                                high_u[k] = larger(larger(high_u[k], near_u), peak_inside(p, q, -a[i], -rate, f[k], z,
                                                                                          dt, 0.0, 0.0, 1.0, 0.0));
                            double d0 = c[k] * pull - b[k] * q, d1 = c[k] * next - b[k] * qn;
                            slack *= b[k] * (1.0 + twice[k]) * (1.0 + twice[k]);
                            if (cubic_top(y0, d0, y1, d1, dt) + slack > high_y[k])
                                high_y[k] = larger(larger(high_y[k], near_y), peak_inside(p, q, -a[i], -rate, f[k], z,
                                                                                          dt, 0.0, 0.0, -b[k], -c[k]));
                        }
                    }
                    p = pn, q = qn, pull = next;
                }
            }
    }
    free(kept);
    free(outline);
    free(a);
}

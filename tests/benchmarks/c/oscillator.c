/* Oscillators in lanes, as in kernels/oscillator.py: exact recursion, then a search of the steps that can hold a peak. */
#include "native.h"

#define CHUNK 128

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

/* max_u, max_y (m): largest |u| and |a + u''| within the record; w (1 + 2 zeta) dt <= 1.5, zeta < 1, m / LANES whole */
void oscillators(const double *base, long n, double dt, const double *w, const double *zeta, long m, double *max_u,
                 double *max_y)
{
    long parts = (n - 2) / CHUNK + 1;
    double *begin = malloc(sizeof(double) * 6 * LANES * parts), most = 0.0, steepest = 0.0;
    for (long i = 0; i < n; i++) most = larger(most, fabs(base[i]));
    for (long i = 0; i + 1 < n; i++) steepest = larger(steepest, fabs(base[i + 1] - base[i]) / dt);
    for (long first = 0; first < m; first += LANES) {
        double uu[LANES], uv[LANES], u0[LANES], u1[LANES], vu[LANES], vv[LANES], v0[LANES], v1[LANES];
        double yu[LANES], yv[LANES], u[LANES], v[LANES];
        for (int k = 0; k < LANES; k++) {
            double r[4], f = w[first + k], z = zeta[first + k], b = f * f, c = 2.0 * z * f;
            transition(f, z, dt, r);
            uu[k] = r[0], uv[k] = r[1], u0[k] = r[3] / dt - r[2], u1[k] = -r[3] / dt;
            vu[k] = -b * r[1], vv[k] = r[0] - c * r[1], v0[k] = r[2] / dt - r[1], v1[k] = -r[2] / dt;
            yu[k] = -b, yv[k] = -c, u[k] = v[k] = max_u[first + k] = max_y[first + k] = 0.0;
        }
        for (long part = 0; part < parts; part++) {
            double top_u[LANES], top_v[LANES], top_y[LANES], *s = begin + 6 * LANES * part;
            long end = (part + 1) * CHUNK < n - 1 ? (part + 1) * CHUNK : n - 1;
            for (int k = 0; k < LANES; k++) {
                s[k] = u[k], s[LANES + k] = v[k], top_u[k] = fabs(u[k]), top_v[k] = fabs(v[k]);
                top_y[k] = fabs(yu[k] * u[k] + yv[k] * v[k]);
            }
            for (long i = part * CHUNK; i < end; i++) {
                double a = base[i], an = base[i + 1];
                for (int k = 0; k < LANES; k++) {
                    double un = uu[k] * u[k] + uv[k] * v[k] + (u0[k] * a + u1[k] * an);
                    double vn = vu[k] * u[k] + vv[k] * v[k] + (v0[k] * a + v1[k] * an);
                    u[k] = un, v[k] = vn;
                    top_u[k] = larger(top_u[k], fabs(un));
                    top_v[k] = larger(top_v[k], fabs(vn));
                    top_y[k] = larger(top_y[k], fabs(yu[k] * un + yv[k] * vn));
                }
            }
            for (int k = 0; k < LANES; k++) {
                /* A bound of what lies between two steps, from those of u'', u''' and u''''. */
                double b = -yu[k], c = -yv[k], ease = 1.0 / (1.0 - 0.5 * c * dt - 0.125 * b * dt * dt);
                double second = (most + c * top_v[k] + b * top_u[k]) * ease;
                double third = steepest + c * second + b * (top_v[k] + 0.5 * dt * second);
                s[2 * LANES + k] = 0.125 * dt * dt * second;
                s[3 * LANES + k] = 0.125 * dt * dt * (c * third + b * second);
                s[4 * LANES + k] = top_u[k], s[5 * LANES + k] = top_y[k];
                max_u[first + k] = larger(max_u[first + k], top_u[k]);
                max_y[first + k] = larger(max_y[first + k], top_y[k]);
            }
        }
        for (int k = 0; k < LANES; k++) {
            double most_u = max_u[first + k], most_y = max_y[first + k], f = w[first + k], z = zeta[first + k];
            for (long part = 0; part < parts; part++) {
                const double *s = begin + 6 * LANES * part;
                double gap_u = s[2 * LANES + k], gap_y = s[3 * LANES + k];
                if (s[4 * LANES + k] + gap_u <= most_u && s[5 * LANES + k] + gap_y <= most_y) continue;
                double p = s[k], q = s[LANES + k];
                long end = (part + 1) * CHUNK < n - 1 ? (part + 1) * CHUNK : n - 1;
                for (long i = part * CHUNK; i < end; i++) {
                    double a = base[i], an = base[i + 1], rate = (an - a) / dt;
                    double pn = uu[k] * p + uv[k] * q + (u0[k] * a + u1[k] * an);
                    double qn = vu[k] * p + vv[k] * q + (v0[k] * a + v1[k] * an);
                    double b = f * f, c = 2.0 * z * f, fourth = dt * dt * dt * dt / 384.0;
                    double near_u = larger(fabs(p), fabs(pn)), near_v = larger(fabs(q), fabs(qn));
                    double y0 = -(c * q + b * p), y1 = -(c * qn + b * pn), near_y = larger(fabs(y0), fabs(y1));
                    if (near_u + gap_u > most_u || near_y + gap_y > most_y) {
                        double ease = 1.0 / (1.0 - 0.5 * c * dt - 0.125 * b * dt * dt);
                        double second = (larger(fabs(a), fabs(an)) + c * near_v + b * near_u) * ease;
                        double third = fabs(rate) + c * second + b * (near_v + 0.5 * dt * second);
                        double bend = c * third + b * second, slack = fourth * bend;
                        if (near_u + gap_u > most_u && cubic_top(p, q, pn, qn, dt) + slack > most_u)
                            most_u = larger(larger(most_u, near_u),
                                            peak_inside(p, q, -a, -rate, f, z, dt, 0.0, 0.0, 1.0, 0.0));
                        double d0 = c * (a + c * q + b * p) - b * q, d1 = c * (an + c * qn + b * pn) - b * qn;
                        slack = fourth * (c * (c * bend + b * third) + b * bend);
                        if (near_y + gap_y > most_y && cubic_top(y0, d0, y1, d1, dt) + slack > most_y)
                            most_y = larger(larger(most_y, near_y),
                                            peak_inside(p, q, -a, -rate, f, z, dt, 0.0, 0.0, -b, -c));
                    }
                    p = pn, q = qn;
                }
            }
            max_u[first + k] = most_u;
            max_y[first + k] = most_y;
        }
    }
    free(begin);
}

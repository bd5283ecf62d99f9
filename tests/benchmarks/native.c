/* The algorithms of the kernels in C: what a compiler of today makes of them, as the limit for what numba makes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define G 9.80665
#define LANES 16
#define BLOCK 64
#define CHUNK 128

static inline double larger(double a, double b) { return a > b ? a : b; }

/* One-directional sliding in closed form: u'' = -a - s mu N between samples, linear a and N. ---------------------- */

/* First time in (0, span] at which p + q t + r t^2 comes down to 0, p >= 0; -1 if it does not. */
static double first_stop(double p, double q, double r, double span)
{
    double t;
    if (p == 0.0) {
        /* At the onset q is zero but for rounding, so that the end of the span decides. */
        if (q + r * span > 0.0) return -1.0;
        t = q > 0.0 ? -q / r : 0.0;
    } else {
        double inner = q * q - 4.0 * p * r;
        if (inner < 0.0) return -1.0;
        if (q < 0.0) t = 2.0 * p / (-q + sqrt(inner));
        else if (r < 0.0) t = (q + sqrt(inner)) / (-2.0 * r);
        else return -1.0;
    }
    return t <= span ? t : -1.0;
}

/* state: u, v, s; out: max |u|, path, largest acceleration passed on */
static void slide(double *state, double a0, double a1, double n0, double n1, double span, double mu, double *out)
{
    double u = state[0], v = state[1], s = state[2], now = 0.0;
    for (int events = 0; events < 1000 && now < span; events++) {
        double a = a0 + a1 * now, n = n0 + n1 * now, left = span - now;
        if (s == 0.0) {
            if (fabs(a) <= mu * n) {
                double first = -1.0;
                for (double sign = 1.0; sign >= -1.0; sign -= 2.0) {
                    double begin = sign * a - mu * n, end = sign * (a + a1 * left) - mu * (n + n1 * left);
                    if (end > 0.0) {
                        double t = left * fmin(1.0, fmax(0.0, -begin / (end - begin)));
                        if (first < 0.0 || t < first) first = t;
                    }
                }
                if (first < 0.0) {
                    out[2] = larger(out[2], larger(fabs(a), fabs(a0 + a1 * span)));
                    break;
                }
                now += first;
                out[2] = larger(out[2], fabs(a));
                a = a0 + a1 * now;
                n = n0 + n1 * now;
                out[2] = larger(out[2], fabs(a));
                left = span - now;
            }
            s = a > 0.0 || (a == 0.0 && a1 > 0.0) ? -1.0 : 1.0;
            v = 0.0;
            if (left <= 0.0) break;
        }
        double f0 = -a - s * mu * n, f1 = -a1 - s * mu * n1;
        double stop = first_stop(s * v, s * f0, 0.5 * s * f1, left), t = stop < 0.0 ? left : stop;
        double move = t * (v + t * (0.5 * f0 + t * f1 / 6.0));
        u += move;
        out[0] = larger(out[0], fabs(u));
        out[1] += fabs(move);
        out[2] = larger(out[2], mu * larger(n, n + n1 * t));
        now += t;
        if (stop < 0.0) {
            v += t * (f0 + 0.5 * t * f1);
            break;
        }
        v = 0.0;
        a = a0 + a1 * now;
        s = fabs(a) <= mu * fmax(0.0, n0 + n1 * now) ? 0.0 : (a > 0.0 ? -1.0 : 1.0);
    }
    state[0] = u;
    state[1] = v;
    state[2] = s;
}

static long next_above(const double *values, const double *maxima, long start, long n, double limit)
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

static double largest(const double *x, const double *maxima, long begin, long end)
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

/* results (m, 3): max |u|, path, largest acceleration; the weight never vanishes (z > -G) */
void sliding(const double *x, const double *z, const double *ratio, const double *maxima, const double *pushes, long n,
             double dt, const double *mu, long m, double *results)
{
    for (long k = 0; k < m; k++) {
        double state[3] = {0.0, 0.0, 0.0}, *out = results + 3 * k;
        memset(out, 0, 3 * sizeof *out);
        for (long i = 0; i < n - 1; i++) {
            if (state[2] == 0.0) {
                long ahead = next_above(ratio, maxima, i, n, mu[k]);
                if (ahead >= n) {
                    out[2] = larger(out[2], largest(x, pushes, i, n));
                    break;
                }
                if (ahead > i + 1) {
                    out[2] = larger(out[2], largest(x, pushes, i, ahead));
                    i = ahead - 1;
                }
            }
            slide(state, x[i], (x[i + 1] - x[i]) / dt, G + z[i], (z[i + 1] - z[i]) / dt, dt, mu[k], out);
        }
    }
}

/* Oscillators in lanes: exact recursion, and a search of the steps that can hold a peak. -------------------------- */

/* Responses after t to a unit displacement, velocity, step and ramp; zeta < 1. */
static void transition(double w, double zeta, double t, double *r)
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

/* u (what 0) or a + u'' = -(c v + b u) (what 1) and its rate, t after a step */
static double value(double u, double v, double f0, double f1, double w, double zeta, double t, int what, double *rate)
{
    double r[4], b = w * w, c = 2.0 * zeta * w;
    transition(w, zeta, t, r);
    double un = u * r[0] + v * r[1] + f0 * r[2] + f1 * r[3];
    double vn = -u * b * r[1] + v * (r[0] - c * r[1]) + f0 * r[1] + f1 * r[2];
    if (what == 0) {
        *rate = vn;
        return un;
    }
    *rate = -(c * (f0 + f1 * t - c * vn - b * un) + b * vn);
    return -(c * vn + b * un);
}

/* The largest |value| at a turning point inside the step: Illinois on the rate. */
static double turning(double u, double v, double f0, double f1, double w, double zeta, double h, int what)
{
    double low = 0.0, high = h, at_low, at_high, rate, top = 0.0;
    value(u, v, f0, f1, w, zeta, 0.0, what, &at_low);
    value(u, v, f0, f1, w, zeta, h, what, &at_high);
    if (at_low * at_high >= 0.0) return 0.0;
    for (int k = 0, side = 0; k < 60; k++) {
        double t = (low * at_high - high * at_low) / (at_high - at_low);
        if (!(low < t && t < high)) t = 0.5 * (low + high);
        top = fabs(value(u, v, f0, f1, w, zeta, t, what, &rate));
        if (rate == 0.0 || high - low < 1e-13 * high) break;
        if ((rate > 0.0) == (at_high > 0.0)) {
            high = t;
            at_high = rate;
            if (side == 1) at_low *= 0.5;
            side = 1;
        } else {
            low = t;
            at_low = rate;
            if (side == -1) at_high *= 0.5;
            side = -1;
        }
    }
    return top;
}

/* max_u, max_y (m): largest |u| and |a + u''| within the record; w (1 + zeta) dt < 0.9, zeta < 1, m / LANES whole */
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
                    if (larger(fabs(p), fabs(pn)) + gap_u > most_u)
                        most_u = larger(most_u, turning(p, q, -a, -rate, f, z, dt, 0));
                    if (larger(fabs(yu[k] * p + yv[k] * q), fabs(yu[k] * pn + yv[k] * qn)) + gap_y > most_y)
                        most_y = larger(most_y, turning(p, q, -a, -rate, f, z, dt, 1));
                    p = pn, q = qn;
                }
            }
            max_u[first + k] = most_u;
            max_y[first + k] = most_y;
        }
    }
    free(begin);
}

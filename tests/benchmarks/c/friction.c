/* Dry friction in one direction, with or without a spring: kernels/friction_line.py and line_phase.py. */
#include "line_phase.h"

static inline double passed_on(const Line *line, double u, double v, double un, double vn, double f0, double f1,
                               double lift0, double lift1, double t, double most)
{
    double b = line->b, c = line->c;
    double near = larger(fabs(c * v + b * u + lift0), fabs(c * vn + b * un + lift0 + lift1 * t));
    most = larger(most, near);
    double push = larger(fabs(f0), fabs(f0 + f1 * t)), speed = larger(fabs(v), fabs(vn));
    double second = (push + c * speed + b * larger(fabs(u), fabs(un))) * line->ease;
    double bend = c * (fabs(f1) + c * second + b * (speed + 0.5 * t * second)) + b * second;
    if (b > 0.0 && near + 0.125 * t * t * bend > most)
        return larger(most, peak_inside(u, v, f0, f1, line->w, line->zeta, t, lift0, lift1, b, c));
    return most;
}

/* First time in [0, span] at which |q0 + q1 t| > l0 + l1 t, given that it is not so at 0; -1 if never. */
static double first_beyond(double q0, double q1, double l0, double l1, double span)
{
    double best = -1.0;
    for (double sign = 1.0; sign >= -1.0; sign -= 2.0) {
        double begin = sign * q0 - l0, end = sign * (q0 + q1 * span) - (l0 + l1 * span);
        if (end > 0.0) {
            double t = span * smaller(1.0, larger(0.0, -begin / (end - begin)));
            if (best < 0.0 || t < best) best = t;
        }
    }
    return best;
}

/* state: u, v, s; out: max |u|, path, largest acceleration passed on */
static void piece(Line *line, double *state, double a0, double a1, double n0, double n1, double span, double *out)
{
    double u = state[0], v = state[1], s = state[2], now = 0.0, b = line->b, mu = line->mu;
    for (int events = 0; events < 1000 && now < span; events++) {
        double left = span - now, a = a0 + a1 * now, n = n0 + n1 * now, q = a + b * u;
        if (s == 0.0) {
            if (fabs(q) <= mu * n) {
                double t = first_beyond(q, a1, mu * n, mu * n1, left);
                v = 0.0;
                if (t < 0.0) {
                    out[2] = larger(out[2], larger(fabs(a), fabs(a0 + a1 * span)));
                    break;
                }
                out[2] = larger(out[2], fabs(a));
                now += t;
                a = a0 + a1 * now, n = larger(0.0, n0 + n1 * now), q = a + b * u;
                out[2] = larger(out[2], fabs(a));
                left = span - now;
            }
            s = q > 0.0 || (q == 0.0 && a1 > 0.0) ? -1.0 : 1.0;
            v = 0.0;
            if (left <= 0.0) break;
        }
        double f0 = -a - s * mu * n, f1 = -a1 - s * mu * n1, moved, there = 0.0;
        expand(line, u, v, f0, f1);
        double vn = after(line, left, &moved), un = u + moved;
        double stop = first_stop(line, u, v, s, f0, f1, left, un, vn, &there), t = left;
        if (stop >= 0.0) t = stop, un = there, vn = 0.0;
        out[1] += fabs(un - u);
        out[0] = larger(out[0], fabs(un));
        if (t > 0.0) out[2] = passed_on(line, u, v, un, vn, f0, f1, s * mu * n, s * mu * n1, t, out[2]);
        u = un, v = vn;
        now += t;
        if (stop < 0.0) break;
        a = a0 + a1 * now, n = larger(0.0, n0 + n1 * now), q = a + b * u;
        s = fabs(q) <= mu * n ? 0.0 : (q > 0.0 ? -1.0 : 1.0);
    }
    state[0] = u, state[1] = v, state[2] = s;
}

static long stays(const double *x, const double *z, double spring, double mu, long begin, long end, double *out)
{
    double top = 0.0;
    long i = begin;
    for (; i <= end && fabs(x[i] + spring) <= mu * (G + z[i]); i++) top = larger(top, fabs(x[i]));
    out[2] = larger(out[2], top);
    return i - 1;
}

static long glides(const Line *line, const double *x, const double *z, double dt, double *state, long begin, long end,
                   double *out)
{
    double u = state[0], v = state[1], s = state[2], b = line->b, c = line->c, mu = line->mu, step = line->step;
    double top = out[0], path = out[1], felt = out[2];
    const double *r = line->r;
    long i = begin;
    for (; i < end; i++) {
        double a1 = (x[i + 1] - x[i]) / dt, lift0 = s * mu * (G + z[i]), lift1 = s * mu * ((z[i + 1] - z[i]) / dt);
        double f0 = -x[i] - lift0, f1 = -a1 - lift1;
        double un = u * r[0] + v * r[1] + f0 * r[2] + f1 * r[3];
        double vn = -u * b * r[1] + v * (r[0] - c * r[1]) + f0 * r[1] + f1 * r[2];
        int dips = s * (f0 - c * v - b * u) < 0.0 && s * (f0 + f1 * step - c * vn - b * un) > 0.0;
        if (s * v <= 0.0 || s * vn <= 0.0 || dips) break;
        felt = passed_on(line, u, v, un, vn, f0, f1, lift0, lift1, step, felt);
        path += fabs(un - u);
        top = larger(top, fabs(un));
        u = un, v = vn;
    }
    out[0] = top, out[1] = path, out[2] = felt;
    state[0] = u, state[1] = v;
    return i;
}

/* results (m, 3): max |u|, path, largest acceleration; within the record; w (1 + zeta) dt <= 0.5, zeta < 1, z > -G */
void friction(const double *x, const double *z, const double *ratio, const double *maxima, const double *pushes, long n,
              double dt, const double *w, const double *zeta, const double *mu, long m, double *results)
{
    for (long k = 0; k < m; k++) {
        Line line;
        double state[3] = {0.0, 0.0, 0.0}, *out = results + 3 * k;
        make_line(&line, w[k], zeta[k], mu[k], dt);
        memset(out, 0, 3 * sizeof *out);
        for (long i = 0; i < n - 1;) {
            if (state[2] == 0.0 && w[k] == 0.0) {
                long ahead = next_above(ratio, maxima, i, n, mu[k]);
                if (ahead >= n) {
                    out[2] = larger(out[2], largest(x, pushes, i, n));
                    break;
                }
                if (ahead > i + 1) {
                    out[2] = larger(out[2], largest(x, pushes, i, ahead));
                    i = ahead - 1;
                }
            } else {
                long still = state[2] == 0.0 ? stays(x, z, line.b * state[0], mu[k], i, n - 1, out)
                                             : glides(&line, x, z, dt, state, i, n - 1, out);
                if (still > i) {
                    i = still;
                    continue;
                }
            }
            piece(&line, state, x[i], (x[i + 1] - x[i]) / dt, G + z[i], (z[i + 1] - z[i]) / dt, dt, out);
            i++;
        }
    }
}

/* Rocking with located impacts, as in kernels/rocking.py. */
#include "native.h"

#define OVERTURNED 1.5707963267948966
#define REST 1e-4
#define COUNTED 1e-3
#define IMPACTS_CAP 200
#define STEP 0.2

/* Rotation, rate, and sine and cosine of alpha - phi. */
typedef struct {
    double phi, rate, sn, cs;
} State;

/* What drives a stretch: excitation and normal force, linear, and the edge's sign and constant. */
typedef struct {
    double a0, a1, n0, n1, s, c;
} Load;

static inline State step(State y, const Load *f, double t, double h)
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
    State end = {y.phi + sixth * (rate + 2.0 * (r2 + r3) + r4), rate + sixth * (k1 + 2.0 * (k2 + k3) + k4), sa * back,
                 ca * back};
    return end;
}

static double locate(State y, const Load *f, double t, double low, double high, int what, double level)
{
    State at = step(y, f, t, low);
    double at_low = (what == 0 ? at.phi : at.rate) - level, tau = high;
    at = step(y, f, t, high);
    double at_high = (what == 0 ? at.phi : at.rate) - level;
    for (int k = 0, side = 0; k < 60 && at_high != at_low; k++) {
        double before = tau;
        tau = trial(low, high, at_low, at_high);
        at = step(y, f, t, tau);
        double value = (what == 0 ? at.phi : at.rate) - level;
        narrow(&low, &high, &at_low, &at_high, &side, tau, value);
        if (value == 0.0 || fabs(tau - before) <= 1e-15 * tau) break;
    }
    return tau;
}

static void peak(State y, const Load *f, double t, double h, double alpha, double *out)
{
    if ((y.phi + h * y.rate) / alpha <= out[0]) return;
    double tau = locate(y, f, t, 0.0, h, 1, 0.0);
    out[0] = larger(out[0], step(y, f, t, tau).phi / alpha);
}

static void stand(State *y, const double *body, double s)
{
    double alpha = s > 0.0 ? body[0] : body[1];
    y->phi = 0.0, y->sn = sin(alpha), y->cs = cos(alpha);
}

/* s: the edge, 0 at rest; out: largest ratio, overturned, impacts */
static double stretch(double s, State *y, Load f, double span, const double *body, double *out)
{
    double t = 0.0;
    for (int landings = 0; landings <= IMPACTS_CAP;) {
        if (s == 0.0) {
            double time = -1.0;
            for (double side = 1.0; side >= -1.0; side -= 2.0) {
                double hold = tan(side > 0.0 ? body[0] : body[1]), then;
                double begin = -side * (f.a0 + f.a1 * t) - hold * (f.n0 + f.n1 * t);
                double end = -side * (f.a0 + f.a1 * span) - hold * (f.n0 + f.n1 * span);
                if (begin > 0.0) then = t;
                else if (end > 0.0) then = t + (span - t) * smaller(1.0, -begin / (end - begin));
                else continue;
                if (time < 0.0 || then < time) time = then, s = side;
            }
            if (s == 0.0) break;
            t = time;
            y->rate = 0.0;
            stand(y, body, s);
            if (t >= span) break;
        }
        double h = span - t, alpha = s > 0.0 ? body[0] : body[1], landed = -1.0;
        if (h <= 1e-14 * span) break;
        f.s = s, f.c = s > 0.0 ? body[2] : body[3];
        State end = step(*y, &f, t, h);
        if (y->phi > 0.0) {
            if (end.phi < 0.0) landed = locate(*y, &f, t, 0.0, h, 0, 0.0);
            else if (y->rate < 0.0 && end.rate > 0.0) {
                double dip = locate(*y, &f, t, 0.0, h, 1, 0.0);
                if (step(*y, &f, t, dip).phi < 0.0) landed = locate(*y, &f, t, 0.0, dip, 0, 0.0);
            }
        } else if (end.phi <= 0.0) {
            double low = 0.5 * h;
            landed = 0.0;
            for (int k = 0; k < 50; k++, low *= 0.5)
                if (step(*y, &f, t, low).phi > 0.0) {
                    landed = locate(*y, &f, t, low, h, 0, 0.0);
                    break;
                }
        }
        if (landed < 0.0) {
            if (end.phi >= OVERTURNED) {
                out[0] = larger(out[0], OVERTURNED / alpha), out[1] = 1.0;
                break;
            }
            if (y->rate > 0.0 && end.rate < 0.0) peak(*y, &f, t, h, alpha, out);
            out[0] = larger(out[0], end.phi / alpha);
            *y = end;
            break;
        }
        double rate = step(*y, &f, t, landed).rate;
        if (y->rate > 0.0 && rate < 0.0) peak(*y, &f, t, landed, alpha, out);
        t += landed;
        double slow = smaller(sqrt(body[2] * G) * body[0], sqrt(body[3] * G) * body[1]);
        if (fabs(rate) >= COUNTED * slow) out[2] += 1.0;
        y->rate = larger(0.0, -rate) * (s > 0.0 ? body[4] : body[5]);
        s = -s;
        stand(y, body, s);
        if (++landings > IMPACTS_CAP || y->rate < REST * slow) s = 0.0, y->rate = 0.0;
    }
    return s;
}

/* results (m, 3): largest ratio, overturned, impacts; bodies (m, 6) as in the kernel; within the record, z > -G */
void rocking(const double *x, const double *z, const double *ratio, const double *maxima, long n, double dt,
             double most, const double *bodies, long m, long refine, double *results)
{
    for (long k = 0; k < m; k++) {
        const double *body = bodies + 6 * k;
        double *out = results + 3 * k, s = 0.0, weakest = tan(smaller(body[0], body[1]));
        long pieces = (long)larger(1.0, ceil(sqrt(larger(body[2], body[3]) * (G + most)) * dt / STEP)) * refine;
        double span = dt / pieces;
        State y = {0.0, 0.0, 0.0, 0.0};
        memset(out, 0, 3 * sizeof *out);
        for (long i = 0; i < n - 1 && out[1] == 0.0; i++) {
            if (s == 0.0) {
                long ahead = next_above(ratio, maxima, i, n, weakest);
                if (ahead >= n) break;
                if (ahead > i + 1) i = ahead - 1;
            }
            double a1 = (x[i + 1] - x[i]) / dt, n1 = (z[i + 1] - z[i]) / dt;
            for (long j = 0; j < pieces && out[1] == 0.0; j++) {
                double t0 = j * span;
                Load f = {x[i] + a1 * t0, a1, G + z[i] + n1 * t0, n1, 0.0, 0.0};
                s = stretch(s, &y, f, span, body, out);
            }
        }
    }
}

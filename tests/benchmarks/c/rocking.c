/* Rocking with located impacts, as in kernels/rocking.py. */
#include "rock_phase.h"

#define OVERTURNED 1.5707963267948966
#define REST 1e-4
#define COUNTED 1e-3
#define IMPACTS_CAP 200
#define STEP 0.2

static void peak(Rock y, const Load *f, double t, double h, double rate, double alpha, double *out)
{
    if ((y.phi + h * y.rate) / alpha <= out[0]) return;
    double tau = locate(y, f, t, 0.0, h, y.rate, rate, SPEED, 0.0);
    out[0] = larger(out[0], rock_step(y, f, t, tau).phi / alpha);
}

static void stand(Rock *y, const double *body, double s)
{
    double alpha = s > 0.0 ? body[0] : body[1];
    y->phi = 0.0, y->sn = sin(alpha), y->cs = cos(alpha);
}

/* s: the edge, 0 at rest; out: largest ratio, overturned, impacts */
static double stretch(double s, Rock *y, Load f, double span, const double *body, double *out)
{
    double t = 0.0;
    for (int landings = 0; landings <= IMPACTS_CAP;) {
        if (s == 0.0) {
            double time = lift_off(&f, t, span, tan(body[0]), tan(body[1]), &s);
            if (s == 0.0) break;
            t = time;
            y->rate = 0.0;
            stand(y, body, s);
            if (t >= span) break;
        }
        double h = span - t, alpha = s > 0.0 ? body[0] : body[1], landed = -1.0;
        if (h <= 1e-14 * span) break;
        f.s = s, f.c = s > 0.0 ? body[2] : body[3];
        Rock end = rock_step(*y, &f, t, h);
        if (end.phi <= 0.0 || (y->rate < 0.0 && end.rate > 0.0)) landed = landing(*y, &f, t, h, end);
        if (landed < 0.0) {
            if (end.phi >= OVERTURNED) {
                out[0] = larger(out[0], OVERTURNED / alpha), out[1] = 1.0;
                break;
            }
            if (y->rate > 0.0 && end.rate < 0.0) peak(*y, &f, t, h, end.rate, alpha, out);
            out[0] = larger(out[0], end.phi / alpha);
            *y = end;
            break;
        }
        double rate = rock_step(*y, &f, t, landed).rate;
        if (y->rate > 0.0 && rate < 0.0) peak(*y, &f, t, landed, rate, alpha, out);
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
        Rock y = {0.0, 0.0, 0.0, 0.0};
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

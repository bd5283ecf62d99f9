/* Pendulums in lanes, as in kernels/pendulum.py. */
#include "native.h"

typedef struct {
    double theta, s, c, rate;
} State;

static inline State step(double theta, double s, double c, double rate, double a0, double am, double a1, double n0,
                         double nm, double n1, double h, double curl, double drag)
{
    double half = 0.5 * h, sixth = h / 6.0;
    double k1 = -drag * rate - (n0 * s + a0 * c) * curl, ds1 = c * rate, dc1 = -s * rate;
    double r2 = rate + half * k1, s2 = s + half * ds1, c2 = c + half * dc1;
    double k2 = -drag * r2 - (nm * s2 + am * c2) * curl, ds2 = c2 * r2, dc2 = -s2 * r2;
    double r3 = rate + half * k2, s3 = s + half * ds2, c3 = c + half * dc2;
    double k3 = -drag * r3 - (nm * s3 + am * c3) * curl, ds3 = c3 * r3, dc3 = -s3 * r3;
    double r4 = rate + h * k3, s4 = s + h * ds3, c4 = c + h * dc3, k4 = -drag * r4 - (n1 * s4 + a1 * c4) * curl;
    double sn = s + sixth * (ds1 + 2.0 * (ds2 + ds3) + c4 * r4), cn = c + sixth * (dc1 + 2.0 * (dc2 + dc3) - s4 * r4);
    double back = 1.5 - 0.5 * (sn * sn + cn * cn);
    State end = {theta + sixth * (rate + 2.0 * (r2 + r3) + r4), sn * back, cn * back,
                 rate + sixth * (k1 + 2.0 * (k2 + k3) + k4)};
    return end;
}

/* The angle at which the pendulum turns back within the step: Illinois on the rate. */
static double turn(State y, double a0, double slope, double n0, double rise, double h, double curl, double drag,
                   double at_high)
{
    double low = 0.0, high = h, at_low = y.rate, tau = 0.0, angle = y.theta;
    for (int k = 0, side = 0; k < 40; k++) {
        double before = tau;
        tau = trial(low, high, at_low, at_high);
        State at = step(y.theta, y.s, y.c, y.rate, a0, a0 + 0.5 * slope * tau, a0 + slope * tau, n0,
                        n0 + 0.5 * rise * tau, n0 + rise * tau, tau, curl, drag);
        angle = at.theta;
        narrow(&low, &high, &at_low, &at_high, &side, tau, at.rate);
        if (at.rate == 0.0 || fabs(tau - before) < 1e-8 * h || at_high == at_low) break;
    }
    return angle;
}

/* most (m): largest |theta| within the record; each pendulum takes pieces steps a sample; m / LANES whole */
void pendulums(const double *x, const double *z, long n, double dt, const double *length, const double *zeta,
               long pieces, long m, double *most)
{
    double h = dt / pieces;
    for (long first = 0; first < m; first += LANES) {
        double theta[LANES] = {0}, s[LANES] = {0}, c[LANES], rate[LANES] = {0}, curl[LANES], drag[LANES];
        double old[LANES], old_s[LANES], old_c[LANES], old_rate[LANES], top[LANES] = {0}, reach[LANES];
        for (int k = 0; k < LANES; k++) {
            c[k] = 1.0, curl[k] = 1.0 / length[first + k];
            drag[k] = 2.0 * zeta[first + k] * sqrt(G / length[first + k]);
        }
        for (long i = 0; i < n - 1; i++) {
            double slope = (x[i + 1] - x[i]) / dt, rise = (z[i + 1] - z[i]) / dt;
            for (long j = 0; j < pieces; j++) {
                double a0 = x[i] + slope * (j * h), n0 = G + z[i] + rise * (j * h);
                double am = a0 + 0.5 * slope * h, nm = n0 + 0.5 * rise * h, a1 = a0 + slope * h, n1 = n0 + rise * h;
                int turning = 0;
                for (int k = 0; k < LANES; k++) {
                    State y = step(theta[k], s[k], c[k], rate[k], a0, am, a1, n0, nm, n1, h, curl[k], drag[k]);
                    double far = larger(fabs(theta[k]), fabs(y.theta)) + h * larger(fabs(rate[k]), fabs(y.rate));
                    old[k] = theta[k], old_s[k] = s[k], old_c[k] = c[k], old_rate[k] = rate[k];
                    reach[k] = rate[k] * y.rate < 0.0 ? far : 0.0;
                    theta[k] = y.theta, s[k] = y.s, c[k] = y.c, rate[k] = y.rate;
                    top[k] = larger(top[k], fabs(y.theta));
                    turning += reach[k] > top[k];
                }
                if (turning > 0)
                    for (int k = 0; k < LANES; k++)
                        if (reach[k] > top[k]) {
                            State y = {old[k], old_s[k], old_c[k], old_rate[k]};
                            double angle = turn(y, a0, slope, n0, rise, h, curl[k], drag[k], rate[k]);
                            top[k] = larger(top[k], fabs(angle));
                        }
            }
        }
        memcpy(most + first, top, sizeof top);
    }
}

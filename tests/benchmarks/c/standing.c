/* A body that rests, slides, rocks, slide-rocks and flies: kernels/standing.py, standing_phases.py, slip_phase.py.

   Steps, events and impacts are those of the kernels, in their order.  Left out is what follows after the record, what
   is recorded, and bodies too fast to be followed; a step of length 0 is not taken (slips_after). */
#include "line_phase.h"
#include "standing.h"

#define STEP 0.2
#define NEAR 0.05
#define EVENTS 200
#define EVENT_CAP 4
#define BELOW (1.0 - 1e-9)
#define FAINT 1e-13

enum sought { TURN, RATE, SLIP, PRESS };
enum end { NOTHING, STOPS, LIFTS, LANDS, FALLS };

/* -- a step in each mode; each returns until when -- */

static double rest_on(State *q, const Load *f, double t, double span, const Body *b)
{
    double hold1 = smaller(b->mu_s, b->tangent[0]), hold2 = smaller(b->mu_s, b->tangent[1]), way;
    double lift = lift_off(f, t, span, hold1, hold2, &way);
    if (way == 0.0) return span;
    q->v = 0.0, q->way = way;
    go_on_flat(q, f, lift, b);
    return lift;
}

static double slide_on(State *q, const Load *f, double t, double span, const Body *b, Line *line, Found *out)
{
    double n = larger(0.0, weight(f, t)), drag = q->way * b->mu_k, f0 = -push(f, t) - drag * n;
    double f1 = -f->a1 - drag * f->n1, left = span - t, moved, there;
    int lifts = n + f->n1 * left < 0.0;
    if (lifts) left = -n / f->n1;
    expand(line, q->u, q->v, f0, f1);
    double vn = after(line, left, &moved);
    double stop = first_stop(line, q->u, q->v, q->way, f0, f1, left, q->u + moved, vn, &there);
    if (stop >= 0.0) {
        q->u = there, q->v = 0.0, q->way = 0.0;
        track(q, b, out);
        go_on_flat(q, f, t + stop, b);
        return t + stop;
    }
    q->u += moved, q->v = vn;
    track(q, b, out);
    if (!lifts) return span;
    fly(q, b);
    return t + left;
}

/* The length of the step after which a rocking edge begins to slip, which it does before h. */
static double slips_after(Rock y, const Load *f, double t, double h, const Body *b, int i)
{
    double low = 0.0, high = h, tau = 0.0, way, at_low = spare_friction(y, f, t, b, i, f->s, &way);
    if (at_low <= 0.0) return 0.0;
    double at_high = spare_friction(rock_step(y, f, t, h), f, t + h, b, i, f->s, &way);
    for (int k = 0, side = 0; k < 60; k++) {
        double before = tau;
        tau = trial(low, high, at_low, at_high);
        double value = spare_friction(rock_step(y, f, t, tau), f, t + tau, b, i, f->s, &way);
        narrow(&low, &high, &at_low, &at_high, &side, tau, value);
        if (value == 0.0 || fabs(tau - before) <= 1e-15 * tau) break;
    }
    return tau;
}

static double rock_on(State *q, const Load *load, double t, double h, double clock, const Body *b, Found *out)
{
    Rock y = q->turn;
    int i = q->i, slips = 0;
    double alpha = b->alpha[i], falls = larger(FALLING, alpha), landed = -1.0, whole = h, way;
    Load load_of_edge = *load, *f = &load_of_edge;
    f->s = q->s, f->c = b->inverse[i];
    Rock end = rock_step(y, f, t, h);
    if (end.phi > falls && y.phi < falls * BELOW)
        h = locate(y, f, t, 0.0, h, y.phi - falls, end.phi - falls, ANGLE, falls);
    else if (end.phi <= 0.0 || (y.rate < 0.0 && end.rate > 0.0)) {
        landed = landing(y, f, t, h, end);
        if (landed >= 0.0) h = landed;
    } else if (end.phi >= QUARTER) {
        h = locate(y, f, t, 0.0, h, y.phi - QUARTER, end.phi - QUARTER, ANGLE, QUARTER);
        lies(clock + t + h, alpha, out);
        return t + h;
    }
    if (h != whole) end = rock_step(y, f, t, h);
    if (spare_friction(end, f, t + h, b, i, f->s, &way) < 0.0 && !q->hold) {
        double tau = slips_after(y, f, t, h, b, i);
        q->turn = rock_step(y, f, t, tau);
        slips = !jams(q, way, b);
        if (slips) end = q->turn, h = tau, landed = -1.0;
    }
    if (y.rate > 0.0 && end.rate < 0.0 && (y.phi + h * y.rate) / alpha > out->ratio) {
        double tau = locate(y, f, t, 0.0, h, y.rate, end.rate, SPEED, 0.0);
        out->ratio = larger(out->ratio, rock_step(y, f, t, tau).phi / alpha);
    }
    q->turn = y, q->hold = 0;
    double place = track(q, b, out), leaves = sway(q, b);
    q->turn = end;
    double there = track(q, b, out), comes = sway(q, b);
    if (leaves * comes < 0.0 && end.phi <= falls)
        out->away = larger(out->away, fabs(turning_point(place, leaves, there, comes, h)));
    out->ratio = larger(out->ratio, end.phi / alpha);
    if (slips) q->mode = SLIDE_ROCKS, q->way = way, q->v = 0.0;
    else if (landed >= 0.0) land(q, f, t + h, b, out);
    return t + h;
}

/* What turns about a slipping edge. */
typedef struct {
    Rock turn;
    double u, v;
} Slip;

/* Side, friction times direction of the slip, R and rho^2. */
typedef struct {
    double s, drag, arm, rho2;
} Edge;

/* The angular acceleration about a slipping edge, and the acceleration of its slip. */
static inline double slip_acceleration(double rate, double sn, double cs, double a, double n, const Edge *e, double *w)
{
    double q = sn - e->s * e->drag * cs, square = rate * rate;
    double normal = (n - e->arm * cs * square) / (1.0 + e->arm * e->arm * sn * q / e->rho2);
    double turn = -normal * e->arm * q / e->rho2;
    *w = -e->drag * normal - a - e->s * e->arm * (cs * turn + sn * square);
    return turn;
}

static inline Slip slip_step(const Slip *y, const Load *f, double t, double h, const Edge *e)
{
    double half = 0.5 * h, sixth = h / 6.0, rate = y->turn.rate, sn = y->turn.sn, cs = y->turn.cs, w1, w2, w3, w4;
    double am = push(f, t + half), nm = weight(f, t + half), an = push(f, t + h), nn = weight(f, t + h);
    double k1 = slip_acceleration(rate, sn, cs, push(f, t), weight(f, t), e, &w1), ds1 = -rate * cs, dc1 = rate * sn;
    double r2 = rate + half * k1, s2 = sn + half * ds1, c2 = cs + half * dc1;
    double k2 = slip_acceleration(r2, s2, c2, am, nm, e, &w2), ds2 = -r2 * c2, dc2 = r2 * s2;
    double r3 = rate + half * k2, s3 = sn + half * ds2, c3 = cs + half * dc2;
    double k3 = slip_acceleration(r3, s3, c3, am, nm, e, &w3), ds3 = -r3 * c3, dc3 = r3 * s3;
    double r4 = rate + h * k3, s4 = sn + h * ds3, c4 = cs + h * dc3;
    double k4 = slip_acceleration(r4, s4, c4, an, nn, e, &w4);
    double sa = sn + sixth * (ds1 + 2.0 * (ds2 + ds3) - r4 * c4), ca = cs + sixth * (dc1 + 2.0 * (dc2 + dc3) + r4 * s4);
    double back = 1.5 - 0.5 * (sa * sa + ca * ca);
    Slip end = {{y->turn.phi + sixth * (rate + 2.0 * (r2 + r3) + r4), rate + sixth * (k1 + 2.0 * (k2 + k3) + k4),
                 sa * back, ca * back},
                y->u + h * y->v + h * sixth * (w1 + w2 + w3), y->v + sixth * (w1 + 2.0 * (w2 + w3) + w4)};
    return end;
}

static double slip_value(const Slip *y, const Load *f, double t, double h, const Edge *e, enum sought what,
                         double level)
{
    Slip end = slip_step(y, f, t, h, e);
    if (what == PRESS) return weight(f, t + h) - e->arm * end.turn.cs * end.turn.rate * end.turn.rate - level;
    return (what == TURN ? end.turn.phi : what == RATE ? end.turn.rate : end.v) - level;
}

static double slip_locate(const Slip *y, const Load *f, double t, double low, double high, const Edge *e,
                          enum sought what, double level)
{
    double at_low = slip_value(y, f, t, low, e, what, level), at_high = slip_value(y, f, t, high, e, what, level);
    double tau = high;
    for (int k = 0, side = 0; k < 60 && at_high != at_low; k++) {
        double before = tau;
        tau = trial(low, high, at_low, at_high);
        double value = slip_value(y, f, t, tau, e, what, level);
        narrow(&low, &high, &at_low, &at_high, &side, tau, value);
        if (value == 0.0 || fabs(tau - before) <= 1e-15 * tau) break;
    }
    return tau;
}

static double slip_landing(const Slip *y, const Load *f, double t, double h, const Edge *e, Rock end)
{
    double low = 0.0, high = h;
    if (y->turn.phi > 0.0) {
        if (end.phi >= 0.0) {
            if (!(y->turn.rate < 0.0 && end.rate > 0.0)) return -1.0;
            high = slip_locate(y, f, t, 0.0, h, e, RATE, 0.0);
            if (slip_step(y, f, t, high, e).turn.phi >= 0.0) return -1.0;
        }
    } else if (end.phi > 0.0) return -1.0;
    else {
        int k = 0;
        for (low = 0.5 * h; k < 50 && slip_step(y, f, t, low, e).turn.phi <= 0.0; k++) low *= 0.5;
        if (k == 50) return 0.0;
    }
    return slip_locate(y, f, t, low, high, e, TURN, 0.0);
}

/* When a step about a slipping edge ends, and by what. */
static double first_end(const Slip *y, Slip end, const Load *f, double t, double h, const Edge *e, double way,
                        double falls, enum end *event)
{
    double tau = h, p1 = end.turn.phi, r1 = end.turn.rate, low = 0.0;
    *event = NOTHING;
    if (way * end.v <= 0.0) {
        *event = STOPS;
        if (y->v == 0.0) {
            int k = 0;
            for (low = 0.5 * h; k < 40 && way * slip_step(y, f, t, low, e).v <= 0.0; k++) low *= 0.5;
            if (k == 40) return 0.0;
        }
        tau = slip_locate(y, f, t, low, h, e, SLIP, 0.0);
    }
    if (weight(f, t + h) - e->arm * end.turn.cs * r1 * r1 < 0.0) {
        double other = slip_locate(y, f, t, 0.0, h, e, PRESS, 0.0);
        if (other < tau) tau = other, *event = LIFTS;
    }
    if (p1 <= 0.0 || (y->turn.rate < 0.0 && r1 > 0.0)) {
        double other = slip_landing(y, f, t, h, e, end.turn);
        if (other >= 0.0 && (*event == NOTHING || other < tau)) tau = other, *event = LANDS;
    }
    double level = y->turn.phi < falls * BELOW ? falls : QUARTER;
    if (*event == STOPS || *event == LIFTS) p1 = slip_step(y, f, t, tau, e).turn.phi;
    if (*event != LANDS && p1 > level) tau = slip_locate(y, f, t, 0.0, tau, e, TURN, level), *event = FALLS;
    return tau;
}

static double slide_rock_on(State *q, const Load *f, double t, double h, double clock, const Body *b, Found *out)
{
    Slip y = {q->turn, q->u, q->v};
    double way = q->way, alpha = b->alpha[q->i], falls = larger(FALLING, alpha), rate = y.turn.rate;
    Edge edge = {q->s, way * b->mu_k, b->arm[q->i], b->rho2};
    if (weight(f, t) - edge.arm * y.turn.cs * rate * rate < 0.0) {
        fly(q, b);
        return t;
    }
    if (jams(q, way, b)) {
        jam(q, b);
        return t;
    }
    enum end event;
    Slip end = slip_step(&y, f, t, h, &edge);
    double tau = first_end(&y, end, f, t, h, &edge, way, falls, &event);
    if (event == STOPS && tau == 0.0) {
        q->mode = ROCKS, q->hold = 1;
        return t;
    }
    if (event != NOTHING) end = slip_step(&y, f, t, tau, &edge);
    if (rate > 0.0 && end.turn.rate < 0.0 && (y.turn.phi + tau * rate) / alpha > out->ratio) {
        double top = slip_locate(&y, f, t, 0.0, tau, &edge, RATE, 0.0);
        out->ratio = larger(out->ratio, slip_step(&y, f, t, top, &edge).turn.phi / alpha);
    }
    double place = track(q, b, out), leaves = y.v + sway(q, b);
    q->turn = end.turn, q->u = end.u, q->v = end.v;
    double there = track(q, b, out), comes = end.v + sway(q, b);
    if (leaves * comes < 0.0 && end.turn.phi <= falls)
        out->away = larger(out->away, fabs(turning_point(place, leaves, there, comes, tau)));
    out->ratio = larger(out->ratio, end.turn.phi / alpha);
    t += tau;
    if (event == STOPS) q->v = 0.0, go_on_tilted(q, f, t, b);
    else if (event == LIFTS) fly(q, b);
    else if (event == LANDS) land(q, f, t, b, out);
    else if (end.turn.phi >= QUARTER * BELOW) lies(clock + t, alpha, out);
    return t;
}

/* How high above the surface a corner of a flying body is after a step. */
static double clear(const State *q, const Load *f, double t, double h, double side, const Body *b)
{
    double high = q->y + h * (q->vy - h * (0.5 * weight(f, t) + f->n1 * h / 6.0)), phi = q->turn.phi + h * q->turn.rate;
    return high - side * b->half[side > 0.0 ? 0 : 1] * sin(phi) - b->height * cos(phi);
}

/* When within a step a corner of a flying body comes down; -1 if it does not. */
static double touches(const State *q, const Load *f, double t, double h, double side, const Body *b)
{
    double low = 0.0, high = h, tau = h, faint = FAINT * b->height;
    double at_low = clear(q, f, t, low, side, b), at_high = clear(q, f, t, high, side, b);
    if (at_high > (at_low > faint ? 0.0 : -faint)) return -1.0;
    if (at_low <= faint) {
        int k = 0;
        for (low = 0.5 * h; k < 30 && (at_low = clear(q, f, t, low, side, b)) <= faint; k++) low *= 0.5;
        if (k == 30) return 0.0;
    }
    for (int k = 0, last = 0; k < 60; k++) {
        double before = tau;
        tau = trial(low, high, at_low, at_high);
        double value = clear(q, f, t, tau, side, b);
        narrow(&low, &high, &at_low, &at_high, &last, tau, value);
        if (value == 0.0 || fabs(tau - before) <= 1e-15 * tau) break;
    }
    return tau;
}

static double fly_on(State *q, const Load *f, double t, double h, double clock, const Body *b, Found *out)
{
    double phi = q->turn.phi, rate = q->turn.rate, side = phi > 0.0 || (phi == 0.0 && rate >= 0.0) ? 1.0 : -1.0;
    double touched = 0.0, at = touches(q, f, t, h, side, b), a = push(f, t), n = weight(f, t);
    if (at >= 0.0) touched = side, h = at;
    at = touches(q, f, t, h, -side, b);
    if (0.0 <= at && at < h) touched = -side, h = at;
    double falls = larger(FALLING, b->alpha[rate > 0.0 ? 0 : 1]);
    if (fabs(phi) < falls * BELOW && fabs(phi + h * rate) > falls)
        touched = 0.0, h = (falls - copysign(1.0, rate) * phi) / fabs(rate);
    double place = track(q, b, out), leaves = q->vx + drift(q, b);
    q->x += h * (q->vx - h * (0.5 * a + f->a1 * h / 6.0));
    q->y += h * (q->vy - h * (0.5 * n + f->n1 * h / 6.0));
    q->vx -= h * (a + 0.5 * f->a1 * h);
    q->vy -= h * (n + 0.5 * f->n1 * h);
    q->turn.phi = phi += h * rate;
    double there = track(q, b, out), comes = q->vx + drift(q, b);
    if (leaves * comes < 0.0 && fabs(phi) <= falls)
        out->away = larger(out->away, fabs(turning_point(place, leaves, there, comes, h)));
    t += h;
    double alpha = b->alpha[phi > 0.0 ? 0 : 1];
    if (fabs(phi) >= QUARTER) {
        lies(clock + t - (fabs(phi) - QUARTER) / fabs(rate), alpha, out);
        return t;
    }
    out->ratio = larger(out->ratio, fabs(phi) / alpha);
    if (touched != 0.0) {
        take_edge(q, touched);
        q->turn.phi = touched * phi, q->turn.rate = touched * rate;
        q->turn.sn = sin(b->alpha[q->i] - q->turn.phi), q->turn.cs = cos(b->alpha[q->i] - q->turn.phi);
        q->u = q->x - touched * (b->half[q->i] - b->arm[q->i] * q->turn.sn);
        hit(q, f, t, b, out);
    }
    return t;
}

/* -- the whole record -- */

/* One stretch on which push and weight are linear. */
static void stretch(State *q, const Load *f, double span, double clock, long parts, const Body *b, Line *line,
                    Found *out)
{
    double t = 0.0, longest = span, end = span * (1.0 - 1e-14);
    for (int changes = 0; t < end;) {
        enum mode mode = q->mode;
        double side = q->s, before = t, h = span - t;
        if (h > 1.5 * longest) h = longest;
        if (mode == RESTS) t = rest_on(q, f, t, span, b);
        else if (mode == SLIDES) t = slide_on(q, f, t, span, b, line, out);
        else if (mode == ROCKS) t = rock_on(q, f, t, h, clock, b, out);
        else if (mode == SLIDE_ROCKS) t = slide_rock_on(q, f, t, h, clock, b, out);
        else t = fly_on(q, f, t, h, clock, b, out);
        if (out->fell > 0.0) return;
        if (q->mode == mode && q->s == side && t > before) continue;
        if (q->mode >= ROCKS && mode < ROCKS) {
            if (out->lifted_at < 0.0) out->lifted_at = clock + t;
            else if (clock + t < q->until) out->rested = 1.0;
        }
        if (q->lingers > 0.0) q->until = clock + t + q->lingers, q->lingers = 0.0;
        longest = (span - t) / parts;
        if (++changes > EVENTS) {
            out->flags = EVENT_CAP;
            return;
        }
    }
}

/* The sample up to which a body that slides on its base does nothing else: a cubic of time between samples. */
static long glides(const double *x, const double *z, double dt, State *q, double mu, long i, long end, Found *out)
{
    double u = q->u, v = q->v, s = q->way, top = out->away, half = 0.5 * dt * dt, sixth = dt * dt * dt / 6.0;
    long begin = i;
    for (; i < end && G + z[i] >= 0.0 && G + z[i + 1] >= 0.0; i++) {
        double f0 = -x[i] - s * mu * (G + z[i]), f1 = -(x[i + 1] - x[i]) / dt - s * mu * ((z[i + 1] - z[i]) / dt);
        double un = u + v * dt + f0 * half + f1 * sixth, vn = v + f0 * dt + f1 * half;
        if (s * v <= 0.0 || s * vn <= 0.0 || (s * f0 < 0.0 && s * (f0 + f1 * dt) > 0.0)) break;
        u = un, v = vn;
        top = larger(top, fabs(u));
    }
    q->u = u, q->v = v, out->away = top;
    if (i > begin) out->residual = u;
    return i;
}

/* results (m, 10), bodies (m, 24): as in standing_body.py; within the record */
void standing(const double *x, const double *z, const double *ratio, const double *maxima, long n, double dt,
              double most, const Body *bodies, long m, long refine, Found *results)
{
    for (long k = 0; k < m; k++) {
        const Body *b = bodies + k;
        double weakest = smaller(b->mu_s, smaller(b->tangent[0], b->tangent[1]));
        long pieces = (long)larger(1.0, ceil(sqrt(larger(b->inverse[0], b->inverse[1]) * (G + most)) * dt / STEP));
        long parts = refine > 1 ? refine / 2 : 1;
        pieces *= refine;
        double step = dt / pieces, near = NEAR * smaller(b->alpha[0], b->alpha[1]);
        State q = {.mode = RESTS};
        Found found = {.fell_at = -1.0, .lifted_at = -1.0}, *out = &found;
        Line line;
        make_line(&line, 0.0, 0.0, b->mu_k, dt);
        stand_on(&q, 1.0, b);
        for (long i = 0; i < n - 1 && out->fell == 0.0; i++) {
            if (q.mode == RESTS) {
                long ahead = next_above(ratio, maxima, i, n, weakest);
                if (ahead >= n) break;
                if (ahead - 1 > i) i = ahead - 1;
            } else if (q.mode == SLIDES) {
                i = glides(x, z, dt, &q, b->mu_k, i, n - 1, out);
                if (i == n - 1) break;
            }
            double a1 = (x[i + 1] - x[i]) / dt, n1 = (z[i + 1] - z[i]) / dt;
            for (long j = 0; j < pieces && out->fell == 0.0;) {
                double t0 = j * step;
                Load f = {x[i] + a1 * t0, a1, G + z[i] + n1 * t0, n1, 0.0, 0.0};
                /* What rests or slides needs no steps. */
                int whole = q.mode <= SLIDES;
                long few = whole ? parts * (pieces - j) : parts;
                stretch(&q, &f, whole ? dt - t0 : step, i * dt + t0, few, b, &line, out);
                j = whole ? pieces : j + 1;
            }
            if (out->fell == 0.0 && q.mode >= ROCKS && fabs(q.turn.phi) > near) out->last_near = (i + 1) * dt;
        }
        results[k] = found;
    }
}

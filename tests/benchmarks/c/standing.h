/* What a standing body is, its impacts and its changes of mode, as in kernels/standing_body.py and corner_impact.py. */
#pragma once
#include "rock_phase.h"

#define QUARTER 1.5707963267948966
#define REST 1e-4
#define COUNTED 1e-3
#define SETTLING 10.0
#define FALLING 1.2
#define EDGEWISE (1.0 + 1e-9)
#define JAM 0.1

enum mode { RESTS, SLIDES, ROCKS, SLIDE_ROCKS, FLIES };

/* A row of standing_body.py; of two numbers the first is of the edge towards +axis. */
typedef struct {
    double alpha[2], sine[2], cosine[2], tangent[2], inverse[2], arm[2], half[2], gain[2], direct[2];
    double rho2, height, mu_s, mu_k, slow, loss;
} Body;

/* What is found: the columns of the kernel's results. */
typedef struct {
    double ratio, fell, fell_at, lifted_at, impacts, flags, last_near, rested, away, residual;
} Found;

/* Mode, number and side of the edge, its slip and the direction of that, rotation about it; in flight x, y, vx, vy of
   the centre of gravity; whether friction is taken to hold for a step; how long impacts cut off go on, until when. */
typedef struct {
    enum mode mode;
    int i, hold;
    double s, u, v, way, x, y, vx, vy, lingers, until;
    Rock turn;
} State;

static inline double push(const Load *f, double t) { return f->a0 + f->a1 * t; }

static inline double weight(const Load *f, double t) { return f->n0 + f->n1 * t; }

static inline void take_edge(State *q, double s) { q->s = s, q->i = s > 0.0 ? 0 : 1; }

static inline void stand_on(State *q, double s, const Body *b)
{
    take_edge(q, s);
    q->turn.phi = 0.0, q->turn.sn = b->sine[q->i], q->turn.cs = b->cosine[q->i];
}

/* -- impacts: corner_impact.py -- */

/* The impulse (p[0], p[1]) on a corner that comes down, and the velocity along the surface that it is left with. */
static double impulse(double cx, double cy, double rx, double ry, const Body *body, double *p)
{
    double rho2 = body->rho2, mu_s = body->mu_s, mu_k = body->mu_k;
    double a = 1.0 + ry * ry / rho2, b = rx * ry / rho2, c = 1.0 + rx * rx / rho2;
    p[0] = p[1] = 0.0;
    if (cx != 0.0) {
        double way = cx > 0.0 ? 1.0 : -1.0, slow = way * mu_k * a + b, brake = c + way * mu_k * b;
        double stops = cx * slow > 0.0 ? cx / slow : INFINITY, ends = brake > 0.0 ? -cy / brake : INFINITY;
        p[1] = smaller(ends, stops), p[0] = -way * mu_k * p[1];
        if (ends <= stops) return cx - slow * ends;
        cy += brake * stops;
    }
    if (fabs(b) <= mu_s * a) {
        double more = -cy / (c - b * b / a);
        p[0] += b / a * more, p[1] += more;
        return 0.0;
    }
    double way = b > 0.0 ? -1.0 : 1.0, more = -cy / (c + way * mu_k * b);
    p[0] -= way * mu_k * more, p[1] += more;
    return -(way * mu_k * a + b) * more;
}

/* The impulse that stops a slipping corner for good. */
static void held(double cx, double rx, double ry, double rho2, double *p)
{
    double a = 1.0 + ry * ry / rho2, b = rx * ry / rho2, c = 1.0 + rx * rx / rho2, whole = a * c - b * b;
    p[0] = -c * cx / whole, p[1] = -b * cx / whole;
}

/* The velocity along the surface that an impulse py on the whole base leaves. */
static double stopped(double v, double py, const Body *b)
{
    return fabs(v) <= b->mu_s * py ? 0.0 : copysign(larger(0.0, fabs(v) - b->mu_k * larger(0.0, py)), v);
}

/* -- changes of mode: standing_body.py -- */

/* How much more friction a rocking edge has than it needs, and the direction in which it would slip. */
static inline double spare_friction(Rock y, const Load *f, double t, const Body *b, int i, double s, double *way)
{
    double a = push(f, t), n = weight(f, t), square = y.rate * y.rate, arm = b->arm[i];
    double turn = -b->inverse[i] * (n * y.sn + s * a * y.cs);
    double along = a + s * arm * (y.cs * turn + y.sn * square), normal = n + arm * (y.sn * turn - y.cs * square);
    *way = along > 0.0 ? -1.0 : 1.0;
    return b->mu_s * normal - fabs(along);
}

static int jams(const State *q, double way, const Body *b)
{
    double arm = b->arm[q->i], p = q->turn.sn - q->s * way * b->mu_k * q->turn.cs;
    return 1.0 + arm * arm * q->turn.sn * p / b->rho2 < JAM;
}

static void jam(State *q, const Body *b)
{
    double rx = q->s * b->arm[q->i] * q->turn.sn, ry = -b->arm[q->i] * q->turn.cs, p[2];
    held(q->v, rx, ry, b->rho2, p);
    q->turn.rate += q->s * (ry * p[0] - rx * p[1]) / b->rho2;
    q->v = 0.0, q->way = 0.0, q->mode = ROCKS, q->hold = 1;
}

static void fly(State *q, const Body *b)
{
    double s = q->s, arm = b->arm[q->i], rate = q->turn.rate;
    q->x = q->u + s * (b->half[q->i] - arm * q->turn.sn), q->y = arm * q->turn.cs;
    q->vx = q->v + s * arm * q->turn.cs * rate, q->vy = arm * q->turn.sn * rate;
    q->mode = FLIES, q->turn.phi *= s, q->turn.rate *= s;
    take_edge(q, 1.0);
}

static void go_on_flat(State *q, const Load *f, double t, const Body *b)
{
    double v = q->v, way = q->way, a = push(f, t), n = weight(f, t), spare_way;
    int beyond = v == 0.0 && way != 0.0;
    if (!beyond) way = v != 0.0 ? (v > 0.0 ? 1.0 : -1.0) : (a > 0.0 ? -1.0 : 1.0);
    stand_on(q, way, b);
    q->turn.rate = 0.0, q->way = way;
    double tips = b->tangent[q->i] * EDGEWISE;
    enum mode slipping = b->mu_k > tips ? SLIDE_ROCKS : SLIDES;
    if (n < 0.0) fly(q, b);
    else if (v != 0.0 && slipping == SLIDE_ROCKS && jams(q, way, b)) jam(q, b);
    else if (v != 0.0) q->mode = slipping;
    else if (!beyond && fabs(a) <= smaller(b->tangent[q->i], b->mu_s) * n) q->mode = RESTS, q->way = 0.0;
    else if (b->mu_s <= tips) q->mode = SLIDES;
    else if (spare_friction(q->turn, f, t, b, q->i, way, &spare_way) >= 0.0 || jams(q, way, b)) q->mode = ROCKS;
    else q->mode = slipping;
}

static void go_on_tilted(State *q, const Load *f, double t, const Body *b)
{
    q->way = q->v > 0.0 ? 1.0 : -1.0;
    q->mode = SLIDE_ROCKS;
    if (q->v == 0.0 && (spare_friction(q->turn, f, t, b, q->i, q->s, &q->way) >= 0.0 || jams(q, q->way, b)))
        q->mode = ROCKS, q->way = 0.0;
}

/* A corner hits the surface after a flight. */
static void hit(State *q, const Load *f, double t, const Body *b, Found *out)
{
    double s = q->s, r = q->turn.rate, rx = s * b->arm[q->i] * q->turn.sn, ry = -b->arm[q->i] * q->turn.cs, p[2];
    double cx = q->vx + s * r * ry, cy = q->vy - s * r * rx;
    if (-cy >= COUNTED * b->slow * (b->half[0] + b->half[1])) out->impacts += 1.0;
    int flat = r == 0.0 && q->turn.phi == 0.0;
    if (flat) {
        s = cx < 0.0 ? -1.0 : 1.0;
        stand_on(q, s, b);
        double grip = fabs(cx) <= -b->mu_s * cy ? fabs(cx) : -b->mu_k * cy;
        rx = s * b->half[q->i], flat = grip <= -b->tangent[q->i] * EDGEWISE * cy;
    }
    if (flat) cx = stopped(cx, -cy, b);
    else if (cy < 0.0) {
        cx = impulse(cx, cy, rx, ry, b, p);
        q->turn.rate = r + s * (ry * p[0] - rx * p[1]) / b->rho2;
    }
    q->v = cx, q->way = 0.0;
    if (q->turn.phi == 0.0 && q->turn.rate <= 0.0) go_on_flat(q, f, t, b);
    else go_on_tilted(q, f, t, b);
}

/* A rocking body lands on its other edge. */
static void land(State *q, const Load *f, double t, const Body *b, Found *out)
{
    double s = q->s, r = smaller(0.0, q->turn.rate), rate = 0.0, slip = q->v, height = b->height, p[2];
    int i = q->i, j = 1 - i;
    if (-r >= COUNTED * b->slow) out->impacts += 1.0;
    if (r < 0.0) {
        double rx = -s * b->half[j];
        slip = impulse(q->v, (b->half[i] + b->half[j]) * r, rx, -height, b, p);
        rate = -r - s * (-height * p[0] - rx * p[1]) / b->rho2;
        rate = b->gain[i] * rate - b->direct[i] * r;
        if (rate <= 0.0) slip = stopped(q->v + s * height * r, -b->half[i] * r, b);
    }
    stand_on(q, -s, b);
    q->v = slip, q->way = 0.0;
    if (rate < REST * b->slow) {
        double down = b->inverse[j] * (weight(f, t) * q->turn.sn - s * push(f, t) * q->turn.cs) * b->loss;
        q->lingers = down > 0.0 ? SETTLING * 4.0 * rate / down : INFINITY;
        q->turn.rate = 0.0;
        go_on_flat(q, f, t, b);
    } else {
        q->turn.rate = rate;
        go_on_tilted(q, f, t, b);
    }
}

/* -- the middle of the base: standing_body.py -- */

/* Its velocity against the edge. */
static inline double sway(const State *q, const Body *b)
{
    double sine = b->sine[q->i] * q->turn.cs - b->cosine[q->i] * q->turn.sn;
    return q->s * 0.5 * (b->half[0] + b->half[1]) * sine * q->turn.rate;
}

/* Its velocity against the centre of gravity of what flies. */
static double drift(const State *q, const Body *b)
{
    double middle = 0.5 * (b->half[0] - b->half[1]), phi = q->turn.phi;
    return -(middle * sin(phi) + b->height * cos(phi)) * q->turn.rate;
}

static inline double track(const State *q, const Body *b, Found *out)
{
    double place, phi = q->turn.phi;
    if (q->mode == FLIES) {
        place = q->x - 0.5 * (b->half[0] - b->half[1]) * (1.0 - cos(phi)) - b->height * sin(phi);
        if (fabs(phi) > larger(FALLING, b->alpha[0]) * EDGEWISE) return place;
    } else {
        double cosine = phi != 0.0 ? b->cosine[q->i] * q->turn.cs + b->sine[q->i] * q->turn.sn : 1.0;
        place = q->u + q->s * 0.5 * (b->half[0] + b->half[1]) * (1.0 - cosine);
        if (phi > larger(FALLING, b->alpha[q->i]) * EDGEWISE) return place;
    }
    out->away = larger(out->away, fabs(place));
    out->residual = place;
    return place;
}

/* Where the cubic through places and velocities of opposite sign at both ends of a step turns. */
static double turning_point(double x0, double v0, double x1, double v1, double h)
{
    if (h <= 0.0) return x1;
    double slope = (x1 - x0) / h, a = 3.0 * (v0 + v1 - 2.0 * slope), b = 2.0 * (3.0 * slope - 2.0 * v0 - v1);
    double root = sqrt(larger(0.0, b * b - 4.0 * a * v0)), k = 2.0 * v0 / (-b + copysign(root, v0));
    return 0.0 <= k && k <= 1.0 ? x0 + h * k * (v0 + k * (0.5 * b + k * a / 3.0)) : x1;
}

static void lies(double at, double alpha, Found *out)
{
    out->ratio = larger(out->ratio, QUARTER / alpha);
    out->fell = 1.0, out->fell_at = at;
}

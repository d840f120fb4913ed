/* Answers hard rays with the sphere of "Physically Based Rendering", 4th edition, section 6.2.2, as
 * pbrt-v4 has it on CPUs: 32-bit floats in intervals of their rounding errors, and a discriminant
 * from the distance between the line and the centre. Written after the book; pbrt is not called.
 *
 * cc -std=c99 -O2 -ffp-contract=off -o pbrt pbrt.c -lm
 * ./pbrt hard-rays.txt > ANSWERS.txt
 *
 * The sphere is moved to its centre by a transform, whose error the intervals hold. Where an
 * interval leaves in doubt whether the line meets the sphere, or whether a root is before the
 * origin, the book decides for no hit. Its rays begin at zero; others are not asked.
 */

#include "rays.h"

#include <math.h>

struct interval {
    float low, high;
};

static float up(float x) { return nextafterf(x, INFINITY); }
static float down(float x) { return nextafterf(x, -INFINITY); }

static struct interval exactly(float x)
{
    struct interval it = {x, x};
    return it;
}

static struct interval within(float x, float error)
{
    struct interval it = {down(x - error), up(x + error)};
    return error == 0 ? exactly(x) : it;
}

static struct interval sum(struct interval a, struct interval b)
{
    struct interval it = {down(a.low + b.low), up(a.high + b.high)};
    return it;
}

static struct interval difference(struct interval a, struct interval b)
{
    struct interval it = {down(a.low - b.high), up(a.high - b.low)};
    return it;
}

/* The interval around four products or quotients of ends. */
static struct interval around(float a, float b, float c, float d)
{
    struct interval it = {down(fminf(fminf(a, b), fminf(c, d))),
                          up(fmaxf(fmaxf(a, b), fmaxf(c, d)))};
    return it;
}

static struct interval product(struct interval a, struct interval b)
{
    return around(a.low * b.low, a.high * b.low, a.low * b.high, a.high * b.high);
}

static struct interval scaled(float by, struct interval a) { return product(exactly(by), a); }

static struct interval quotient(struct interval a, struct interval b)
{
    if (b.low <= 0 && b.high >= 0) {
        struct interval any = {-INFINITY, INFINITY};
        return any;
    }
    return around(a.low / b.low, a.high / b.low, a.low / b.high, a.high / b.high);
}

static struct interval square(struct interval a)
{
    float least = fminf(fabsf(a.low), fabsf(a.high)), most = fmaxf(fabsf(a.low), fabsf(a.high));
    struct interval it = {a.low <= 0 && a.high >= 0 ? 0 : down(least * least), up(most * most)};
    return it;
}

static struct interval root(struct interval a)
{
    struct interval it = {fmaxf(0, down(sqrtf(a.low))), up(sqrtf(a.high))};
    return it;
}

static float middle(struct interval a) { return (a.low + a.high) / 2; }

static struct interval dot(const struct interval *a, const struct interval *b)
{
    return sum(sum(product(a[0], b[0]), product(a[1], b[1])), product(a[2], b[2]));
}

static struct interval length_squared(const struct interval *a)
{
    return sum(sum(square(a[0]), square(a[1])), square(a[2]));
}

/* Whether the ray hits, with t. */
static int intersect(const struct ray *ray, float *t)
{
    const float half_epsilon = 0x1p-24f, gamma3 = 3 * half_epsilon / (1 - 3 * half_epsilon);
    struct interval o[3], d[3], v[3], radius = exactly(ray->radius);
    for (int axis = 0; axis < 3; axis++) {
        float from = ray->origin[axis], center = ray->center[axis], along = ray->direction[axis];
        o[axis] = within(from - center, gamma3 * (fabsf(from) + fabsf(center)));
        d[axis] = within(along, gamma3 * fabsf(along));
    }
    struct interval a = length_squared(d), b = scaled(2, dot(d, o));
    struct interval c = difference(length_squared(o), square(radius));
    struct interval nearest = quotient(b, scaled(2, a));
    for (int axis = 0; axis < 3; axis++)
        v[axis] = difference(o[axis], product(nearest, d[axis]));
    struct interval distance = root(length_squared(v));
    struct interval discriminant = product(product(scaled(4, a), sum(radius, distance)),
                                           difference(radius, distance));
    if (discriminant.low < 0)
        return 0;
    struct interval at = root(discriminant);
    struct interval q = scaled(-0.5f, middle(b) < 0 ? difference(b, at) : sum(b, at));
    struct interval t0 = quotient(q, a), t1 = quotient(c, q);
    if (t0.low > t1.low) {
        struct interval other = t0;
        t0 = t1;
        t1 = other;
    }
    if (t0.high > ray->t_max || t1.low <= 0)
        return 0;
    if (t0.low <= 0) {
        t0 = t1;
        if (t0.high > ray->t_max)
            return 0;
    }
    *t = middle(t0);
    return 1;
}

int main(int count, char **arguments)
{
    struct rays rays = rays_of(count, arguments);
    struct ray ray;
    float t;
    while (rays_next(&rays, &ray)) {
        if (ray.t_min != 0)
            puts("-");
        else if (intersect(&ray, &t))
            printf("%a\n", (double)t);
        else
            puts("miss");
    }
    return 0;
}

/* Answers hard rays with the quadratic formula as textbooks print it, in 32 or in 64 bits.
 *
 * cc -std=c99 -O2 -ffp-contract=off -o formula32 formula.c -lm
 * cc -std=c99 -O2 -ffp-contract=off -DREAL=double -o formula64 formula.c -lm
 * ./formula64 hard-rays.txt > ANSWERS.txt
 */

#include "rays.h"

#include <tgmath.h>

#ifndef REAL
#define REAL float
#endif

int main(int count, char **arguments)
{
    struct rays rays = rays_of(count, arguments);
    struct ray ray;
    while (rays_next(&rays, &ray)) {
        REAL a = 0, half_b = 0, c = 0, radius = ray.radius;
        for (int axis = 0; axis < 3; axis++) {
            REAL d = ray.direction[axis], o = (REAL)ray.origin[axis] - (REAL)ray.center[axis];
            a += d * d;
            half_b += o * d;
            c += o * o;
        }
        c -= radius * radius;
        REAL b = 2 * half_b;
        REAL discriminant = b * b - 4 * a * c;
        REAL root = sqrt(discriminant);
        REAL near = (-b - root) / (2 * a), far = (-b + root) / (2 * a);
        REAL t = near >= ray.t_min ? near : far;
        if (discriminant >= 0 && t >= ray.t_min && t < ray.t_max)
            printf("%a\n", (double)t);
        else
            puts("miss");
    }
    return 0;
}

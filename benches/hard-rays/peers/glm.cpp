/* Answers hard rays with intersectRaySphere of GLM 0.9.9.8, in 32 or in 64 bits:
 * apt-get install libglm-dev
 *
 * c++ -O2 -ffp-contract=off -o glm32 glm.cpp
 * c++ -O2 -ffp-contract=off -DREAL=double -o glm64 glm.cpp
 * ./glm64 hard-rays.txt > ANSWERS.txt
 *
 * It takes directions of length one, so that each is divided by its length in 64 bits (and rounded,
 * in 32 bits), and t is the distance over that length. It finds nothing nearer than the type's
 * epsilon. A ray with another t_min than zero is not asked.
 */

#include "rays.h"

#include <cmath>

#define GLM_ENABLE_EXPERIMENTAL
#include <glm/glm.hpp>
#include <glm/gtx/intersect.hpp>

#ifndef REAL
#define REAL float
#endif

using Vector = glm::vec<3, REAL, glm::defaultp>;

static Vector vector(const float *x) { return Vector(x[0], x[1], x[2]); }

int main(int count, char **arguments)
{
    rays rays = rays_of(count, arguments);
    ray ray;
    while (rays_next(&rays, &ray)) {
        const float *d = ray.direction;
        double length = std::hypot(double(d[0]), double(d[1]), double(d[2])), t = 0;
        Vector along(glm::dvec3(d[0], d[1], d[2]) / length);
        REAL radius = ray.radius, distance = 0;
        bool is_hit = glm::intersectRaySphere(vector(ray.origin), along, vector(ray.center),
                                              radius * radius, distance);
        t = double(distance) / length;
        if (ray.t_min != 0)
            puts("-");
        else if (is_hit && t < ray.t_max)
            printf("%a\n", t);
        else
            puts("miss");
    }
    return 0;
}

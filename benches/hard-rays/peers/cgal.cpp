/* Answers hard rays with CGAL 5.5.1's exact spherical kernel: apt-get install libcgal-dev
 *
 * c++ -O2 -o cgal cgal.cpp -lgmp -lmpfr
 * ./cgal hard-rays.txt > ANSWERS.txt
 *
 * The line is intersected with the sphere in exact arithmetic. The points have coordinates
 * a + b √c, and t too, which is rounded to the nearest 32-bit float by exact comparisons. That float
 * is compared with the interval, as hard rays ask. Radius zero is not asked: CGAL takes no such
 * sphere here.
 */

#include "rays.h"

#include <CGAL/Exact_spherical_kernel_3.h>
#include <boost/variant.hpp>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

using Kernel = CGAL::Exact_spherical_kernel_3;
using Point = Kernel::Point_3;
using Crossing = std::pair<Kernel::Circular_arc_point_3, unsigned>;

/* The positive 32-bit float of an index among them, from 0x0p+0. */
static float positive(unsigned bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* The 32-bit float that is nearest to t, ties to even. */
static float rounded(const Kernel::Root_of_2 &t)
{
    bool is_negative = t < Kernel::FT(0);
    Kernel::Root_of_2 size = is_negative ? -t : t;
    unsigned low = 0, high = 0x7f800000; /* at or below; above, infinity at last */
    while (high - low > 1) {
        unsigned middle = low + (high - low) / 2;
        (size < Kernel::FT(positive(middle)) ? high : low) = middle;
    }
    if (low == 0x7f7fffff) /* No interval holds the largest float, nor what is beyond. */
        return is_negative ? -INFINITY : INFINITY;
    double half = (double(positive(low)) + double(positive(low + 1))) / 2;
    auto side = CGAL::compare(size, Kernel::FT(half));
    bool is_above = side == CGAL::LARGER || (side == CGAL::EQUAL && low % 2);
    float nearest = positive(is_above ? low + 1 : low);
    return is_negative ? -nearest : nearest;
}

static Point point(const float *x) { return Point(x[0], x[1], x[2]); }

int main(int count, char **arguments)
{
    rays rays = rays_of(count, arguments);
    ray ray;
    while (rays_next(&rays, &ray)) {
        const float *d = ray.direction;
        if (ray.radius == 0) {
            puts("-");
            continue;
        }
        int axis = 0;
        for (int other = 1; other < 3; other++)
            if (std::fabs(d[other]) > std::fabs(d[axis]))
                axis = other;
        Kernel::FT radius(ray.radius), along(d[axis]), from(ray.origin[axis]);
        Kernel::Sphere_3 sphere(point(ray.center), radius * radius);
        Kernel::Line_3 line(point(ray.origin), Kernel::Vector_3(d[0], d[1], d[2]));
        std::vector<CGAL::SK3_Intersection_traits<Kernel, Kernel::Sphere_3, Kernel::Line_3>::type>
            found;
        CGAL::intersection(sphere, line, std::back_inserter(found));
        std::optional<float> least;
        for (const auto &each : found) {
            const Kernel::Circular_arc_point_3 &at = boost::get<Crossing>(&each)->first;
            auto x = axis == 0 ? at.x() : axis == 1 ? at.y() : at.z();
            float t = rounded((x - from) / along);
            if (t >= ray.t_min && t < ray.t_max && (!least || t < *least))
                least = t;
        }
        if (least)
            printf("%a\n", double(*least));
        else
            puts("miss");
    }
    return 0;
}

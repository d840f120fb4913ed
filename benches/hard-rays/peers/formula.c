/* Answers hard rays with the quadratic formula as textbooks print it, in 32 or in 64 bits.
 *
 * cc -std=c99 -O2 -ffp-contract=off -o formula32 formula.c -lm
 * cc -std=c99 -O2 -ffp-contract=off -DREAL=double -o formula64 formula.c -lm
 * ./formula64 hard-rays.txt > ANSWERS.txt
 */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <tgmath.h>

#ifndef REAL
#define REAL float
#endif

int main(int count, char **arguments)
{
    FILE *rays = count == 2 ? fopen(arguments[1], "r") : NULL;
    if (!rays) {
        fprintf(stderr, "usage: %s hard-rays.txt\n", arguments[0]);
        return 2;
    }
    char line[1024];
    while (fgets(line, sizeof line, rays)) {
        if (line[0] == '#')
            continue;
        REAL x[12];
        char *rest = line;
        (void)strtol(rest, &rest, 10);
        for (int index = 0; index < 12; index++)
            x[index] = (REAL)strtod(rest, &rest);
        REAL o[3] = {x[0] - x[8], x[1] - x[9], x[2] - x[10]}, *d = x + 3, radius = x[11];
        REAL a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        REAL b = 2 * (o[0] * d[0] + o[1] * d[1] + o[2] * d[2]);
        REAL c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - radius * radius;
        REAL discriminant = b * b - 4 * a * c;
        REAL root = sqrt(discriminant);
        REAL near = (-b - root) / (2 * a), far = (-b + root) / (2 * a);
        REAL t = near >= x[6] ? near : far;
        if (discriminant >= 0 && t >= x[6] && t < x[7])
            printf("%a\n", (double)t);
        else
            puts("miss");
    }
    return 0;
}

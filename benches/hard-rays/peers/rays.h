/* Reads hard-rays.txt for the programs in this folder, C99 or C++; answers of theirs are printed.
 *
 * An answer is a line: "miss", t, "hit" for a hit without its t, or "-" for a ray not asked.
 */

#ifndef RAYS_H
#define RAYS_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A ray and its sphere. Each number is a 32-bit float. */
struct ray {
    float origin[3], direction[3], t_min, t_max, center[3], radius;
};

struct rays {
    const char *name;
    FILE *file;
    long line;
};

static inline void rays_fail(const struct rays *rays, const char *what)
{
    fprintf(stderr, "%s:%ld: %s\n", rays->name, rays->line, what);
    exit(2);
}

/* A next line of any length that fits; 0 at the end. */
static inline int rays_line(struct rays *rays, char *line, int size)
{
    rays->line++;
    if (!fgets(line, size, rays->file)) {
        if (ferror(rays->file))
            rays_fail(rays, "cannot be read");
        return 0;
    }
    if (!strchr(line, '\n'))
        rays_fail(rays, "a line that is cut off, or too long");
    return 1;
}

static inline struct rays rays_open(const char *name)
{
    char line[1024];
    struct rays rays;
    rays.name = name;
    rays.file = fopen(name, "r");
    rays.line = 0;
    if (!rays.file) {
        perror(name);
        exit(2);
    }
    if (!rays_line(&rays, line, sizeof line) || strncmp(line, "# hard-rays 1,", 14))
        rays_fail(&rays, "not hard rays of version 1");
    return rays;
}

/* Opens the only argument of a program. */
static inline struct rays rays_of(int count, char **arguments)
{
    if (count != 2) {
        fprintf(stderr, "usage: %s hard-rays.txt\n", arguments[0]);
        exit(2);
    }
    return rays_open(arguments[1]);
}

/* Reads the next ray; 0 at the end of the file. */
static inline int rays_next(struct rays *rays, struct ray *ray)
{
    char line[1024];
    do {
        if (!rays_line(rays, line, sizeof line))
            return 0;
    } while (line[0] == '#');
    float x[12];
    char *rest = line, *end;
    strtol(rest, &end, 10);
    for (int index = 0; index < 12; index++) {
        rest = end;
        x[index] = strtof(rest, &end);
        if (end == rest)
            rays_fail(rays, "not the twelve numbers of a ray");
    }
    memcpy(ray->origin, x, sizeof ray->origin);
    memcpy(ray->direction, x + 3, sizeof ray->direction);
    ray->t_min = x[6];
    ray->t_max = x[7];
    memcpy(ray->center, x + 8, sizeof ray->center);
    ray->radius = x[11];
    return 1;
}

#endif

/* Scores a program's answers to hard rays: docs/hard-rays.md. C99, and no library but C's.
 *
 * cc -std=c99 -o score score.c
 * ./score hard-rays.txt ANSWERS.txt     a line for each ray
 *
 * An answer is "miss"; t, decimal or hexadecimal; "hit" for a hit without its t; or "-" for a ray
 * that was not asked, which does not count.
 */

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE = 1024, SETS = 256, NAME = 56 };

struct score {
    long rays, false_hits, missed, hits, nearest;
    unsigned long worst;
};

static void fail(const char *file, const char *what, long line)
{
    fprintf(stderr, "%s:%ld: %s\n", file, line, what);
    exit(2);
}

/* The place of a 32-bit float among all of them. */
static int64_t place(float t)
{
    uint32_t bits;
    memcpy(&bits, &t, sizeof bits);
    int64_t size = bits & 0x7fffffffu;
    return bits >> 31 ? -size : size;
}

static void add(struct score *to, const struct score *of)
{
    to->rays += of->rays;
    to->false_hits += of->false_hits;
    to->missed += of->missed;
    to->hits += of->hits;
    to->nearest += of->nearest;
    if (of->worst > to->worst)
        to->worst = of->worst;
}

/* The first bytes of a name that fit, without a part of a character. */
static void shorten(char *to, const char *from)
{
    size_t at = 0, characters = 0;
    while (from[at] && from[at] != '\n') {
        if (((unsigned char)from[at] & 0xc0) != 0x80 && ++characters > 55)
            break;
        if (at + 1 >= 4 * NAME)
            break;
        to[at] = from[at];
        at++;
    }
    to[at] = 0;
}

static void print(const char *name, const struct score *of)
{
    size_t characters = 0;
    for (const char *at = name; *at; at++)
        characters += ((unsigned char)*at & 0xc0) != 0x80;
    printf("%s%*s %7ld %7ld %7ld %7ld %7ld %11lu\n", name, (int)(55 - characters), "", of->rays,
           of->false_hits, of->missed, of->nearest, of->hits, of->worst);
}

int main(int count, char **arguments)
{
    static struct score sets[SETS];
    static char names[SETS][4 * NAME];
    char line[LINE], answer[LINE];
    struct score families = {0}, all = {0};
    long number = 0, answered = 0;
    int known = 0, first = SETS, last = -1;
    if (count != 3) {
        fprintf(stderr, "usage: %s hard-rays.txt ANSWERS.txt\n", arguments[0]);
        return 2;
    }
    FILE *rays = fopen(arguments[1], "r"), *answers = fopen(arguments[2], "r");
    if (!rays || !answers) {
        perror(arguments[rays ? 2 : 1]);
        return 2;
    }
    while (fgets(line, LINE, rays)) {
        int set = 0, at = 0;
        number++;
        if (number == 1 && strncmp(line, "# hard-rays 1,", 14))
            fail(arguments[1], "not hard rays of version 1", number);
        if (sscanf(line, "# set %d: %n", &set, &at) == 1 && at) {
            if (set < 0 || set >= SETS)
                fail(arguments[1], "too many sets", number);
            shorten(names[set], line + at);
            known = set + 1;
        }
        (void)sscanf(line, "# families: sets %d to %d", &first, &last);
        if (line[0] == '#')
            continue;
        char *rest = line;
        set = (int)strtol(rest, &rest, 10);
        if (set < 0 || set >= known)
            fail(arguments[1], "an unknown set", number);
        for (int skipped = 0; skipped < 12; skipped++)
            (void)strtod(rest, &rest);
        while (*rest == ' ')
            rest++;
        int must_hit = !strncmp(rest, "hit ", 4);
        double right = must_hit ? strtod(rest + 4, NULL) : 0.0;
        if (fscanf(answers, "%1023s", answer) != 1)
            fail(arguments[2], "fewer answers than rays", answered);
        answered++;
        char *end;
        double t = strtod(answer, &end);
        if (!strcmp(answer, "-"))
            continue;
        int has_t = strcmp(answer, "miss") != 0 && strcmp(answer, "hit") != 0;
        if (has_t && (end == answer || *end))
            fail(arguments[2], "neither miss, hit, - nor a number", answered);
        int is_hit = has_t ? isfinite(t) : !strcmp(answer, "hit");
        struct score *of = &sets[set];
        of->rays++;
        if (!must_hit) {
            of->false_hits += is_hit;
        } else if (!is_hit) {
            of->missed++;
        } else {
            of->hits++;
            if (!has_t)
                continue;
            int64_t apart = place((float)t) - place((float)right);
            unsigned long error = (unsigned long)(apart < 0 ? -apart : apart);
            of->nearest += error == 0;
            if (error > of->worst)
                of->worst = error;
        }
    }
    if (fscanf(answers, "%1023s", answer) == 1)
        fail(arguments[2], "more answers than rays", answered + 1);
    printf("%-55s %7s %7s %7s %7s %7s %11s\n", "set", "rays", "false", "missed", "nearest", "of hits",
           "worst ulp");
    for (int set = 0; set < known; set++) {
        print(names[set], &sets[set]);
        add(&all, &sets[set]);
        if (set >= first && set <= last)
            add(&families, &sets[set]);
    }
    print("families", &families);
    print("all", &all);
    return 0;
}

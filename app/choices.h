/* A grid of settings: several values for each of some paths of a scene. Point k is one choice of
 * them all, the last path's value changing first. */
#ifndef CHOICES_H
#define CHOICES_H

#include <stdbool.h>
#include <stdio.h>

struct axis {
    char *path;   /* of the scene, as in --set */
    int count;    /* of values */
    char **value; /* count: JSON, or a text as --set takes it */
};

struct choices {
    int axes;
    struct axis *axis;
};

/* Adds PATH=VALUE,VALUE,...; a comma within brackets, braces or quotes belongs to a value. false
 * with a message on a text that is none, on a path that is there, and without memory. */
bool choices_add(struct choices *choices, const char *text);
void choices_free(struct choices *choices);

long choices_count(
    const struct choices *choices); /* points; at most CHOICES_MOST, then CHOICES_MOST + 1 */
enum { CHOICES_MOST = 1000000 };

/* The value of an axis at a point. */
const char *choices_value(const struct choices *choices, long point, int axis);

/* Points as lists of overrides, PATH=VALUE. NULL without memory; to be freed with settings_free. */
char **choices_settings(const struct choices *choices, long point);
void settings_free(char **set, int count);

#endif

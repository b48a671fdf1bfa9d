/* Where the pictures of `projdyn render` go: a PNG file, or a film that ffmpeg makes. */
#ifndef FILM_H
#define FILM_H

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

enum film_format { FILM_PNG, FILM_MP4, FILM_WEBM, FILM_GIF, FILM_FORMATS };

struct film {
    enum film_format format;
    const char *path;
    FILE *file;      /* the PNG file, or the pipe to ffmpeg; NULL: closed */
    char *temporary; /* the film while it is made; see new_file.h for a PNG */
    pid_t process;   /* ffmpeg */
};

/* Format by the ending of a file name; false if it is none of them. */
bool film_find_format(const char *path, enum film_format *format);

/* Functions that return int return an exit code, after a message unless it is EXIT_GOOD. The
 * caller calls film_close() in any case. */

/* Opens the output. fps: pictures per second of a film */
int film_open(struct film *film, const char *path, double fps);
/* Adds a picture, a PNG in base64. */
int film_add(struct film *film, const char *picture);
/* good: the output appears at its path; otherwise nothing is left. */
int film_close(struct film *film, bool good);

#endif

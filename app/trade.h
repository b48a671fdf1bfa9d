/* projdyn trade: what a millisecond buys. */
#ifndef TRADE_H
#define TRADE_H

#include "plan.h"
#include "track.h"

#include <stdio.h>

enum { TRADE_WORST = TRACK_MEASURES }; /* the largest of the measures */

struct tried {
    const struct setting *setting;
    bool good;    /* it ended well; otherwise the rest is empty */
    bool front;   /* nothing is both as fast and more accurate */
    bool checked; /* its time was measured twice */
    double ms;    /* of processor time, for a frame */
    double error[TRACK_MEASURES + 1];
    double residual; /* mean step residual */
};

struct trade {
    int count, by;                     /* by: the measure that decides */
    struct tried *tried;               /* count */
    const char *reference;             /* its settings */
    double unsure[TRACK_MEASURES + 1]; /* its own errors */
    double per_second;                 /* frames */
};

/* It ended well, and is nearer to the reference than all that happens there. */
static inline bool tried_counts(const struct tried *tried, int by) {
    return tried->good && tried->error[by] < 1.0;
}

/* Marks the front of those that count. */
void front_find(struct trade *trade);
void front_print(const struct trade *trade, FILE *file);
/* DIRECTORY/trade.csv, and trade.svg and trade.png where there is gnuplot. An exit code. */
int front_write(const struct trade *trade, const char *directory);

#endif

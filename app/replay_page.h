/* The page template; @META@ and @DATA@ stand for what a run adds. Ends with a zero byte. */
#ifndef REPLAY_PAGE_H
#define REPLAY_PAGE_H

extern const char replay_page[];

#endif

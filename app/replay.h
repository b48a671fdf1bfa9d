/* projdyn replay: packs the frames of a run into one HTML page. */
#ifndef REPLAY_H
#define REPLAY_H

#include <stddef.h>

int replay_main(int argc, char **argv);

/* The page with its placeholders @META@ and @DATA@, replay.html as it was when this was built. */
extern const char replay_page[];
size_t replay_page_size(void);

#endif

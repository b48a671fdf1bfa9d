/* Embeds the page. REPLAY_HTML: where it lies. */
#include "replay.h"

extern const char replay_page_end[];

__asm__(".section .rodata\n"
        ".global replay_page, replay_page_end\n"
        "replay_page:\n"
        ".incbin \"" REPLAY_HTML "\"\n"
        "replay_page_end:\n"
        ".byte 0\n"
        ".previous\n");

size_t replay_page_size(void) { return (size_t)(replay_page_end - replay_page); }

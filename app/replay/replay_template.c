/* Embeds replay.html into the program. REPLAY_HTML: path of the file at build time. */
#include "replay_page.h"

extern const char replay_template_end[];

__asm__(".section .rodata\n"
        ".global replay_template, replay_template_end\n"
        "replay_template:\n"
        ".incbin \"" REPLAY_HTML "\"\n"
        "replay_template_end:\n"
        ".byte 0\n"
        ".previous\n");

size_t replay_template_size(void) { return (size_t)(replay_template_end - replay_template); }

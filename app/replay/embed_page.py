#!/usr/bin/env python3
"""Joins the replay page into one C array. Usage: embed_page.py page.html OUTPUT.c

A line @FILE@ of the page stands for the file of that name in the same folder. Placeholders without a dot in
their name (@META@, @DATA@) stay."""
import pathlib
import re
import sys

page = pathlib.Path(sys.argv[1])
text = re.sub(r"^@(\w+\.\w+)@$", lambda match: (page.parent / match[1]).read_text("utf-8").rstrip("\n"),
              page.read_text("utf-8"), flags=re.MULTILINE)
numbers = ",".join(str(byte) if byte < 128 else f"'\\{byte:o}'" for byte in text.encode("utf-8"))
pathlib.Path(sys.argv[2]).write_text(
    f'/* {page.name}, joined by embed_page.py */\n#include "replay_page.h"\nconst char replay_template[] = {{{numbers},0}};\n')

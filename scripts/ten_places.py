#!/usr/bin/env python3
"""Draws ten source files at random and prints the first five lines of each and one of its functions
with its doc comment (of a public function: the declaration, too). To read the source as a newcomer does.

Usage: ten_places.py SEED    the same seed and the same source give the same ten places
"""
import pathlib
import random
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# A function definition at the start of a line: (static, name).
FUNCTION = re.compile(r"^(static |INLINE |WIDE )*[a-zA-Z_][^;{}()=#/]*?\b(\w+)\([^;{}]*\)\s*\{", re.M)


def blocks(path):
    """Pieces of a file between empty lines: a function with its doc comment is one piece."""
    return re.split(r"\n\n(?=\S)", path.read_text())


def declaration(name):
    for header in sorted(p for folder in ["src", "app", "include"] for p in (ROOT / folder).rglob("*.h")):
        for block in blocks(header):
            if re.search(rf"^[^/ *].*\b{name}\(", block, re.M):
                return f"\n{header.relative_to(ROOT)}:\n{block.rstrip()}"
    return ""


generator = random.Random(int(sys.argv[1]))
files = sorted(p for folder in ["src", "app"] for p in (ROOT / folder).rglob("*.c"))
for number, path in enumerate(generator.sample(files, 10), 1):
    found = [(block, match) for block in blocks(path) if (match := FUNCTION.search(block))]
    commented = [one for one in found if one[0].startswith("/*") or not one[1][1]]
    block, match = generator.choice(commented or found or [("", None)])
    print(f"==== {number}. {path.relative_to(ROOT)}")
    print("\n".join(path.read_text().splitlines()[:5] + ["...", block.rstrip()]))
    if match and not match[1] and not block.startswith("/*"):
        print(declaration(match[2]))
    print()

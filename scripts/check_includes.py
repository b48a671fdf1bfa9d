#!/usr/bin/env python3
"""Checks that the folders of src/ and app/ include one way (docs/architecture.md, Folders).

A folder of src/core may include itself and the folders before it in CORE; the other folders may
include what ALLOWED lists: a constraint or a solver includes no more than a plug-in can. Prints each include that goes against this, and exits with 1.
"""
import pathlib
import re
import sys

CORE = ["base", "geometry", "scene", "sph", "rows", "contact", "objective", "sim", "step", "setup", "output"]
ALLOWED = {
    "constraints": [],
    "solvers": [],
    "conformance": CORE,
    "app": ["replay"],  # the reader of a run, of `projdyn mesh`
}

root = pathlib.Path(__file__).resolve().parent.parent
faults = 0


def check(folder, name, allowed):
    global faults
    for path in sorted(folder.rglob("*.[ch]")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            include = re.match(r'#include "([a-z_]+)/', line)
            if not include or include[1] in ("projdyn", name):
                continue
            if include[1] not in allowed:
                print(f"{path.relative_to(root)}:{number}: {name} must not include {include[1]}/")
                faults += 1


for place, name in enumerate(CORE):
    check(root / "src/core" / name, name, CORE[:place])
for name, allowed in ALLOWED.items():
    check(root / (name if name == "app" else "src/" + name), name, allowed)
unknown = {p.name for p in (root / "src/core").iterdir()} - set(CORE)
if unknown:
    print(f"src/core: not in a folder that this script knows: {', '.join(sorted(unknown))}")
    faults += 1
sys.exit(faults > 0)

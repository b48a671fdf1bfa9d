#!/usr/bin/env python3
"""abi.py BASELINE OBJECT [--update]: the second half of abi.sh.

Reads the interface from the debug information of OBJECT and compares it with BASELINE, or writes BASELINE. A struct
that a function gets together with its size may grow beyond its old size (projdyn.h); there may be new functions,
structs and enumerators. Every other difference is printed, and the exit code is 1.
"""
import json
import pathlib
import re
import subprocess
import sys


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def tidy(declaration):
    return re.sub(r"\s+", " ", declaration).replace("* *", "**")


def read_interface(path):
    """functions: prototypes; structs: name: size in bytes, and members with their offsets; enumerators with values."""
    functions, structs = [], {}
    for name, body in re.findall(r"^(?:struct|union) (?!__)(\w+) \{\n(.*?)^\}", output("pahole", "-F", "dwarf", path),
                                 re.M | re.S):
        members = [(int(offset), tidy(text)) for text, offset in re.findall(r"^\t(.*);\s*/\*\s*(\d+)\s+\d+ \*/$", body, re.M)]
        if name == "functions":
            functions = [re.sub(r"\(\*(\w+)\)", r"\1", text, count=1) for _, text in members]
        else:
            structs[name] = {"size": int(re.search(r"/\* size: (\d+)", body)[1]),
                             "members": [f"{offset}: {text}" for offset, text in members]}
    enumerators = re.findall(r"\(DW_TAG_enumerator\)\n.*DW_AT_name.*\b(PDYN_\w+)\s*\n.*DW_AT_const_value\s*: (-?\w+)",
                             output("readelf", "--debug-dump=info", path))
    return {"functions": sorted(functions), "structs": structs, "enumerators": [f"{name} = {int(value, 0)}" for name, value in enumerators]}


def differences(old, new):
    grows = re.findall(r"(\w+) \*, size_t", "\n".join(old["functions"]))
    for kind in ("functions", "enumerators"):
        for entry in old[kind]:
            if entry not in new[kind]:
                yield f"removed or changed: {entry}"
    for name, was in old["structs"].items():
        now = new["structs"].get(name, {"size": 0, "members": []})
        for member in was["members"]:
            if member not in now["members"]:
                yield f"removed or changed: struct {name}, {member}"
        for member in now["members"]:
            end = was["size"] if name in grows else now["size"]
            if member not in was["members"] and int(member.split(":")[0]) < end:
                yield f"added: struct {name}, {member}"


baseline, current = pathlib.Path(sys.argv[1]), read_interface(sys.argv[2])
if sys.argv[3:] == ["--update"]:
    baseline.write_text(json.dumps(current, indent=1) + "\n")
faults = list(differences(json.loads(baseline.read_text()), current))
if faults:
    sys.exit("\n".join(faults) + f"\nThe interface differs from {baseline}: CHANGELOG.md, Versions, says what that raises.")
print(f"{baseline}: compatible, {len(current['functions'])} functions, {len(current['structs'])} structs")

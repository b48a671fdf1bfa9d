#!/usr/bin/env python3
"""Checks the form of README.md and docs/: links lead to a file and a heading, rows of a table have
as many cells as its head, lines of prose have at most 100 columns.

Usage: check_documents.py ROOT
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1]).resolve()
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
LINK = re.compile(r"\]\(([^)\s]+)\)")
COLUMNS = 100


def lines_of(path):
    """The lines of a document with their numbers, without code blocks."""
    code = False
    for number, line in enumerate(path.read_text().split("\n"), 1):
        if line.startswith("```"):
            code = not code
        elif not code:
            yield number, line


def anchors_of(path):
    """The anchors that GitHub gives to the headings of a document."""
    headings = [line.lstrip("#") for _, line in lines_of(path) if re.match("#+ ", line)]
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings}


def link_fault(path, link):
    name, _, anchor = link.partition("#")
    target = (path.parent / name).resolve() if name else path
    if not target.exists():
        return f"no file {name}"
    return f"no heading #{anchor} in {target.name}" if anchor and anchor not in anchors_of(target) else ""


def faults_of(path):
    cells = 0  # of the row above, 0: none
    for number, line in lines_of(path):
        for link in LINK.findall(line):
            if not link.startswith("http") and link_fault(path, link):
                yield number, link_fault(path, link)
        row = line.lstrip().startswith("|")
        found = len(re.findall(r"(?<!\\)\|", line)) if row else 0
        if row and cells and found != cells:
            yield number, f"{found - 1} cells, the row above has {cells - 1}"
        cells = found
        if len(line) > COLUMNS and not row and not line.startswith(("    ", "![")):
            yield number, f"{len(line)} columns, expected at most {COLUMNS}"


faults = [f"{path.relative_to(ROOT)}:{number}: {text}" for path in DOCUMENTS for number, text in faults_of(path)]
print("\n".join(faults))
sys.exit(bool(faults))

#!/usr/bin/env python3
"""Prints the size and structure of the source: lines, files and long functions per folder, and for
src/solvers and src/core the implementations of H u and of its block diagonal, Krylov loops, Cholesky
factorisations and includes against the arrows. The patterns below look at names and shapes of
functions, not at what these do: read the printed list before comparing two versions.

Usage: counts.py [--short] [FOLDER]    --short: numbers only; FOLDER: another checkout than this one
"""
import collections
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(next((a for a in sys.argv[1:] if a != "--short"), f"{__file__}/../..")).resolve()
FOLDERS = ["src", "app", "include", "tests", "bench"]
SUFFIXES = {".c", ".h", ".py", ".sh", ".html"}
LONG = 60  # lines of a function, from its name to its closing brace

# A function definition as clang-format leaves it: name, parameters, body up to a brace in column 0.
FUNCTION = re.compile(r"^(?!typedef)[A-Za-z_][^;{}#=]*?\b(\w+)\(([^;{}]*)\)\s*"
                      r"\{(?:\n(.*?)^\}|([^\n]*)\}$)", re.M | re.S)
# y = H u: named *_apply, *product or *multiply, with an input and an output vector. Functions of one
# statement are left out here and for the diagonal: they call another implementation.
PRODUCT_NAME = re.compile(r"(^|_)(apply|product|multiply)$")
PRODUCT_PARAMETERS = re.compile(r"const (double|float) \*\w+, (double|float) \*\w+")
# A preconditioner has the same shape: r, z instead of u, y.
PRECONDITIONER = re.compile(r"jacobi|coarse|two_level|precondition|factor|const (double|float) \*r\b")
# The diagonal 3 x 3 blocks of H: named *diagonal, with an array to write to.
DIAGONAL_NAME = re.compile(r"(^|_)diagonal$")
DIAGONAL_PARAMETERS = re.compile(r"(double|float) \*\w*(block|diagonal|inverse|out)\w*")
# A loop until convergence has a limit of iterations in its head. A Krylov loop counts them in head or
# body; a loop around a Krylov loop leaves that to the function that it calls.
LOOP = re.compile(r"^( +)(?:for|while) \((?:[^{};]|;(?! *$))*?\biterations\b(?:[^{}])*?\) \{\n(.*?)^\1\}",
                  re.M | re.S)
COUNTS_ITERATIONS = re.compile(r"\+\+\*?\w*(->)?iterations|\(\*\w*iterations\)\+\+|iterations\+\+")
# A factorisation of H or of a coarse matrix: a call of CHOLMOD or LAPACK, or a pivot's square root.
CHOLESKY = re.compile(r"cholmod_\w*factorize\w*\(|potrf|1\.0F? / sqrtf?\((?:rest|pivot|diagonal)\b"
                      r"|sqrtf?\((?:pivot|rest)\b")


def strip(text, suffix):
    """The text without comments, with its line breaks."""
    if suffix in {".c", ".h", ".html"}:
        text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m[0].count("\n"), text, flags=re.S)
        return re.sub(r"(?<![:\"'])//[^\n]*", "", text)
    text = re.sub(r'^\s*""".*?"""', "", text, flags=re.S | re.M)
    return re.sub(r"^\s*#.*$", "", text, flags=re.M)


def functions(path):
    """Name, parameters, body and number of lines of each function of a C file; of others none."""
    code = strip(path.read_text(), path.suffix) if path.suffix in {".c", ".h"} else ""
    for match in FUNCTION.finditer(code):
        yield match[1], " ".join(match[2].split()), match[3] or match[4], match[0].count("\n") + 1


def print_sizes():
    print(f"{'folder':24} {'files':>5} {'lines':>7} {'code':>7} {'functions above ' + str(LONG) + ' lines':>27}")
    long_functions = []
    for folder in FOLDERS:
        rows = collections.defaultdict(lambda: [0, 0, 0, 0])
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix not in SUFFIXES or not path.is_file():
                continue
            text = path.read_text()
            long = [(n, size) for n, _, _, size in functions(path) if size > LONG]
            long_functions += [f"{path.relative_to(ROOT)}: {name}, {size} lines" for name, size in long]
            code = sum(bool(line.strip()) for line in strip(text, path.suffix).splitlines())
            for key in {str(path.parent.relative_to(ROOT)), folder + " in all"}:
                rows[key] = [a + b for a, b in zip(rows[key], [1, text.count("\n"), code, len(long)])]
        if len(rows) == 2:
            del rows[folder + " in all"]
        for name, (files, lines, code, long) in sorted(rows.items()):
            print(f"{name:24} {files:5} {lines:7} {code:7} {long:27}")
    return long_functions


def find(what):
    found = []
    for folder in ["src/solvers", "src/core"]:
        for path in sorted((ROOT / folder).rglob("*.[ch]")):
            found += [f"{path.relative_to(ROOT)}: {name}" for name, p, body, _ in functions(path) if what(name, p, body)]
    return found


def is_product(name, parameters, body):
    preconditioner = PRECONDITIONER.search(name + " " + parameters)
    return PRODUCT_NAME.search(name) and PRODUCT_PARAMETERS.search(parameters) and not preconditioner \
        and body.count(";") > 1


def is_diagonal(name, parameters, body):
    return DIAGONAL_NAME.search(name) and DIAGONAL_PARAMETERS.search(parameters) and body.count(";") > 1


def loops(body, counting):
    return any(bool(COUNTS_ITERATIONS.search(m[0])) == counting for m in LOOP.finditer(body))


def main():
    check = ROOT / "scripts/check_includes.py"
    arrows = subprocess.run([sys.executable, check], capture_output=True, text=True).stdout.splitlines()
    long_functions = print_sizes()
    counts = {
        f"functions above {LONG} lines": long_functions,
        "implementations of H u": find(is_product),
        "implementations of the block diagonal": find(is_diagonal),
        "Krylov loops": find(lambda n, p, b: loops(b, True)),
        "loops around Krylov loops": find(lambda n, p, b: loops(b, False)),
        "Cholesky factorisations, with calls of CHOLMOD": find(lambda n, p, b: CHOLESKY.search(b)),
        "includes against the arrows": arrows if check.exists() else ["no scripts/check_includes.py"],
    }
    for what, found in counts.items():
        print(f"\n{what}: {len(found)}")
        if "--short" not in sys.argv:
            print("".join(f"    {one}\n" for one in found), end="")


main()

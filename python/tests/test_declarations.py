"""The declarations of the package are those of the headers."""
import ctypes
import os
import pathlib
import re
import unittest

from projdyn import _library, _structs

INCLUDE = pathlib.Path(os.environ["PROJDYN_SOURCE_ROOT"], "include/projdyn")
HEADERS = "\n".join(re.sub(r"/\*.*?\*/", "", (INCLUDE / name).read_text(), flags=re.S)
                    for name in ("projdyn.h", "scene.h", "control.h", "probe.h"))
STRUCTS = {"pdyn_options": _structs.Options, "pdyn_step_info": _structs.StepInfo,
           "pdyn_state": _structs.State, "pdyn_body_info": _structs.BodyInfo,
           "pdyn_constraint_info": _structs.ConstraintInfo,
           "pdyn_parameter_info": _structs.ParameterInfo, "pdyn_warning": _structs.WarningInfo,
           "pdyn_vector_info": _structs.VectorInfo,
           "pdyn_probe_info": _structs.ProbeInfo}
PLAIN = {"double": ctypes.c_double, "int": ctypes.c_int, "bool": ctypes.c_bool,
         "long": ctypes.c_long, "size_t": ctypes.c_size_t, "uint64_t": ctypes.c_uint64,
         "void": None, "pdyn_status": ctypes.c_int, "pdyn_load_source": ctypes.c_int}


def kind(declared):
    """A C type as a ctypes type; "pointer" for all pointers but texts."""
    declared = declared.replace("const ", "").strip()
    if re.fullmatch(r"char ?\*\w*", declared):
        return ctypes.c_char_p
    if "*" in declared or "[" in declared:
        return "pointer"
    return PLAIN[declared.split()[0]]


def ctypes_kind(given):
    return given if given in (*PLAIN.values(), ctypes.c_char_p) else "pointer"


def split(arguments):
    """Splits at the commas outside of parentheses."""
    depth, parts = 0, [""]
    for letter in arguments:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and not depth:
            parts.append("")
        else:
            parts[-1] += letter
    return [" ".join(part.split()) for part in parts if part.strip() not in ("", "...", "void")]


def members(body):
    """Name and kind of the members of a struct."""
    for declaration in filter(str.strip, body.split(";")):
        function = re.search(r"\(\*(\w+)\)", declaration)
        if function:
            yield function[1], "pointer"
            continue
        base, names = re.match(r"\s*((?:const )?\w+)(.*)", declaration, re.S).groups()
        for name in names.replace("*const *", "**").split(","):
            word = re.search(r"\w+", name)[0]
            array = re.search(r"\[(\d+)\]", name)
            yield word, kind(base) * int(array[1]) if array else kind(base + " " + name.strip())


class Declarations(unittest.TestCase):
    def test_structs(self):
        found = re.findall(r"typedef struct (pdyn_\w+) \{(.*?)\} \w+;", HEADERS, re.S)
        bodies = dict(found)
        for name, struct in STRUCTS.items():
            expected = [(member, of if isinstance(of, type) and issubclass(of, ctypes.Array)
                         else of) for member, of in members(bodies[name])]
            given = [(member, of if issubclass(of, ctypes.Array) else ctypes_kind(of))
                     for member, of in struct._fields_]
            self.assertEqual(given, expected, name)

    def test_functions(self):
        prototype = r"PDYN_API\s+([^;{(]*?)(pdyn_\w+)\(([^;]*?)\)(?:\s*PDYN_PRINTF\([^)]*\))?;"
        found = {name: (result, arguments)
                 for result, name, arguments in re.findall(prototype, HEADERS, re.S)}
        for name, (result, *arguments) in _library.FUNCTIONS.items():
            self.assertIn(name, found)
            expected = [kind(part) for part in (found[name][0], *split(found[name][1]))]
            self.assertEqual([ctypes_kind(part) for part in (result, *arguments)], expected, name)

    def test_wheel_has_all_modules(self):
        python = pathlib.Path(os.environ["PROJDYN_SOURCE_ROOT"], "python")
        listed = re.findall(r"'projdyn/([\w.]+)'", (python / "meson.build").read_text())
        files = [path.name for path in (python / "projdyn").iterdir() if path.is_file()]
        self.assertEqual(listed, sorted(files))

    def test_library_has_all(self):
        for name in _library.FUNCTIONS:
            self.assertTrue(hasattr(_library.lib, name), name)


if __name__ == "__main__":
    unittest.main()

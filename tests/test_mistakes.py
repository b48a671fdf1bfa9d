"""Mistakes that users make, and what `projdyn check` and `projdyn run` say about each. None is silent.

Usage: test_mistakes.py PROJDYN [--table]

--table prints the table instead of testing: mistake, what is said, exit codes.
"""
import copy
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

PROJDYN = os.path.abspath(sys.argv[1])
TABLE = "--table" in sys.argv

TANK = {"name": "tank", "box": {"minimum": [-0.2, 0, -0.2], "maximum": [0.2, 0.4, 0.2]}, "open": ["+y"]}
WATER = {"name": "water",
         "particles": {"radius": 0.02, "fill": [{"box": {"minimum": [-0.2, 0, -0.2], "maximum": [0.2, 0.12, 0.2]}}]},
         "constraints": [{"type": "fluid"}]}
SHEET = {"name": "sheet",
         "surface": {"grid": {"size": [0.3, 0.3], "vertices": [9, 9]}, "translate": [0, 0.3, 0], "area_density": 0.2},
         "constraints": [{"type": "spring", "stretching_stiffness": 1000},
                         {"type": "pin", "vertices": {"vertices": [0, 8, 72, 80]}}]}
SCENE = {"duration": 0.06, "frame_interval": 0.02, "time_step": {"maximum": 0.005},
         "contact": {"thickness": 0.004}, "solids": [TANK], "bodies": [WATER, SHEET]}


def change(*changes):
    """The scene with values at paths replaced; None removes."""
    scene = copy.deepcopy(SCENE)
    for path, value in changes:
        at = scene
        *keys, last = [int(k) if k.isdigit() else k for k in path.split(".")]
        for key in keys:
            at = at[key]
        if value is None:
            del at[last]
        elif isinstance(at, list) and last == len(at):
            at.append(value)
        else:
            at[last] = value
    return scene


SQUARES = """v 0 0.3 0
v 0.1 0.3 0
v 0 0.3 0.1
v 0.1 0.3 1e-10
v 0.1 0.3 0.1
v -1e-10 0.3 0.1
f 1 2 3
f 4 5 6
"""
TETRAHEDRON = """v 0 -1100 0
v 1000 -1100 0
v 0 -100 0
v 0 -1100 1000
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
"""
NEEDLES = """v 0 0.3 0
v 0.3 0.3 0
v 0.15 0.3 0.001
v 0.15 0.3 0.3
f 1 2 3
f 1 3 4
f 3 2 4
"""
SPIKE = """v -0.1 0.3 -0.1
v 0.1 0.3 -0.1
v 0.1 0.3 0.1
v -0.1 0.3 0.1
v -0.1 0.5 -0.1
v 0.1 0.5 -0.1
v 0.1 0.5 0.1
v -0.1 0.5 0.1
v 0 2 0
f 1 2 3 4
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
f 5 9 6
f 6 9 7
f 7 9 8
f 8 9 5
"""
HUGE = {"name": "scan", "mesh": "huge.obj"}
ALL = {"box": {"minimum": [-9, -9, -9], "maximum": [9, 9, 9]}}
CRATE = {"name": "crate", "rigid": {"box": {"minimum": [-0.1, 0.1, -0.1], "maximum": [0.1, 0.3, 0.1]}, "density": 500}}
MARBLE = {"name": "marble", "rigid": {"sphere": {"center": [0, 0.2, 0], "radius": 0.05}, "density": 500}}
FREE = ("bodies.1.constraints.1", None)
JET = {"disc": {"center": [0, 0.2, 0], "radius": 0.05}, "direction": [0, -1, 0], "speed": 2}
BALL = {"name": "ball", "sphere": {"center": [0, 0.06, 0], "radius": 0.05}}
WATER_ONLY = (("bodies.1", None), ("contact", None))
SHEET_ONLY = (("bodies.0", None), ("solids", None))
DUST = ("bodies.0.constraints", [])


class Mistake:
    """codes: of the exit of check and run; check, run: texts that they print, "" if nothing is to be said; memory: bytes
    that they may have."""

    def __init__(self, name, scene, check="", run=None, codes=(0, 0), options=(), run_options=(), memory=None):
        self.name, self.scene, self.codes = name, scene, codes
        self.said = (check, check if run is None else run)
        self.options, self.run_options, self.memory = list(options), list(run_options), memory


MISTAKES = [
    # legal, but surely not meant: known before the run
    Mistake("water without a fluid constraint", change(DUST), "[unconstrained]"),
    Mistake("cloth without constraints", change(("bodies.1.constraints", [])), "[unconstrained]"),
    Mistake("cloth that only bends", change(("bodies.1.constraints", [{"type": "bending", "bending_rigidity": 1e-4}])),
            'only "bending" holds its vertices together'),
    Mistake("springs on cells that are not square", change(("bodies.1.surface.grid", {"size": [0.3, 0.6], "vertices": [9, 9]}), *SHEET_ONLY),
            'sheet: the cells of its grid are 0.0375 m x 0.075 m: "spring" has 0.33 times the stiffness that is given along the first side, and 2 times along the second [oblong]'),
    Mistake("places in the path of a pin", change(("bodies.1.constraints.2", {"type": "pin", "vertices": {"border": True}, "path": [[0, 1, 2, 3]]}), ("duration", 0.02),
                                                ("solver", {"outer_iterations": 5}), ("contact", None)),
            'sheet: the path of "pin" starts with (1, 2, 3) m', codes=(0, 0)),
    Mistake("rest density in g/cm^3", change(("bodies.0.particles.rest_density", 1)), "[density]"),
    Mistake("area density in g/m^2", change(("bodies.1.surface.area_density", 200)), "[density]"),
    Mistake("gravity with a wrong sign", change(("gravity", [0, 9.81, 0]), *WATER_ONLY), "tank: gravity of (0, 9.81, 0) m/s^2 points out of its open side +y"),
    Mistake("a tank with y up where z is up", change(("gravity", [0, 0, -9.81]), *WATER_ONLY),
            "tank: with gravity of (0, 0, -9.81) m/s^2 its open side +y is a side wall, and its top +z is closed"),
    Mistake("a tank with z up where y is up", change(("solids.0.open", ["+z"]), *WATER_ONLY), "expected an open side +y, or gravity along -z [unusual]"),
    Mistake("gravity in millimetres", change(("gravity", [0, -9810, 0]), ("duration", 0.02), *WATER_ONLY), '"gravity" of 9810 m/s^2 is unusual, expected 0 to 100 m/s^2'),
    Mistake("friction in percent", change(("contact.friction", 30)), 'contact: "friction" of 30 is unusual, expected 0 to 10'),
    Mistake("permeability of a porous rock, in m^2", change(("bodies.1.surface.permeability", 1e-12), ("duration", 0.02)),
            'sheet: "permeability" of 1e-12 m/(Pa s) is unusual, expected 1e-09 to 1e+06 m/(Pa s)'),
    Mistake("surface tension in mN/m", change(("bodies.0.constraints.1", {"type": "surface_tension", "tension": 72}), ("duration", 0.02), *WATER_ONLY),
            'water: "tension" of 72 N/m is unusual', codes=(0, 0)),
    Mistake("a fluid too soft for its drops", change(("bodies.0.constraints.0", {"type": "fluid", "sound_speed": 0.2}),
                                                     ("bodies.0.constraints.1", {"type": "surface_tension", "tension": 0.072}), ("duration", 0.02), *WATER_ONLY),
            "water: a sound speed of 0.2 m/s is low for a surface tension of 0.072 N/m, expected 0.42 m/s or more", codes=(0, 0)),
    Mistake("steps too long for a surface tension", change(
        ("bodies.0.particles.radius", 0.01), ("bodies.0.constraints.1", {"type": "surface_tension", "tension": 1}),
        ("time_step.maximum", 0.2), ("frame_interval", 0.2), ("duration", 0.02), *WATER_ONLY),
            "water: steps of up to 0.2 s are long for a surface tension of 1 N/m and particles 0.02 m apart, expected 0.089 s or less", "[unusual]"),
    Mistake("viscosity of pitch", change(("bodies.0.constraints.1", {"type": "viscosity", "viscosity": 1e8}), *WATER_ONLY), 'water: "viscosity" of 1e+08 Pa s is unusual'),
    Mistake("air pressure in bar", change(("solids", []), ("bodies.0", None), ("bodies.0", {
        "name": "bag", "surface": {"mesh": "huge.obj", "scale": 1e-4, "area_density": 0.2}, "constraints": [
            {"type": "spring", "stretching_stiffness": 1000}, {"type": "gas", "outside": 1}]})), 'bag: "outside" of 1 Pa is unusual, expected 1000 to 1e+09 Pa'),
    Mistake("a block softer than its weight", change(("bodies.0", None), ("bodies.0", {
        "name": "soft", "volume": {"grid": {"size": [0.2, 0.2, 0.2], "cells": [2, 2, 2]}, "translate": [0, 0.11, 0], "density": 900},
        "constraints": [{"type": "tet", "stiffness": 200}]})), "soft: a stiffness of 200 Pa is less than the pressure of its own weight"),
    Mistake("a soft body with a skin alone", change(("bodies.0", None), ("bodies.0", {
        "name": "soft", "volume": {"grid": {"size": [0.3, 0.3, 0.3], "cells": [4, 4, 4]}, "translate": [0, 0.2, 0], "density": 500},
        "constraints": [{"type": "triangle", "stretching_stiffness": 5000}, {"type": "bending", "bending_rigidity": 0.1}]})),
            'soft: no constraint acts on 27 of its 125 vertices; the inside of a soft body needs {"type": "tet"} [unconstrained]'),
    Mistake("cloth in millimetres", change(("bodies.1.surface.grid.size", [1000, 1000]), ("solids", []), ("bodies.0", None)),
            "[scale]"),
    Mistake("a needle in a mesh of cloth", change(("bodies.0", None), ("bodies.0.surface", {"mesh": "needles.obj", "area_density": 0.2}),
                                                  ("bodies.0.constraints.1", None), ("contact", None)), "1 of its triangles is a hundred"),
    Mistake("cells larger than the mesh is thick", change(("bodies.0", None), ("bodies.0", {
        "name": "soft", "volume": {"mesh": "huge.obj", "scale": 1e-4, "cell": 0.03, "density": 900},
        "constraints": [{"type": "tet", "stiffness": 2e4}]})), "[coarse]"),
    Mistake("a tip thinner than the cells", change(("bodies.0", None), ("bodies.0", {
        "name": "soft", "volume": {"mesh": "spike.obj", "cell": 0.08, "density": 900},
        "constraints": [{"type": "tet", "stiffness": 2e4}]})),
            "soft: 1 of the 9 vertices of its mesh is more than a cell away"),
    Mistake("a rigid body thinner than its cells", change(("bodies.0", None), ("bodies.0", {
        "name": "hard", "rigid": {"mesh": "huge.obj", "scale": 1e-4, "cell": 0.03, "density": 900}})),
            "hard: its cells fill", "[coarse]"),
    Mistake("a volume of triangles without \"cell\"", change(("bodies.0", None), ("bodies.0", {
        "volume": {"mesh": "huge.obj", "density": 900}})), '"cell" fills', codes=(2, 2)),
    Mistake("cloth in centimetres", change(("bodies.1.surface.grid.size", [30, 30]), FREE, ("contact", None), ("bodies.0", None)),
            "times as long as all solids; lengths are in metres"),
    Mistake("water in millimetres", change(("bodies.1", None), ("contact", None), ("bodies.0.particles", {"radius": 20, "fill": [
        {"box": {"minimum": [-200, 0, -200], "maximum": [200, 120, 200]}}]})), "times the length of all solids; lengths are in metres [scale]"),
    Mistake("places of a map", change(("solids.0.box", {"minimum": [49999.8, 0, -0.2], "maximum": [50000.2, 0.4, 0.2]}),
                                      ("bodies.0.particles.fill.0.box", {"minimum": [49999.8, 0, -0.2], "maximum": [50000.2, 0.12, 0.2]}), *WATER_ONLY),
            "water: frames have coordinates to 0.003 m at 50000.2 m from the origin, its particles are 0.04 m apart: move the scene to the origin [scale]"),
    Mistake("particles that do not fit the edges of their box", change(("bodies.0.particles.radius", 0.0167), *WATER_ONLY),
            "fill 70.4 % of a box of 0.4 x 0.12 x 0.4 m; particles of radius 0.02 m fill 100 %"),
    Mistake("particles too large for a ball", change(("bodies.0.particles.fill.0", {"sphere": {"center": [0, 0.06, 0], "radius": 0.06}}), *WATER_ONLY),
            "water: particles of radius 0.02 m fill 50 % of the volume of fill[0] [coarse]"),
    Mistake("a turn as fast as the steps", change(("bodies.0", {**CRATE, "constraints": [
        {"type": "pin", "vertices": {"all": True}, "turn": [[0, 0, 0, 0], [0.03, 0, 1200, 0]]}]}), ("bodies.1", None), ("contact", None)),
            'crate: the turn of "pin" goes on by up to 200 degrees in a step of 0.005 s', "[unusual]"),
    Mistake("a jet as thin as a particle", change(("bodies.0.particles", {"radius": 0.02, "inlets": [
        {**JET, "disc": {"center": [0, 0.2, 0], "radius": 0.04}}]}), *WATER_ONLY),
            "a layer of 5 particles of radius 0.02 m has 159 % of the area of its inlet, 0.005027 m^2, and so has the flow; 0.628 times the speed"),
    Mistake("two inlets alike, as thin as a particle", change(("bodies.0.particles", {"radius": 0.02, "inlets": [
        {**JET, "disc": {"center": [x, 0.2, 0], "radius": 0.04}} for x in (-0.1, 0.1)]}), *WATER_ONLY),
            "in each of 2 inlets a layer of 5 particles of radius 0.02 m has 159 %"),
    Mistake("a solid mesh in millimetres", change(("solids.0", HUGE), ("bodies.0", None)), "scan: it is 1e+03 m long"),
    Mistake("a solid mesh in centimetres", change(*SHEET_ONLY, ("solids", [{**HUGE, "scale": 0.1}])),
            "times as long as all bodies and other solids; lengths are in metres"),
    Mistake("a rigid mesh in centimetres, no solids", change(("bodies.0", {
        "name": "scan", "rigid": {"mesh": "huge.obj", "scale": 0.1, "translate": [0, 111, 0], "density": 500}}), ("solids", [])),
            "scan: it is 100 m long, 3.3e+02 times as long as all other bodies; lengths are in metres"),
    Mistake("an angle in radians", change(("solids.1", {**BALL, "motion": [{"time": 0, "rotate": [0, 0, 1.5708]}]}), *WATER_ONLY),
            "solids[1].motion[0].rotate: 1.5708 degrees is the angle of 90 degrees in radians; the unit is degrees"),
    Mistake("a contact angle in radians", change(("bodies.0.constraints.1", {"type": "surface_tension", "tension": 0.07, "contact_angle": 1.5708}),
                                                 *WATER_ONLY), "contact_angle: 1.5708 degrees is the angle of 90 degrees in radians"),
    Mistake("turns of pins in radians", change(("bodies.1.constraints.1.turn", [[0, 0, 0, 0], [0.05, 0, 0.785, 0]]), *SHEET_ONLY),
            "bodies[0].constraints[1].turn[1]: 0.785 degrees is the angle of 45 degrees in radians; the unit is degrees"),
    Mistake("a rigid ball in very thick contact", change(("bodies.0", MARBLE), ("bodies.1", None), ("contact.thickness", 0.04)),
            "times its mean edge length: contact of so fine a mesh takes long [contact-thickness]"),
    Mistake("contact thickness above the edge length", change(("contact.thickness", 0.1)),
            "between many neighbours, steps take long, and the surface cannot fold [contact-thickness]"),
    Mistake("a step that counts as solved too early", change(FREE, ("solver", {"tolerance": 2})), "[tolerance]"),
    Mistake("free cloth that is too light for the water", change(FREE, ("bodies.1.surface.area_density", 0.05)), "[too-light]"),
    Mistake("a rigid plate that hardly exceeds its water", change(("bodies.1", None), ("bodies.1", {
        "name": "plate", "rigid": {"box": {"minimum": [-0.1, 0.2, -0.1], "maximum": [0.1, 0.21, 0.1]}, "density": 1500}})),
            'it is 0.6 kg/m^2 heavier than the "water" that it displaces, at most half a layer of particles (20 kg/m^2)', "[too-light]"),
    Mistake("a rigid plate that floats by its contact thickness", change(("contact.thickness", 0.02), ("bodies.1", None), ("bodies.1", {
        "name": "plate", "rigid": {"box": {"minimum": [-0.1, 0.2, -0.1], "maximum": [0.1, 0.21, 0.1]}, "density": 1500}})),
            'with the contact thickness of 0.02 m it displaces 17 kg/m^2 more of the "water" than it weighs: it floats; a smaller `thickness` [too-light]'),
    Mistake("a rigid plate that exceeds its oil by half a layer", change(
        ("contact", None), ("bodies.0", {**WATER, "name": "oil", "particles": {**WATER["particles"], "rest_density": 800}}), ("bodies.1", {
        "name": "plate", "rigid": {"box": {"minimum": [-0.1, 0.2, -0.1], "maximum": [0.1, 0.22, 0.1]}, "density": 1600}})),
            'it is 16 kg/m^2 heavier than the "oil" that it displaces, at most half a layer of particles (16 kg/m^2)', "[too-light]"),
    Mistake("a towel that its pins dip into water", change(
        ("bodies.1.constraints.1", {"type": "pin", "vertices": ALL, "path": [[0, 0, 0, 0], [0.05, 0, -0.2, 0]]})), "[too-light]"),
    Mistake("water that fits a sheet exactly", change(("bodies.1.surface.translate", [0, 0.12, 0]), ("contact.thickness", 0.015)),
            '64 of 96 particles beside "sheet" start closer to it than they rest',
            "leave 0.0075 m between the surface and the volumes of `fill` [too-close]"),
    Mistake("times in frames", change(("solids.1", {**BALL, "motion": [{"time": 24}, {"time": 48, "translate": [0, 1, 0]}]}), *WATER_ONLY),
            "its motion begins at 24 s, but the scene ends at 0.06 s [never]"),
    Mistake("an outlet that was to be outside", change(("outlets", [ALL]), *WATER_ONLY), "[outlet]"),
    Mistake("an inlet that lies in a cloth", change(("bodies.0.particles", {"radius": 0.02, "inlets": [
        {**JET, "disc": {"center": [0, 0.24, 0], "radius": 0.05}}]}), ("bodies.1.surface.translate", [0, 0.25, 0])),
            'water: inlet 0 moves its layers through "sheet", near', "of it [blocked]"),
    Mistake("an inlet that points out of its tank", change(("bodies.0.particles", {"radius": 0.02, "inlets": [
        {**JET, "disc": {"center": [0.2, 0.2, 0], "radius": 0.05}, "direction": [1, 0, 0]}]}), *WATER_ONLY),
            'solid "tank" covers 5 particles of a layer, the first at (0.22, 0.16, 0) m, and none is left to flow in', codes=(2, 2)),
    Mistake("an inlet that reaches into the floor", change(("bodies.0.particles", {"radius": 0.02, "inlets": [
        {**JET, "disc": {"center": [-0.2, 0.02, 0], "radius": 0.08}, "direction": [1, 0, 0]}]}), *WATER_ONLY),
            'of a layer of inlet 0, the first at', '[blocked]'),
    Mistake("an inlet in a ball", change(("bodies.0.particles", {"radius": 0.02, "inlets": [JET]}), ("solids.1", {
        "name": "ball", "sphere": {"center": [0, 0.1, 0], "radius": 0.08}}), *WATER_ONLY), 'solid "ball" covers', codes=(2, 2)),
    Mistake("a crate closer to the floor than the contact thickness", change(("bodies.0", None), ("bodies.0", {
        "name": "crate", "rigid": {"box": {"minimum": [-0.1, 0.001, -0.1], "maximum": [0.1, 0.201, 0.1]}, "density": 500}})),
            'it starts 0.001 m from "tank"', "leave a gap of its `thickness`, 0.004 m, or take a smaller one [too-close]"),
    Mistake("an inlet in a rigid ball", change(("bodies.0.particles", {"radius": 0.02, "inlets": [JET]}), ("bodies.1", {
        "name": "ball", "rigid": {"sphere": {"center": [0, 0.2, 0], "radius": 0.12}, "density": 500}})),
            'water: inlet 0 is inside of the rigid body "ball", near', "outside of it [blocked]"),
    Mistake("a rigid ball inside a solid one", change(("bodies.0", None), ("bodies.0", {**MARBLE}), ("solids.1", {
        "name": "jail", "sphere": {"center": [0, 0.2, 0], "radius": 0.1}})), '"jail" [overlap]'),
    Mistake("cloth far coarser than the water",
            change(("bodies.1.surface.grid", {"size": [0.7, 0.7], "vertices": [2, 2]}), ("solids", []),
                   ("bodies.1.constraints.1.vertices", ALL)), "[edge-length]"),
    Mistake("fixed step longer than a frame", change(("time_step", {"fixed": 0.05})), "[frames]"),
    Mistake("fixed step that does not divide a frame", change(("time_step", {"fixed": 0.02}), ("frame_interval", 0.03)),
            'steps that end at frames, every 0.03 s, have 0.015 s, not the fixed 0.02 s; with the "frame_interval" 0.04 they fit [frames]'),
    Mistake("duration shorter than a frame", change(("duration", 0.01)), "[frames]"),
    Mistake("frames per second as frame_interval", change(("frame_interval", 25)), "shorter than the frame interval, the 25 s between two frames"),
    Mistake("a crate that stands on the floor without a gap", change(("bodies", [{"name": "crate", "rigid": {
        "box": {"minimum": [-0.1, 0, -0.1], "maximum": [0.1, 0.2, 0.1]}, "density": 500}}])), "leave a gap between them", codes=(2, 2)),
    Mistake("a rigid mesh with a hole", change(("bodies.1", None), ("bodies.1", {"name": "scan", "rigid": {"mesh": "squares.obj", "density": 500}})),
            "has 1 triangle, expected 2: a hole, or vertices that are not joined", codes=(2, 2)),
    Mistake("free cloth above a solid, no contact", change(FREE, ("contact", None)), "[no-contact]"),
    Mistake("mesh with split vertices", change(("bodies.1.surface", {"mesh": "squares.obj", "area_density": 0.2}),
                                               ("bodies.1.constraints.1.vertices", {"vertices": [0, 4]})), "[seams]"),
    Mistake("Cholesky for a matrix that changes", change(("solver", {"type": "cholesky"}), ("bodies.0", None)), "[factor]"),
    Mistake("water fills a place twice", change(("bodies.0.particles.fill.1", WATER["particles"]["fill"][0])), "[coincident]",
            codes=(0, 1)),
    Mistake("oil inside water", change(*WATER_ONLY, ("bodies.1", {**WATER, "name": "oil", "particles": {**WATER["particles"], "rest_density": 900,
        "fill": [{"sphere": {"center": [0, 0.06, 0], "radius": 0.05}}]}})), 'fill[0] and fill[0] of "water" overlap: 1 particle is closer'),
    Mistake("a third of the water inside a solid",
            change(("solids.1", {"name": "block", "capsule": {"from": [0, 0, 0], "to": [0, 0.1, 0], "radius": 0.19}}),
                   *WATER_ONLY), "[overlap]"),
    Mistake("springs on a rigid body", change(("bodies.0", {**CRATE, "constraints": [
        {"type": "spring", "stretching_stiffness": 100}]}), ("bodies.1", None)), "[no-effect]"),
    Mistake("a pin of no stiffness", change(("bodies.1.constraints.1.stiffness", 0)), 'sheet: "pin" has no effect: its stiffness is 0 [no-effect]'),
    Mistake("springs of no stiffness", change(("bodies.1.constraints.0.stretching_stiffness", 0)), '"spring" has no effect: its stiffness is 0'),
    Mistake("a membrane of no stiffness", change(("bodies.1.constraints.0", {"type": "triangle", "stretching_stiffness": 0})),
            '"triangle" has no effect: its stiffness is 0'),
    Mistake("tetrahedra of no stiffness", change(("bodies.1", {**CRATE, "rigid": None, "volume": {
        "grid": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}, "density": 500, "translate": [0, 0.3, 0]},
        "constraints": [{"type": "tet", "stiffness": 0}]}), ("bodies.1.rigid", None)), '"tet" has no effect: its stiffness is 0'),
    Mistake("contact of water alone", change(*WATER_ONLY, ("contact", {"thickness": 0.01})), "contact: it has no effect", "[no-effect]"),
    Mistake("a rigid ball inside a rigid box", change(("bodies.0", CRATE), ("bodies.1", MARBLE)),
            '"crate" [overlap]'),
    Mistake("a floor far larger than its water", change(*WATER_ONLY, ("solids.0", {
        "name": "floor", "plane": {"center": [0, 0, 0], "normal": [0, 1, 0], "size": 12}})), "floor: its surface has 763876 boundary points, which take about 0.22 GB"),
    Mistake("a floor of a square kilometre", change(*WATER_ONLY, ("solids.0", {
        "name": "floor", "plane": {"center": [0, 0, 0], "normal": [0, 1, 0], "size": 1000}})), 'a side of "floor" has 1e+06 m^2, too many for points', codes=(2, 2)),
    Mistake("a rigid mesh in millimetres", change(("bodies.0", None), ("bodies.0", {"name": "scan", "rigid": {"mesh": "huge.obj", "translate": [0, 1100, 0], "density": 500}})),
            "m; the meshes are 1e+03 m and 0.4 m long", codes=(2, 2)),
    Mistake("a probe in millimetres", change(("probes", [{"name": "gauge", "point": [100, 50, 0]}])), "[probe]"),
    # found in steps
    Mistake("too few iterations", change(("solver", {"outer_iterations": 1, "linear_iterations": 2})), "[unsolved]"),
    Mistake("cloth far too stiff for two iterations", change(("bodies.0", None), ("bodies.0.constraints.0.stretching_stiffness", 1e9),
                                                             ("solver", {"outer_iterations": 2}), ("duration", 0.3)), "", "[slowed]"),
    Mistake("nothing holds the cloth", change(("solids", []), ("bodies.0", None), ("bodies.0.constraints.1", None),
                                              ("contact", None), ("duration", 0.6)), "",
            "a floor below all of their way, or a shorter duration, ends this warning [fell-out]"),
    Mistake("dust falls through cloth", change(DUST, ("contact", None), ("bodies.0.particles.fill.0.box", {
        "minimum": [-0.1, 0.31, -0.1], "maximum": [0.1, 0.38, 0.1]}), ("duration", 0.2)), "[unconstrained]", 'particles of "water" passed through this body'),
    Mistake("dust falls through the floor", change(DUST, *WATER_ONLY, ("duration", 0.3)), "[unconstrained]",
            'particles of "water" passed through this solid'),
    Mistake("cloth falls through the floor", change(FREE, ("contact", None), ("bodies.0", None),
                                                    ("duration", 0.5)), "[no-contact]", "[leak]"),
    Mistake("inlet without budget left", change(("bodies.0.particles", {"radius": 0.02, "budget": 5, "inlets": [JET]}),
                                                *WATER_ONLY), "[budget]"),
    Mistake("shortest step too long for a jet", change(("bodies.0.velocity", [0, -60, 0]), *WATER_ONLY,
                                                       ("time_step", {"maximum": 0.005, "minimum": 0.005})), "[short-step]"),
    Mistake("water compressed at the start", change(*WATER_ONLY, ("bodies.0.constraints.0.stiffness", 1),
                                                    ("bodies.0.velocity", [0, -5, 0])), "[compressed]"),
    Mistake("a solid that presses water against the floor", change(*WATER_ONLY, ("duration", 0.12), ("solids.1", {
        "name": "press", "box": {"minimum": [-0.12, 0.05, -0.12], "maximum": [0.12, 0.09, 0.12]},
        "motion": [{"time": 0}, {"time": 0.05, "translate": [0, -0.028, 0]}]})), "", "[squeezed]"),
    Mistake("more water than memory", change(*WATER_ONLY, ("bodies.0.particles.radius", 0.0025)),
            "153600 particles take about 0.35 GB, and there are 0.34 GB", codes=(1, 1), memory=340_000_000),
    Mistake("more water of a wide kernel than memory", change(*WATER_ONLY, ("kernel", "wendland"), ("bodies.0.particles.radius", 0.0025)),
            "153600 particles take about 0.49 GB, and there are 0.4 GB", codes=(1, 1), memory=400_000_000),
    Mistake("a capsule far too long for the particles", change(*WATER_ONLY, ("solids.1", {
        "name": "pole", "capsule": {"from": [1, 0, 0], "to": [1, 0, 500000], "radius": 0.02}})),
            'the surface of "pole" is 5e+05 m long and has', codes=(2, 2)),
    Mistake("more pairs of contact than memory", change(("bodies.0", {
        "name": "jelly", "volume": {"grid": {"size": [0.1, 0.1, 0.1], "cells": [12, 12, 12]}, "translate": [0, 0.1, 0], "density": 1000},
        "constraints": [{"type": "tet", "stiffness": 1e4}]}), ("contact.thickness", 0.04)),
            'most of them of "jelly", can come closer than the thickness of 0.04 m; there is no room for more than these', "[contact-thickness]", codes=(2, 2), memory=340_000_000),
    # energy from nothing
    Mistake("two blocks of water overlap",
            change(*WATER_ONLY, ("bodies.0.particles.fill.1", {"box": {
                "minimum": [-0.19, 0.01, -0.19], "maximum": [0.21, 0.13, 0.21]}})),
            "water: fill[1] and fill[0] overlap: ", "J; particles overlap at the start, or are too close to each other; the fluid has been compressed by more than 10 %; the state", codes=(1, 1)),
    # refused
    Mistake("water kept inside a solid", change(("solids.1", BALL), ("bodies.0.particles.overlap", "keep")),
            'overlap solid "ball", the first at', codes=(2, 2)),
    Mistake("water kept in a wall", change(("bodies.0.particles.overlap", "keep"), ("bodies.0.particles.fill.0.box.minimum",
                                                                                  [-0.3, 0, -0.2])),
            'overlap solid "tank"', codes=(2, 2)),
    Mistake("water in a mesh in millimetres", change(("bodies.0.particles.fill.0", {"mesh": "huge.obj"})),
            '"scale" changes the unit of a mesh', codes=(2, 2)),
    Mistake("unknown key", change(("gravitiy", [0, 0, 0])), 'did you mean "gravity"', codes=(2, 2)),
    Mistake("frames per second", change(("fps", 24)), 'unknown key "fps"; did you mean "frame_interval"?', codes=(2, 2)),
    Mistake("a step called dt", change(("time_step.dt", 0.01)), 'unknown key "dt"; did you mean "fixed"?', codes=(2, 2)),
    Mistake("a velocity in the shape", change(("bodies.1", {**CRATE, "rigid": {**CRATE["rigid"], "velocity": [1, 0, 0]}})),
            'bodies[1].rigid: unknown key "velocity"; it is a key of the body, beside "rigid"', codes=(2, 2)),
    Mistake("a density beside the shape", change(("bodies.1", {**CRATE, "density": 500})),
            'bodies[1]: unknown key "density"; did you mean "rigid.density"?', codes=(2, 2)),
    Mistake("a rest density in the constraint", change(("bodies.0.constraints.0.rest_density", 900)),
            'unknown key "rest_density"; did you mean "particles.rest_density" of the body?', codes=(2, 2)),
    Mistake("a rest density of a rigid body", change(("bodies.1", {**CRATE, "rigid": {**CRATE["rigid"], "rest_density": 900}})),
            'unknown key "rest_density"; did you mean "density"?', codes=(2, 2)),
    Mistake("a type as the name of its parameter", change(("bodies.0.constraints.1", {"type": "surface_tension", "surface_tension": 0.07})),
            'unknown key "surface_tension"; did you mean "tension"?', codes=(2, 2)),
    Mistake("outlets of a body", change(("bodies.0.particles.outlets", [])), 'did you mean "outlets" of the scene?', codes=(2, 2)),
    Mistake("a longer name than the key has", change(("contact.static_friction", 0.5)), 'did you mean "friction"?', codes=(2, 2)),
    Mistake("friction of a body", change(("bodies.1", {**CRATE, "rigid": {**CRATE["rigid"], "friction": 0.5}})),
            'unknown key "friction"; did you mean "contact.friction" of the scene?', codes=(2, 2)),
    Mistake("unknown constraint", change(("bodies.0.constraints.0.type", "fluit")), 'did you mean "fluid"', "those of a plug-in need --plugin FILE.so", codes=(2, 2)),
    Mistake("a constraint called joint", change(("bodies.1.constraints.0.type", "joint")), 'did you mean "attachment"?', codes=(2, 2)),
    Mistake("stiffness of bending", change(("bodies.1.constraints.0", {"type": "bending", "stiffness": 0.1})),
            'unknown key "stiffness"; did you mean "bending_rigidity"?', codes=(2, 2)),
    Mistake("adhesion of a fluid", change(("bodies.0.constraints.1", {"type": "surface_tension", "tension": 0.07, "adhesion": 1})),
            'unknown key "adhesion"; did you mean "contact_angle"?', codes=(2, 2)),
    Mistake("unknown solver", change(("solver", {"type": "cgg"})), 'did you mean "cg"', codes=(2, 2)),
    Mistake("pressures without a fluid", change(("solver", {"type": "dual"}), ("bodies.0", None)),
            'does not fit this scene: it has no fluid, whose pressures would be the unknowns; expected another one, or "auto"', codes=(2, 2)),
    Mistake("a factor with a rigid body", change(("solver", {"type": "cholesky"}), ("bodies.0", CRATE), ("bodies.1", None)),
            "does not fit this scene: it has rigid bodies", codes=(2, 2)),
    Mistake("tetrahedra in a rigid body", change(("bodies.0", {**CRATE, "constraints": [{"type": "tet", "stiffness": 10}]})),
            '"tet" works on a volume, found a rigid body', codes=(2, 2)),
    Mistake("negative stiffness", change(("bodies.1.constraints.0.stretching_stiffness", -1)), "expected", codes=(2, 2)),
    Mistake("gravity as a number", change(("gravity", -9.81)), "expected", codes=(2, 2)),
    Mistake("stiffness over time as rows", change(("bodies.1.constraints.0.stretching_stiffness", [[0, 500], [1, 800]])),
            'stretching_stiffness: expected values over time as [{"time": 0, "stretching_stiffness": ...}, ...], found arrays of 2', codes=(2, 2)),
    Mistake("gravity over time as rows", change(("gravity", [[0, 0, -9.81, 0], [1, 0, 0, 0]])),
            'gravity: expected values over time as [{"time": 0, "gravity": ...}, ...]', codes=(2, 2)),
    Mistake("minimum above maximum", change(("time_step", {"minimum": 0.1, "maximum": 0.01})), "expected", codes=(2, 2)),
    Mistake("missing mesh file", change(("bodies.1.surface", {"mesh": "no.obj", "area_density": 0.2})), "no.obj", codes=(2, 2)),
    Mistake("pin that holds nothing", change(("bodies.1.constraints.1.vertices", {"box": {
        "minimum": [5, 5, 5], "maximum": [6, 6, 6]}})), "selects none", codes=(2, 2)),
    Mistake("vertex that does not exist", change(("bodies.1.constraints.1.vertices.vertices", [81])), "81", codes=(2, 2)),
    Mistake("two bodies of one name", change(("bodies.1.name", "water")), '"water"', codes=(2, 2)),
    Mistake("constraint on a wrong body", change(("bodies.0.constraints.1", {"type": "spring", "stretching_stiffness": 10})),
            "spring", codes=(2, 2)),
    Mistake("plug-in without permission", change(("plugins", ["mine.so"])), "--allow-plugins", codes=(2, 2)),
    Mistake("no valid JSON", '{"bodies": [', "scene.json:1", codes=(2, 2)),
    Mistake("override of nothing", SCENE, "bodies.pond", codes=(2, 2), options=["--set", "bodies.pond.name=x"]),
    Mistake("override of a constraint that the body lacks", SCENE, 'known: 0 (spring), 1 (pin); to add one, set the whole array', codes=(2, 2),
            options=["--set", "bodies.sheet.constraints.bending.bending_rigidity=1"]),
    Mistake("thread count of zero", SCENE, "--threads", codes=(2, 2), options=["--threads", "0"]),
    Mistake("output is a file", SCENE, "", "squares.obj", codes=(0, 2), run_options=["-o", "squares.obj"]),
    Mistake("warnings with --strict", change(DUST), "--strict: there are warnings", codes=(1, 1), options=["--strict"]),
]


def limit_memory(size):
    if size:
        resource.setrlimit(resource.RLIMIT_AS, (size, size))


def said_by(command, mistake, folder):
    more = ["--threads", "1", *mistake.run_options] if command == "run" else []
    if command == "run" and "-o" not in more:
        more = more + ["-o", "out", "--no-frames"]
    done = subprocess.run([PROJDYN, command, "scene.json", *more, *mistake.options], cwd=folder, capture_output=True,
                          text=True, timeout=120, preexec_fn=lambda: limit_memory(mistake.memory))
    return done.returncode, done.stdout + done.stderr


def summary(text, output):
    """The line that contains the text, without the name of the program and the totals at the end."""
    lines = [line for line in output.splitlines() if text and text in line]
    return lines[0].replace("projdyn: ", "") if lines else ""


def test(mistake, folder):
    scene = mistake.scene if isinstance(mistake.scene, str) else json.dumps(mistake.scene)
    (folder / "scene.json").write_text(scene)
    (folder / "squares.obj").write_text(SQUARES)
    (folder / "huge.obj").write_text(TETRAHEDRON)
    (folder / "needles.obj").write_text(NEEDLES)
    (folder / "spike.obj").write_text(SPIKE)
    good = True
    for command, code, text in zip(("check", "run"), mistake.codes, mistake.said):
        got, output = said_by(command, mistake, folder)
        if TABLE:
            print(f"| {mistake.name} | {command} | {got} | {summary(text, output)} |")
        elif got != code or text not in output:
            good = False
            print(f"not ok {mistake.name}: {command}: exit {got} (expected {code}), expected to read '{text}' in:")
            print("    " + output.replace("\n", "\n    "))
    return good


def is_silent(mistake):
    return not any(mistake.said)


with tempfile.TemporaryDirectory() as name:
    assert not any(is_silent(mistake) for mistake in MISTAKES)
    failed = [mistake.name for mistake in MISTAKES if not test(mistake, pathlib.Path(name))]
print(f"{len(MISTAKES) - len(failed)} of {len(MISTAKES)} mistakes are told")
sys.exit(1 if failed else 0)

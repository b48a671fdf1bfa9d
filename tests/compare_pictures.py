"""Compares the pictures that test_replay.sh draws. Usage: compare_pictures.py FOLDER

Each part of the scene must change many pixels; the surface of the water must cover what its particles cover."""
import pathlib
import sys

from read_png import read_png


def changed(a, b, least=9):
    """The pixels that differ, as a set of indices."""
    return {i for i, (p, q) in enumerate(zip(a, b)) if max(abs(u - v) for u, v in zip(p, q)) >= least}


pictures = {path.stem: read_png(path) for path in pathlib.Path(sys.argv[1]).glob("*.png")}
faults = 0


def expect(what, count, least, most=10**9):
    global faults
    good = least <= count <= most
    faults += not good
    print(f"{'ok' if good else 'FAILED'}: {what}: {count} pixels, expected {least} to {most}")


every = pictures["all"]
water = changed(every, pictures["hide=water"])
blue = sum(every[i][2] > every[i][0] + 25 for i in water)
expect("water is blue", blue, 2000)
if "colors" in pictures:
    coloured = pictures["colors"]
    expect("water is green", sum(coloured[i][1] > max(coloured[i][0], coloured[i][2]) + 25 for i in water), 2000)
    expect("the rod is red", sum(p[0] > 2 * max(p[1:]) and q[0] <= 2 * max(q[1:]) for p, q in zip(coloured, every)), 100)
    covered = changed(pictures["cut=y+1"], pictures["hide=water"])
    expect("the water is a mesh", len(changed(every, pictures["cut=y+1"])), 1000)
    expect("water in one of both pictures only, mesh or particles", len(covered ^ water), 0, len(water) // 10)
    sys.exit(faults > 0)
for name, least in [("hide=water", 3000), ("hide=sheet", 6000), ("hide=tank", 800), ("hide=ball", 500), ("hide=rod", 200),
                    ("look=particles", 2000), ("no_report", 800), ("surface=checker", 2000), ("surface=stretch", 4000),
                    ("fluid=speed", 2000), ("fluid=pressure", 2000), ("cut=x-0.5", 2000), ("camera=90,20,1,0,0.4,0", 9000),
                    ("camera=90,20,1", 9000)]:
    expect(f"{name} against all", len(changed(every, pictures[name])), least)


def legend(name, k, left, right):
    """Legend k of a picture of 480 x 300 pixels: dark text of 9 pixels above and below a strip whose ends have these
    colours."""
    picture, top = pictures[name], 9 + 45 * k
    row = lambda y, low, high: [picture[480 * y + x] for x in range(low, high)]
    for what, first in (("title", top + 4), ("values", top + 27)):
        dark = sum(max(p) < 150 for y in range(first, first + 11) for p in row(y, 350, 474))
        expect(f"{name}: {what} of the legend", dark, 25)
    strip = row(top + 21, 330, 474)
    for what, ends, colour in (("left", strip[:70], left), ("right", strip[-20:], right)):
        close = sum(max(abs(u - v) for u, v in zip(p, colour)) < 12 for p in ends)
        expect(f"{name}: {what} end of the legend", close, 2)


legend("fluid=speed", 0, (60, 81, 141), (222, 245, 229))
legend("fluid=speed&surface=stretch", 0, (60, 81, 141), (222, 245, 229))
legend("fluid=speed&surface=stretch", 1, (0, 18, 97), (89, 0, 7))
corner = {480 * y + x for y in range(9, 50) for x in range(360, 470)}
for name in ("surface=checker", "look=particles", "hide=water&fluid=speed"):
    expect(f"{name}: no legend", len(corner & changed(pictures["hide=water"], pictures[name])), 0, 20)
balls = changed(pictures["look=particles"], pictures["hide=water"])
expect("particles", len(balls), 2000)
greenish = sum(pictures["look=particles"][i][1] > pictures["look=particles"][i][2] for i in balls)
expect("particles in another colour than that of plain water, as that of their speed", greenish, 0, len(balls) // 5)
expect("holes: particles without a surface", len(balls - water), 0, len(balls) // 100)
sys.exit(faults > 0)

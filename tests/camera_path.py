"""Checks the camera over time of a replay page. Usage: camera_path.py PAGE"""
import json
import math
import pathlib
import sys
import tempfile

import devtools

KEYS = [{"time": 1, "yaw": 0, "target": [0, 0, 1]}, {"time": 2, "yaw": 90, "pitch": 10}, {"time": 4, "yaw": 100},
        {"time": 5, "yaw": 100, "target": [4, 0, 3]}, {"time": 6, "yaw": 40}]


def camera_at(browser, keys, time):
    """Yaw, pitch, scale and target of the first view with keys, at a time."""
    return json.loads(browser.evaluate(
        f"renderer.camera.reset(), useCamera({json.dumps(keys)}), moveCamera(renderer.camera, {time}), "
        "(({ yaw, pitch, scale, target }) => JSON.stringify([yaw * 180 / Math.PI, pitch * 180 / Math.PI, scale, target]))(renderer.camera)"))


def check(browser):
    first = json.loads(browser.evaluate("JSON.stringify(renderer.camera.target)"))
    at = lambda time: camera_at(browser, KEYS, time)
    yaw = lambda time: at(time)[0]
    close = lambda a, b: math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-9)
    for key in KEYS:
        assert close(yaw(key["time"]), key["yaw"]), (key, yaw(key["time"]))
    assert yaw(0) == yaw(1) and yaw(9) == yaw(6), "constant before the first and after the last key"
    values = [yaw(1 + k / 10) for k in range(51)]
    assert all(b >= a for a, b in zip(values[:31], values[1:31])), f"beyond the keys: {values}"
    assert all(abs(v - 100) < 1e-9 for v in values[30:41]), f"equal keys are no rest: {values}"
    for time in (2, 4, 5):  # no kink
        before, after = yaw(time) - yaw(time - 1e-5), yaw(time + 1e-5) - yaw(time)
        assert abs(after - before) < 1e-7, f"a kink at {time} s: {before} {after}"
    assert abs(yaw(1.5) - 45) > 1, "a cubic curve, no line"
    assert all(map(close, at(3)[3], [2, 0, 2])), f"two keys are a line: {at(3)}"
    assert close(at(0)[1], 10) and at(3)[2] == 1, f"values of one key and of none: {at(0)} {at(3)}"
    assert camera_at(browser, [{"time": 0, "scale": 2}], 1)[3] == first, "a value that no key has does not stay"
    half = camera_at(browser, [{"time": 0, "yaw": 0}, {"time": 1, "yaw": 180}, {"time": 2, "yaw": 360}], 0.25)
    assert close(half[0], 45), f"a turntable has a constant speed: {half}"


with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
    page = devtools.Browser(pathlib.Path(sys.argv[1]).resolve().as_uri(), profile, (480, 300))
    try:
        page.wait("document.body?.classList.contains('ready')")
        check(page)
        assert not page.errors(), page.errors()
    finally:
        page.close()

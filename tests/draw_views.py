"""Draws the last frame of a replay page in one browser. Usage: draw_views.py PAGE FOLDER VIEW...

Writes FOLDER/VIEW.png for each view, and FOLDER/all.png for the usual one, which must look the same after the others."""
import base64
import json
import pathlib
import sys
import tempfile

import devtools


def draw(browser, view):
    return base64.b64decode(browser.evaluate(f"applyView({json.dumps(view)}), pictureOfFrame(lastFrame(), 480, 300, 2)"))


folder = pathlib.Path(sys.argv[2])
with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
    browser = devtools.Browser(pathlib.Path(sys.argv[1]).resolve().as_uri(), profile, (480, 300))
    try:
        browser.wait("document.body?.classList.contains('ready')")
        usual = draw(browser, "")
        (folder / "all.png").write_bytes(usual)
        for view in sys.argv[3:]:
            (folder / f"{view}.png").write_bytes(draw(browser, view))
        assert draw(browser, "") == usual, "a view changes the views after it"
        assert not browser.errors(), browser.errors()
    finally:
        browser.close()

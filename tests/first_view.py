"""Checks the first view of a replay page. Usage: first_view.py PAGE TOP GROUND

TOP: m, the least height that the bounds of the view must reach; GROUND: m, the least height of the ground."""
import pathlib
import sys
import tempfile

import devtools

top, ground = map(float, sys.argv[2:])
with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
    browser = devtools.Browser(pathlib.Path(sys.argv[1]).resolve().as_uri(), profile, (480, 300))
    try:
        browser.wait("document.body?.classList.contains('ready')")
        high = browser.evaluate("renderer.camera.bounds[1][1]")
        low = browser.evaluate("renderer.groundHeight")
    finally:
        browser.close()
print(f"bounds up to {high} m, expected {top} or more; ground at {low} m, expected {ground} or higher")
sys.exit(not (high >= top - 1e-3 and low >= ground - 1e-3))

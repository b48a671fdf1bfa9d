#!/usr/bin/env python3
"""Draws docs/gallery/live_view.png: the page of `projdyn view` while the mouse pulls a sheet. Needs a build in build/,
chromium and pngquant (scripts/install.sh chromium pngquant)."""
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

root = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(root / "tests"))
import devtools  # noqa: E402

view = subprocess.Popen([root / "build/app/projdyn", "view", root / "scenes/hanging_cloth.json", "--no-browser",
                         "--set", "solver.tolerance=1e-2"],
                        stdout=subprocess.PIPE, text=True)
with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
    page = devtools.Browser(view.stdout.readline().strip(), folder, (1280, 800), patience=300)
    page.wait("document.body?.classList.contains('ready') && meta.times[lastFrame()] > 0.6", 300)
    page.press(" ", 32)
    page.wait("!player.playing", 60)
    x, y = page.evaluate("""(() => { const x = metres(meta.bodies[0], lastFrame()), r = $("scene").getBoundingClientRect();
        const at = project(renderer.camera, $("scene"), vertexPlace(x, 33 * 28 + 22)); return [at.x + r.left, at.y + r.top]; })()""")
    page.drag([(x, y), (x + 10, y - 20), (x + 30, y - 60), (x + 60, y - 110)], release=False)
    start = page.evaluate("meta.times[lastFrame()]")
    page.press(" ", 32)
    page.wait(f"meta.times[lastFrame()] > {start} + 0.5", 300)
    page.press(" ", 32)
    page.wait("!player.playing", 60)
    page.evaluate("new Promise((done) => setTimeout(done, 2000))")  # the picture at full quality
    time.sleep(1)
    page.picture(root / "docs/gallery/live_view.png")
    page.close()
view.send_signal(signal.SIGINT)
view.wait()
subprocess.run(["pngquant", "--force", "--ext", ".png", "--quality", "85-99", root / "docs/gallery/live_view.png"], check=True)

#!/bin/sh
# A short run, its page in a headless browser, and a look at the picture: water and cloth must be in it.
# Arguments: the program, a scene with both. Exit 77 where no Chromium is installed.
set -eu
program=$1 scene=$2
browser=$(command -v chromium || command -v chromium-browser) || { echo "skipped: no chromium"; exit 77; }
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

"$program" run "$scene" -o "$dir/out" --quiet
"$program" replay "$dir/out" -o "$dir/replay.html"
"$browser" --headless --no-sandbox --disable-gpu --use-gl=angle --use-angle=swiftshader \
    --enable-unsafe-swiftshader --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --user-data-dir="$dir/profile" --hide-scrollbars \
    --window-size=1280,720 --virtual-time-budget=8000 --screenshot="$dir/page.png" \
    "file://$dir/replay.html#frame=5&play=0" 2>/dev/null
[ -z "${KEEP:-}" ] || cp "$dir/page.png" "$dir/replay.html" "$KEEP"
/usr/bin/python3 - "$dir/page.png" <<'PYTHON'
import struct, sys, zlib

def pixels(path):
    data = open(path, "rb").read()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        packed += body if kind == b"IDAT" else b""
        at += size + 12
    assert depth == 8, depth
    n = {2: 3, 6: 4}[colour]
    raw, last = zlib.decompress(packed), bytearray(width * n)
    for y in range(height):
        filter_, line = raw[y * (width * n + 1)], bytearray(raw[y * (width * n + 1) + 1:(y + 1) * (width * n + 1)])
        for k in range(len(line)):
            a, b, c = line[k - n] if k >= n else 0, last[k], last[k - n] if k >= n else 0
            p = a + b - c
            paeth = a if abs(p - a) <= abs(p - b) and abs(p - a) <= abs(p - c) else b if abs(p - b) <= abs(p - c) else c
            line[k] = (line[k] + (0, a, b, (a + b) // 2, paeth)[filter_]) & 255
        last = line
        for x in range(width):
            yield x, y, line[x * n], line[x * n + 1], line[x * n + 2]

water = cloth = 0
for x, y, r, g, b in pixels(sys.argv[1]):
    if x > 900 or y < 60 or y > 640:
        continue  # plots, title and controls
    water += b > r + 40 and b > 70
    cloth += r > g + 40 and r > b + 50
print(f"{water} pixels of water, {cloth} of cloth")
sys.exit(water < 2000 or cloth < 2000)
PYTHON

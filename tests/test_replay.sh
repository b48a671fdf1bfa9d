#!/bin/sh
# Runs a scene for a moment, makes the replay page and looks at it in a browser.
# Usage: test_replay.sh PROJDYN SCENE.json
set -eu
projdyn=$1 scene=$2
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
    echo "skipped: chromium is not installed"
    exit 77
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
    echo "failed: $*" >&2
    exit 1
}

# expect_error EXIT-CODE WORDS ARGUMENTS...: the code, and the words in the message
expect_error() {
    expected=$1 words=$2 code=0
    shift 2
    "$projdyn" replay "$@" >"$folder/out" 2>&1 || code=$?
    [ "$code" -eq "$expected" ] || fail "replay $*: exit code $code, expected $expected"
    grep -qF -- "$words" "$folder/out" || fail "replay $*: no \"$words\" in: $(cat "$folder/out")"
}

screenshot() { # PAGE HASH PICTURE
    timeout 120 "$browser" --headless --no-sandbox --disable-gpu --use-gl=angle \
        --use-angle=swiftshader --enable-unsafe-swiftshader --disable-quic --no-first-run \
        --disable-background-networking --disable-component-update --disable-sync \
        --hide-scrollbars --user-data-dir="$folder/profile" --window-size=1280,720 \
        --virtual-time-budget=10000 --screenshot="$3" "file://$1#$2" >"$folder/browser" 2>&1 ||
        fail "the browser: $(tail -n 5 "$folder/browser")"
    [ -s "$3" ] || fail "the browser made no picture: $(tail -n 5 "$folder/browser")"
}

# Counts the pixels of water (blue to green) and of cloth (orange) in the middle of the view, where
# nothing lies over the scene.
count_colours() { # PICTURE
    python3 - "$1" <<'PYTHON'
import struct
import sys
import zlib

data = open(sys.argv[1], "rb").read()
assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
at, packed = 8, b""
while at < len(data):
    size, kind = struct.unpack(">I4s", data[at:at + 8])
    body = data[at + 8:at + 8 + size]
    if kind == b"IHDR":
        width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
    if kind == b"IDAT":
        packed += body
    at += 12 + size
assert depth == 8 and colour in (2, 6) and not interlaced, "unexpected kind of PNG"
channels = 3 if colour == 2 else 4
stride = width * channels
raw = zlib.decompress(packed)


def paeth(a, b, c):
    p = a + b - c
    distance = abs(p - a), abs(p - b), abs(p - c)
    return (a, b, c)[distance.index(min(distance))]


predict = [lambda a, b, c: 0, lambda a, b, c: a, lambda a, b, c: b,
           lambda a, b, c: (a + b) // 2, paeth]
row, water, cloth = bytearray(stride), 0, 0
for y in range(height):
    line = raw[y * (stride + 1):(y + 1) * (stride + 1)]
    above, row, guess = row, bytearray(line[1:]), predict[line[0]]
    for i in range(stride):
        left = i >= channels
        row[i] = (row[i] + guess(row[i - channels] if left else 0, above[i],
                                 above[i - channels] if left else 0)) & 255
    if 0.27 < y / height < 0.9:
        for x in range(int(0.05 * width), int(0.65 * width)):
            r, g, b = row[x * channels:x * channels + 3]
            water += b > 90 and g > r + 25 and b > r + 40
            cloth += r > 90 and r > g + 35 and g > b + 5
print(water, cloth)
PYTHON
}

expect_pixels() { # PICTURE
    counts=$(count_colours "$1")
    echo "$(basename "$1"): pixels of water and cloth: $counts"
    [ "${counts% *}" -ge 1500 ] || fail "$1: expected at least 1500 pixels of water"
    [ "${counts#* }" -ge 1500 ] || fail "$1: expected at least 1500 pixels of cloth"
}

run=$folder/run
"$projdyn" run "$scene" -o "$run" --time 0.1 --quiet
"$projdyn" replay "$run" -o "$folder/replay.html"
grep -qE '(src|href)=|https?://' "$folder/replay.html" && fail "the page refers to something else"
screenshot "$folder/replay.html" "frame=3&play=0" "$folder/third.png"
expect_pixels "$folder/third.png"

# Without the report everything is still shown.
mv "$run/report.json" "$folder/report.json"
"$projdyn" replay "$run" 2>"$folder/out"
grep -q "no report.json" "$folder/out" || fail "no word about the missing report"
screenshot "$run/replay.html" "frame=1&play=0" "$folder/first.png"
expect_pixels "$folder/first.png"
mv "$folder/report.json" "$run/report.json"

# Solids that move are drawn where they are in a frame, with a report or without.
"$projdyn" run "$scene" -o "$folder/moving" --time 0.1 --quiet \
    --set 'solids.tank.motion=[{"time": 0}, {"time": 1, "translate": [0, -1, 0]}]'
for report in told missing; do
    "$projdyn" replay "$folder/moving" 2>"$folder/out"
    grep -q '"moving":{"count":' "$folder/moving/replay.html" || fail "nothing moves in the page"
    screenshot "$folder/moving/replay.html" "frame=3&play=0" "$folder/moving_$report.png"
    expect_pixels "$folder/moving_$report.png"
    rm -f "$folder/moving/report.json"
done

# Bad input names the file and leaves no page.
water=$run/water_000003.vtk
rm "$run/replay.html"
cp "$water" "$folder/water.vtk"
head -c 5000 "$folder/water.vtk" >"$water"
expect_error 2 "water_000003.vtk: byte 100: truncated: expected 2400 numbers of POINTS, found 1225" "$run"
echo "solid cube" >"$water"
expect_error 2 "expected the line \"# vtk DataFile Version 4.2\", found \"solid cube\"" "$run"
cp "$run/sheet_000003.vtk" "$water"
expect_error 2 "expected 800 points and 0 triangles as in the first frame, found 625" "$run"
{ cat "$folder/water.vtk"; echo more; } >"$water"
expect_error 2 "expected the end of the file, found 5 more bytes" "$run"
rm "$water"
expect_error 2 "water_000003.vtk: cannot open" "$run"
cp "$folder/water.vtk" "$water"
cp "$run/metrics.csv" "$folder/metrics.csv"
echo "0.5,oops" >>"$run/metrics.csv"
expect_error 2 "expected 27 cells, found 2" "$run"
cp "$folder/metrics.csv" "$run/metrics.csv"
mkdir "$folder/empty"
expect_error 2 "expected the output of a run" "$folder/empty"
expect_error 2 "cannot read the directory" "$folder/nowhere"
expect_error 2 "expected one directory"
expect_error 1 "cannot create the file" "$run" -o "$folder/nowhere/replay.html"
[ ! -e "$run/replay.html" ] && [ ! -e "$run/replay.html.tmp" ] || fail "a bad run left a page"
echo "all checks passed"

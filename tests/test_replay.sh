#!/bin/sh
# Runs a scene for a moment, makes the replay page, and compares pictures that `projdyn render` draws
# of it with and without each part. Usage: test_replay.sh PROJDYN SCENE.json
set -eu
projdyn=$(realpath "$1") scene=$2
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
    echo "failed: $*" >&2
    exit 1
}

# expect_error EXIT-CODE WORDS COMMAND ARGUMENTS...: the code, and the words in the message
expect_error() {
    expected=$1 words=$2 code=0
    shift 2
    "$projdyn" "$@" >"$folder/out" 2>&1 || code=$?
    [ "$code" -eq "$expected" ] || fail "$*: exit code $code, expected $expected: $(cat "$folder/out")"
    grep -qF -- "$words" "$folder/out" || fail "$*: no \"$words\" in: $(cat "$folder/out")"
}

# A box of glass, a ball of stone and a wall that moves.
run=$folder/run
"$projdyn" run "$scene" -o "$run" --time 0.2 --quiet --set 'solids=[
    {"name": "tank", "box": {"minimum": [-0.6, 0, -0.6], "maximum": [0.6, 0.4, 0.6]}, "open": ["+y"]},
    {"name": "ball", "sphere": {"center": [0.45, 0.15, 0.45], "radius": 0.12}},
    {"name": "rod", "capsule": {"from": [-0.5, 0.1, 0.5], "to": [-0.2, 0.1, 0.5], "radius": 0.05},
     "motion": [{"time": 0}, {"time": 0.2, "translate": [0, 0.3, 0]}]}]'
"$projdyn" replay "$run" -o "$folder/replay.html"
grep -qE '(src|href)=|https?://' "$folder/replay.html" && fail "the page refers to something else"

# Bad input names the file and leaves no page.
water=$run/water_000003.vtk
cp "$water" "$folder/water.vtk"
head -c 5000 "$folder/water.vtk" >"$water"
expect_error 2 "water_000003.vtk: byte 100: truncated: expected 2400 numbers of POINTS, found 1225" replay "$run"
echo "solid cube" >"$water"
expect_error 2 "expected the line \"# vtk DataFile Version 4.2\", found \"solid cube\"" replay "$run"
cp "$run/sheet_000003.vtk" "$water"
expect_error 2 "expected 800 points and 0 triangles as in the first frame, found 625" replay "$run"
{ cat "$folder/water.vtk"; echo more; } >"$water"
expect_error 2 "expected the end of the file, found 5 more bytes" replay "$run"
rm "$water"
expect_error 2 "water_000003.vtk: cannot open" replay "$run"
cp "$folder/water.vtk" "$water"
cp "$run/metrics.csv" "$folder/metrics.csv"
echo "0.5,oops" >>"$run/metrics.csv"
expect_error 2 "expected 31 cells, found 2" replay "$run"
cp "$folder/metrics.csv" "$run/metrics.csv"
mv "$run/solids/ball.vtk" "$folder/ball.vtk"
expect_error 2 "solids/ball.vtk: cannot open" replay "$run"
mv "$folder/ball.vtk" "$run/solids/ball.vtk"
mkdir "$folder/empty"
expect_error 2 "expected the output of a run" replay "$folder/empty"
expect_error 2 "cannot read the directory" replay "$folder/nowhere"
expect_error 2 "expected the directory of a run, found a file" replay "$run/report.json"
expect_error 2 "expected one directory" replay
expect_error 1 "writing failed: No such file" replay "$run" -o "$folder/nowhere/replay.html"
[ ! -e "$run/replay.html" ] && [ ! -e "$run/replay.html.tmp" ] || fail "a bad run left a page"
expect_error 2 "expected one directory and -o FILE" render "$run"
expect_error 2 "ends with .png, .mp4, .webm or .gif" render "$run" -o "$folder/film.avi"
for name in a_%s.png a_%.3d.png a_%d_%d.png a_%123d.png %.png; do
    expect_error 2 "expected at most one '%'" render "$run" -o "$folder/$name"
done
expect_error 2 "--size 99x100: expected WIDTHxHEIGHT" render "$run" -o "$folder/a.png" --size 99x100
expect_error 2 "--frame 11: expected at most 10" render "$run" -o "$folder/a.png" --frame 11
expect_error 2 "--frames: expected at most 10, the last frame of the run, found 11" render "$run" -o "$folder/a.gif" --frames 3:11
expect_error 2 "--turntable 0: expected a number from 0.04" render "$run" -o "$folder/a.gif" --turntable 0
expect_error 2 "--turntable: expected a film or numbered pictures" render "$run" -o "$folder/a.png" --turntable 1
expect_error 2 "--turntable: expected a film or numbered pictures" render "$run" -o "$folder/a.gif" --turntable 1 --frames 1:2
expect_error 2 "--frames: expected a film or numbered pictures" render "$run" -o "$folder/a.png" --frames 1:2
expect_error 2 "--fps: expected a film or --turntable" render "$run" -o "$folder/a.png" --fps 10
expect_error 2 "--fps: expected a film or --turntable" render "$run" -o "$folder/a_%d.png" --fps 10
expect_error 2 "--frame, --time: expected one of them" render "$run" -o "$folder/a.png" --frame 1 --time 0.1
expect_error 2 "--frame: expected a picture or --turntable" render "$run" -o "$folder/a.gif" --frame 1
expect_error 2 "--time: expected a picture or --turntable" render "$run" -o "$folder/a_%d.png" --time 0.1
expect_error 2 "--camera 1:11: expected JSON" render "$run" -o "$folder/a.png" --camera '[{"time": 0'
expect_error 2 "nowhere.json: cannot open" render "$run" -o "$folder/a.png" --camera "$folder/nowhere.json"
PATH=$folder "$projdyn" render "$run" -o "$folder/a.png" 2>"$folder/out" && fail "a picture without a browser"
grep -q "apt-get install chromium" "$folder/out" || fail "no word about the missing browser: $(cat "$folder/out")"
[ ! -e "$folder/a.png" ] || fail "a picture without a browser"

command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null || {
    echo "skipped: chromium is not installed"
    exit 77
}

picture() { # NAME VIEW
    "$projdyn" render "$run" -o "$folder/$1.png" --size 480x300 --view "$2" >"$folder/out" 2>&1 ||
        fail "render: $(cat "$folder/out")"
}
for fault in 'hid=water: unknown name "hid"; known: frame,' 'hide=watr: hide: unknown part "watr"; known: ' \
    'fluid=velocity: fluid: unknown value "velocity"; known: ' 'camera=1,2: camera: expected three or six numbers' \
    'camera=1,2,0: camera: scale: expected a number from 0.01 to 100, found 0' \
    'cut=0.5: cut: expected a text as x-0.5' 'hide=5%: hide: unknown part "5%"; known: '; do
    expect_error 2 "--view $fault" render "$run" -o "$folder/fault.png" --size 64x48 --view "${fault%%: *}"
    [ ! -e "$folder/fault.png" ] || fail "a picture of an unknown view"
done
echo '[{"time": 0, "yaw": 1}, {"time": 1, "pitch": 95}]' >"$folder/steep.json"
expect_error 2 "steep.json: [1].pitch: expected a number from -89 to 89 degrees, found 95" \
    render "$run" -o "$folder/fault.png" --size 64x48 --camera "$folder/steep.json"
python=${PYTHON:-python3}
"$python" "$here/draw_views.py" "$folder/replay.html" "$folder" hide=water hide=sheet hide=tank hide=ball look=particles \
    surface=checker surface=stretch fluid=speed fluid=pressure "fluid=speed&surface=stretch" "hide=water&fluid=speed" cut=x-0.5 camera=90,20,1,0,0.4,0 camera=90,20,1
picture hide=rod hide=rod
"$projdyn" render "$run" -o "$folder/third.png" --size 480x300 --frame 3 >/dev/null
picture link "frame=3&play=0"
cmp "$folder/link.png" "$folder/third.png" || fail "the text of the button Link draws another frame"
rm "$folder/link.png" "$folder/third.png"

# A run that has no report yet looks as it does with one. Without files.json, too, the bodies are still shown.
picture reported ""
mv "$run/report.json" "$folder/report.json"
picture early ""
grep -q warning "$folder/out" && fail "a run without a report: $(cat "$folder/out")"
cmp "$folder/early.png" "$folder/reported.png" || fail "a run without a report looks different"
"$projdyn" mesh "$run" --frames 1:1 --threads 1 || fail "mesh needs the report"
mv "$run/files.json" "$folder/files.json"
picture no_report ""
grep -q "no report.json" "$folder/out" || fail "no word about the missing report"
expect_error 2 "expected report.json or files.json" mesh "$run"
mv "$folder/report.json" "$run/report.json"
mv "$folder/files.json" "$run/files.json"
"$python" "$here/compare_pictures.py" "$folder"

# A can, as a mesh, around water, water that falls past it, and a rod that rises: the picture shows the water in the
# can and the rod, and the ground is not where the water falls to.
cat >"$folder/can.json" <<'EOF'
{"duration": 2, "frame_interval": 0.2,
 "bodies": [{"name": "water", "constraints": [{"type": "fluid"}], "particles": {"radius": 0.02, "fill": [
    {"box": {"minimum": [-0.16, 0, -0.16], "maximum": [0.16, 0.24, 0.16]}},
    {"box": {"minimum": [0.3, 0.2, 0], "maximum": [0.42, 0.32, 0.12]}}]}}],
 "solids": [{"name": "can", "mesh": "can.obj"},
   {"name": "rod", "capsule": {"from": [0.3, 0.3, -0.2], "to": [0.4, 0.3, -0.2], "radius": 0.02},
    "motion": [{"time": 0}, {"time": 2, "translate": [0, 0.5, 0]}]}]}
EOF
cat >"$folder/can.obj" <<'EOF'
v -0.16 0 -0.16
v 0.16 0 -0.16
v 0.16 0 0.16
v -0.16 0 0.16
v -0.16 0.4 -0.16
v 0.16 0.4 -0.16
v 0.16 0.4 0.16
v -0.16 0.4 0.16
f 1 2 3 4
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
EOF
"$projdyn" run "$folder/can.json" -o "$folder/can" --quiet
mkdir "$folder/cans"
for name in all hide=water cut=y+1; do # the cut is above everything: no meshes of the water
    "$projdyn" render "$folder/can" -o "$folder/cans/$name.png" --size 480x300 --view "${name#all}" >/dev/null
done
"$projdyn" run "$folder/can.json" -o "$folder/colors" --quiet --set bodies.water.color='"#30c040"' --set solids.rod.color='"#d01010"'
"$projdyn" render "$folder/colors" -o "$folder/cans/colors.png" --size 480x300 >/dev/null
"$python" "$here/compare_pictures.py" "$folder/cans"
"$projdyn" replay "$folder/can" -o "$folder/can.html" >/dev/null
"$python" "$here/first_view.py" "$folder/can.html" 0.82 -0.5

# A tank that is mostly empty, and a drop that falls past it: the first view has the top of the tank, and the tank stands
# on the ground.
cat >"$folder/tank.json" <<'EOF'
{"duration": 0.4, "frame_interval": 0.1,
 "bodies": [{"name": "water", "constraints": [{"type": "fluid"}], "particles": {"radius": 0.01, "fill": [
    {"box": {"minimum": [-0.16, 0, -0.16], "maximum": [0.16, 0.1, 0.16]}},
    {"box": {"minimum": [0.3, 0.1, 0], "maximum": [0.34, 0.14, 0.04]}}]}}],
 "solids": [{"name": "tank", "box": {"minimum": [-0.16, 0, -0.16], "maximum": [0.16, 0.4, 0.16]}, "open": ["+y"]}]}
EOF
"$projdyn" run "$folder/tank.json" -o "$folder/tank" --quiet
"$projdyn" replay "$folder/tank" -o "$folder/tank.html" >/dev/null
"$python" "$here/first_view.py" "$folder/tank.html" 0.4 0

# Of two boxes one falls past a table, 19 m in 2 s: the first view has the table, and the ground is below that.
cat >"$folder/table.json" <<'EOF'
{"duration": 2, "frame_interval": 0.5, "contact": {"thickness": 0.002},
 "bodies": [
  {"name": "stays", "rigid": {"box": {"minimum": [-0.1, 0.01, -0.1], "maximum": [0.1, 0.21, 0.1]}, "density": 600}},
  {"name": "falls", "rigid": {"box": {"minimum": [0.4, 0, 0], "maximum": [0.5, 0.1, 0.1]}, "density": 600}}],
 "solids": [{"name": "table", "box": {"minimum": [-0.3, -0.05, -0.3], "maximum": [0.3, 0, 0.3]}}]}
EOF
"$projdyn" run "$folder/table.json" -o "$folder/table" --quiet 2>/dev/null # a warning: the box falls out
"$projdyn" replay "$folder/table" -o "$folder/table.html" >/dev/null
"$python" "$here/first_view.py" "$folder/table.html" 0.1 -0.051

# Light: a ball just above the ground takes the sky from what is below it; a bright sheet keeps its colour.
cat >"$folder/studio.json" <<'EOF'
{"duration": 0.01, "gravity": [0, 0, 0], "bodies": [
  {"name": "sheet", "surface": {"grid": {"size": [0.2, 0.2], "vertices": [9, 9]}, "translate": [0.5, 0, 0], "area_density": 0.3}},
  {"name": "ball", "rigid": {"sphere": {"center": [0, 0.11, 0], "radius": 0.1}, "density": 500}}]}
EOF
"$projdyn" run "$folder/studio.json" -o "$folder/studio" --quiet
"$projdyn" render "$folder/studio" -o "$folder/studio.png" --size 480x300 --view "camera=0,25,0.6,0,0.05,0" >/dev/null
"$projdyn" render "$folder/studio" -o "$folder/above.png" --size 480x300 --view "camera=0,80,0.6,0.5,0,0" >/dev/null
"$python" "$here/studio_light.py" "$folder/studio.png" "$folder/above.png"

# A scene with z up looks like the same scene with y up, ground, light and shadows included.
upright() { # NAME GRAVITY MINIMUM MAXIMUM OPEN CENTER
    cat >"$folder/$1.json" <<EOF
{"duration": 0.01, "gravity": [$2], "solids": [{"name": "tank", "box": {"minimum": [$3], "maximum": [$4]}, "open": ["$5"]}],
 "bodies": [{"name": "ball", "rigid": {"sphere": {"center": [$6], "radius": 0.1}, "density": 500}}]}
EOF
    "$projdyn" run "$folder/$1.json" -o "$folder/$1" --quiet 2>/dev/null
    "$projdyn" render "$folder/$1" -o "$folder/$1.png" --size 240x150 --frame 0 >/dev/null
}
upright y_up "0, -9.81, 0" "-0.4, 0, -0.2" "0.4, 0.5, 0.3" +y "0.2, 0.1, 0.1"
upright z_up "0, 0, -9.81" "-0.4, -0.3, 0" "0.4, 0.2, 0.5" +z "0.2, -0.1, 0.1"
"$python" "$here/same_picture.py" "$folder/y_up.png" "$folder/z_up.png"

# The camera over time; a turntable begins with the view and goes on to its far side.
"$python" "$here/camera_path.py" "$folder/replay.html"
small() { # NAME OPTIONS...
    name=$1
    shift
    "$projdyn" render "$run" -o "$folder/$name" --size 96x64 "$@" >/dev/null
}
echo '[{"time": 0.01, "yaw": 210, "pitch": 20, "scale": 1, "target": [0, 0.3, 0]}]' >"$folder/camera.json"
small keys.png --camera "$folder/camera.json"
small inline.png --camera '[{"time": 1, "yaw": 210}]' --view camera=30,20,1,0,0.3,0
small turned_%d.png --turntable 0.5 --fps 4 --view camera=30,20,1,0,0.3,0
small near.png --view camera=30,20,1,0,0.3,0
small far.png --view camera=210,20,1,0,0.3,0
cmp "$folder/keys.png" "$folder/far.png" || fail "--camera FILE is not the view of its key"
cmp "$folder/inline.png" "$folder/far.png" || fail "--camera ARRAY is not the view with its yaw"
cmp "$folder/turned_0.png" "$folder/near.png" || fail "a turntable does not begin with the view"
cmp "$folder/turned_1.png" "$folder/far.png" || fail "half of a turntable is not half a turn"
[ ! -e "$folder/turned_2.png" ] || fail "a turntable of 0.5 s has more than two pictures at --fps 4"

# A run at rest has no speeds.
cat >"$folder/still.json" <<'EOF'
{"duration": 0.1, "gravity": [0, 0, 0], "bodies": [
  {"name": "sheet", "surface": {"grid": {"size": [1, 1], "vertices": [9, 9]}, "area_density": 0.3}}]}
EOF
"$projdyn" run "$folder/still.json" -o "$folder/still" --quiet 2>/dev/null
expect_error 2 'surface: unknown value "speed"; known: plain, checker, stretch' \
    render "$folder/still" -o "$folder/fault.png" --size 64x48 --view surface=speed

# Numbered pictures and films.
"$projdyn" render "$run" -o "$folder/n_%03d.png" --size 64x48 >/dev/null
[ "$(ls "$folder" | grep -c '^n_0')" -eq 11 ] || fail "expected 11 numbered pictures: $(ls "$folder")"
"$projdyn" render "$run" -o "$folder/some_%03d.png" --size 64x48 --frames 4:6 >/dev/null
[ "$(cd "$folder" && ls | grep '^some_' | tr '\n' ' ')" = "some_004.png some_005.png some_006.png " ] || fail "--frames 4:6"
"$projdyn" render "$run" -o "$folder/one.png" --size 64x48 --frame 10 >/dev/null
mkdir "$folder/5% #1"
(cd "$folder" && TMPDIR="5% #1" timeout 60 "$projdyn" render "$run" -o same.png --size 64x48 --frame 10 >/dev/null) ||
    fail "no picture with a TMPDIR that is not part of a URL as it is"
cmp "$folder/one.png" "$folder/same.png"
cmp "$folder/one.png" "$folder/n_010.png" || fail "numbered picture 10 is not frame 10"
cmp -s "$folder/n_000.png" "$folder/n_010.png" && fail "numbered pictures 0 and 10 are the same"
(trap '' HUP; exec "$projdyn" render "$run" -o "$folder/nohup_%03d.png" --size 320x240) >/dev/null &
for _ in $(seq 100); do ls "$folder" | grep -q '^nohup_' && break; sleep 0.1; done
kill -HUP $!
wait $! || fail "a render under nohup ended with its terminal"
[ "$(ls "$folder" | grep -c '^nohup_')" -eq 11 ] || fail "a render under nohup stopped early"
if command -v ffmpeg >/dev/null; then
    "$projdyn" render "$run" -o "$folder/film.mp4" --size 64x48 >/dev/null
    grep -aq ftypisom "$folder/film.mp4" || fail "no film"
    [ ! -e "$folder/film.mp4.tmp" ] || fail "a temporary film is left"
    "$projdyn" render "$run" -o "$folder/short.gif" --size 64x48 --frames 0:3 --fps 1000 >/dev/null
    [ -s "$folder/short.gif" ] || fail "a GIF of 4 ms is empty"
    mkdir "$folder/temporary"
    TMPDIR="$folder/temporary" "$projdyn" render "$run" -o "$folder/killed.mp4" --size 640x480 >"$folder/out" 2>&1 &
    for _ in $(seq 100); do ls "$folder" | grep -q '^killed' && break; sleep 0.1; done
    kill -TERM $!
    wait $! && fail "a killed film ended with 0"
    [ -z "$(ls "$folder/temporary"; ls "$folder" | grep '^killed')" ] ||
        fail "a killed render leaves files: $(ls "$folder/temporary" "$folder")"
fi
echo "all checks passed"

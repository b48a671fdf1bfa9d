#!/bin/sh
# Exit codes and messages of the command line. Arguments: the program, the source folder.
program=$(realpath "$1") root=$(realpath "$2")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
scene=$root/tests/pour.json
passed=0 failed=0

says() {
    if [ "$1" ]; then grep -qF -e "$1" "$dir/said"; else [ ! -s "$dir/said" ]; fi
}

# expect NAME CODE TEXT COMMAND...: the exit code, and a text in what is printed; '' for nothing
expect() {
    name=$1 code=$2 text=$3
    shift 3
    "$@" >"$dir/said" 2>&1
    got=$?
    if [ "$got" = "$code" ] && says "$text"; then
        passed=$((passed + 1)) && echo "ok $name"
    else
        failed=$((failed + 1)) && echo "not ok $name: exit $got (expected $code), expected to read '$text' in:"
        sed 's/^/    /' "$dir/said"
    fi
}

skip() {
    echo "skipped: $1"
}

# stop_run FOLDER SIGNALS ARGUMENTS...: starts a run, signals it once it takes steps, and
# leaves its exit code in $ended; SIGHUP is not ignored where nohup runs this test
stop_run() {
    folder=$1 signals=$2
    shift 2
    timeout --foreground -s KILL 60 env --default-signal=HUP \
        "$program" run "$scene" -o "$folder" --time 100 --quiet "$@" 2>"$dir/stopped" &
    pid=$!
    for _ in $(seq 100); do
        [ "$(cat "$folder/metrics.csv" 2>/dev/null | wc -l)" -gt 2 ] && break
        sleep 0.1
    done
    read -r child <"/proc/$pid/task/$pid/children" # `timeout` hands few signals on
    for signal in $signals; do
        kill -"$signal" "$child"
        for _ in $(seq 100); do
            [ -s "$dir/stopped" ] && break # it says that it heard
            sleep 0.1
        done
    done
    wait $pid
    ended=$?
}

# Of a frame, but for its title with the time.
length() {
    LC_ALL=C sed 2d "$1" | wc -c
}

# whole_frames FOLDER: every listed frame is as long as the first, and nothing is half written
whole_frames() {
    for body in water sheet; do
        first=$(length "$1/${body}_000000.vtk")
        listed=$(grep -o "${body}_[0-9]*\\.vtk" "$1/$body.vtk.series") || return 1
        for frame in $listed; do
            [ "$(length "$1/$frame")" = "$first" ] || return 1
        done
    done
    [ -z "$(find "$1" -name '*.tmp')" ] && echo "all whole"
}

# ends_at_frame FOLDER: the last step and the last listed frame are at the same time
ends_at_frame() {
    step=$(tail -n 1 "$1/metrics.csv" | cut -d , -f "$(head -n 1 "$1/metrics.csv" | tr , '\n' | grep -nx time_s | cut -d : -f 1)")
    frame=$(grep -o '"time": [^}]*' "$1/water.vtk.series" | tail -n 1 | cut -d ' ' -f 2)
    awk -v a="$step" -v b="$frame" 'BEGIN { exit !(a > 0 && (a - b) ^ 2 < 1e-16) }' && echo "ends at a frame"
}

# plant FOLDER LN-OPTION: links to $dir/target at the names that a run writes by renaming
plant() {
    mkdir "$1" && echo mine >"$dir/target"
    for name in run.json report.json state.pdyn boundary.vtk sheet.vtk.series water.vtk.series water_000000.vtk; do
        ln $2 "$dir/target" "$1/$name" && ln $2 "$dir/target" "$1/$name.tmp"
    done
}

expect "no command" 2 "Usage: projdyn COMMAND" "$program"
expect "help" 0 "replay" "$program" --help
expect "version" 0 "projdyn 0." "$program" --version
expect "solvers of the build" 0 "solvers: cg cholesky dual hybrid" "$program" --version
expect "help as a command" 0 "replay" "$program" help
expect "version as a command" 0 "projdyn 0." "$program" version
expect "unknown command" 2 'did you mean "check"' "$program" chekc
expect "unknown command lists all" 2 "  replay " "$program" chekc
expect "command like no other" 1 "" sh -c "'$program' frobnicate 2>&1 | grep 'did you mean'"
for command in run sweep compare trade check list mesh usd replay render; do
    expect "$command --help" 0 "Usage: projdyn $command" "$program" $command --help
    expect "help $command" 0 "Usage: projdyn $command" "$program" help $command
done
if "$program" view --help 2>&1 | grep -q "no live view"; then
    expect "view without libwebsockets" 2 "no live view" "$program" view "$scene"
else
    expect "view --help" 0 "Usage: projdyn view" "$program" view --help
    expect "view without a scene" 2 "expected one scene" "$program" view
    expect "port of none" 2 "from 1 to 65535" "$program" view "$scene" --port 0
fi
expect "plug-in instead of a scene" 2 "check --conformance FILE" "$program" check "$program"
expect "type of a plug-in" 2 "types of a plug-in: projdyn list --plugin FILE" "$program" list muscle
expect "run without a scene" 2 "expected one scene" "$program" run
expect "missing scene" 2 "nowhere.json" "$program" run "$dir/nowhere.json" -o "$dir/out"
expect "run without a fluid" 0 "s of wall time, residual " "$program" run "$root/scenes/hanging_cloth.json" \
    --time 0.04 -o "$dir/cloth"
expect "help of an unknown command" 2 'did you mean "check"' "$program" help chekc
expect "unknown option" 2 "projdyn: unrecognized option '--frobnicate'" "$program" run "$scene" --frobnicate
expect "unknown option: where options are" 2 "'projdyn help run' prints the options" "$program" run "$scene" --frobnicate
expect "misspelt option" 2 "did you mean --output? 'projdyn help run'" "$program" run "$scene" --ouput=x
expect "key of the scene as an option" 2 "--set PATH=VALUE changes the scene; 'projdyn help run'" \
    "$program" run "$scene" --duration 2
expect "short option that is none" 1 "" sh -c "'$program' run '$scene' --size 9 2>&1 | grep 'did you mean'"
expect "one dash for two" 2 "expected one scene file, found \"$scene\" \"x\"" "$program" run "$scene" -out x
expect "usage without a scene is short" 0 "" sh -c "test \$('$program' run 2>&1 | wc -l) = 4"
expect "threads that are no number" 2 "from 1 to 1024" "$program" run "$scene" --threads two
expect "negative time" 2 "seconds above 0" "$program" run "$scene" --time -1
for time in 0 nan inf 1s ''; do
    expect "time of '$time'" 2 "found \"$time\"" "$program" run "$scene" --time "$time" -o "$dir/out"
done
expect "threads of none" 2 'found "0"' "$program" check "$scene" --threads 0
expect "empty folder name" 2 "expected a directory" "$program" run "$scene" -o ""
expect "two scenes" 2 "expected one scene" "$program" check "$scene" "$scene"
expect "override without a value" 2 "--set solver" "$program" run "$scene" --set solver -o "$dir/out"
expect "override of what is not there" 2 "bodies.pond" "$program" check "$scene" --set bodies.pond.x=1
expect "unknown solver" 2 "cholesky" "$program" check "$scene" --set solver.type=choleski
expect "output folder is a file" 2 "$scene" "$program" run "$scene" -o "$scene/out"
expect "output folder is the file itself" 2 "$scene" "$program" run "$scene" -o "$scene"
if [ "$(id -u)" = 0 ]; then
    skip "folder without permission to write: root may write everywhere"
else
    mkdir -m 500 "$dir/locked"
    expect "folder without permission to write" 1 "locked" "$program" run "$scene" -o "$dir/locked/out"
fi
expect "check" 0 "solver hybrid" "$program" check "$scene"
expect "check names the bodies" 0 "body sheet: 625 vertices, 1152 triangles" "$program" check "$scene"
expect "check tells the last frame" 0 "duration 0.1 s, a frame every 0.04 s, the last one at 0.08 s" "$program" check \
    "$scene" --set duration=0.1 --set frame_interval=0.04
expect "check tells velocities" 0 ", velocity (0.5, 0, -1) m/s" "$program" check "$scene" --set 'bodies.sheet.velocity=[0.5, 0, -1]'
expect "check tells vectors" 0 "velocity (8, 0, 2) m/s" "$program" check "$root/scenes/flag.json" --set bodies.0.constraints.wind.velocity=[8,0,2]
expect "check tells gravity" 0 "gravity (0, -9.81, 0) m/s^2" "$program" check "$scene"
expect "check tells the viscosity that particles add" 0 "m; its particles add a viscosity of some 10 Pa s" \
    "$program" check "$root/scenes/dam_break.json"
expect "check tells it of half the spacing" 0 "m; its particles add a viscosity of some 9 Pa s" \
    "$program" check "$scene" --set bodies.water.particles.radius=0.01
viscosity_without_gravity() {
    "$program" check "$scene" --set 'gravity=[0, 0, 0]' | awk '/add a viscosity/ { n++ } END { print n + 0, "viscosities" }'
}
expect "check knows no viscosity without gravity" 0 "0 viscosities" viscosity_without_gravity
expect "check tells the bounds of solids" 0 "solid tank: from (" "$program" check "$scene"
expect "check counts the samples of surfaces" 0 " samples of surfaces" "$program" check "$scene"
expect "check says the memory" 0 " MB" "$program" check "$scene"
# Compares the size of a frame, by `check`, with that of the files of one.
disk_of_frames() {
    "$program" run "$scene" --time 0.02 -o "$dir/disk" --quiet || return
    size=$(cat "$dir"/disk/*_000000.vtk | wc -c)
    "$program" check "$scene" | awk -v size="$size" '/^disk/ && $3 == "MB:" {
        off = 1e6 * $9 / size - 1; print $4, (off * off < 1e-4 ? "frames of that size" : "frames, wrong by " off) }'
}
expect "check says the disk that frames take" 0 "11 frames of that size" disk_of_frames
expect "check tells the stiffness of a fluid" 0 "elements, stiffness 141701 N/m, compression 0.001" "$program" check "$scene"
expect "check computes it from the speed of sound" 0 "stiffness 1699.36 N/m" "$program" check "$scene" \
    --set bodies.water.constraints.fluid.sound_speed=10
expect "check of two that exclude each other" 2 "no meaning beside \"stiffness\"" "$program" check "$scene" \
    --set bodies.water.constraints.fluid.stiffness=1e5 --set bodies.water.constraints.fluid.compression=0.001
expect "check counts the constraints" 0 "constraint pin on sheet: 96 elements" "$program" check "$scene"
expect "list" 0 "bending" "$program" list
expect "list one" 0 "N/m" "$program" list spring
expect "list to a full disk" 1 "standard output" sh -c "'$program' list >/dev/full"
expect "list unknown" 2 "spring" "$program" list sprin
expect "run" 0 "projdyn replay" "$program" run "$scene" -o "$dir/out" --time 0.06
expect "plain progress" 0 "of wall time" "$program" run "$scene" -o "$dir/out" --time 0.06
expect "one plain line per frame" 0 "3" sh -c "'$program' run '$scene' -o '$dir/out' --time 0.06 2>&1 >/dev/null | wc -l"
expect "quiet" 0 "" "$program" run "$scene" -o "$dir/out" --time 0.06 --quiet
expect "a warning of a single step comes again at the end" 0 "tolerance 1e-06, at 0.5 s [unsolved]" \
    "$program" run "$root/scenes/hanging_cloth.json" --time 0.52 --set solver.outer_iterations=100 \
    -o "$dir/cloth"
expect "quiet tells warnings in their last form" 0 ", from " "$program" run "$scene" -o "$dir/out" \
    --time 0.06 --quiet --set solver.outer_iterations=1 --set solver.tolerance=1e-9
"$program" run "$scene" -o "$dir/o'clock, two words" --time 0.01 >"$dir/next" 2>&1
expect "the next command is one for the shell" 0 "1 frame written" \
    sh -c "$(sed -n 's/.*; next: //p' "$dir/next" | sed "s|^projdyn|'$program'|")"
expect "default folder" 0 "written to out/pour;" sh -c "cd '$dir' && '$program' run '$scene' --time 0.01"
if script -qec true /dev/null >/dev/null 2>&1; then
    expect "a long run has its end in hours" 130 " h, density" script -qec \
        "'$program' run '$scene' -o '$dir/out' --time 100000 --wall-time 1" /dev/null
    expect "progress on a terminal" 0 "ms/step" script -qec "'$program' run '$scene' -o '$dir/out' --time 0.1" /dev/null
    expect "quiet on a terminal" 0 "" script -qec "'$program' run '$scene' -o '$dir/out' --time 0.02 --quiet" /dev/null
else
    skip "progress on a terminal: no script(1)"
fi
expect "the report is there" 0 '"state_hash"' cat "$dir/out/report.json"
expect "full disk" 1 "/dev/full" "$program" run "$scene" -o "$dir/out" --time 0.02 --report /dev/full
expect "a report that cannot be written is in the output" 1 "the report is in $dir/out/report.json" \
    "$program" run "$scene" -o "$dir/out" --time 0.02 --report "$dir/nowhere/report.json"
if unshare -rm true 2>/dev/null && unshare -rm mount -t tmpfs none "$dir" 2>/dev/null; then
    mkdir "$dir/small"
    # what is left in it is looked at inside: the mount ends with its name space
    cat >"$dir/fill.sh" <<EOF
mount -t tmpfs -o size=256k none '$dir/small' || exit 9
'$program' run '$scene' -o '$dir/small/out' --time 2 --quiet 2>'$dir/full_said'
code=\$?
cat '$dir/full_said'
cp -r '$dir/small/out' '$dir/filled'
exit \$code
EOF
    expect "small file system" 1 "$dir/small/out/" unshare -rm sh "$dir/fill.sh"
    expect "small file system is said to be full" 0 "No space left" cat "$dir/full_said"
    expect "frames on a full disk" 0 "all whole" whole_frames "$dir/filled"
else
    skip "small file system: mounting is not permitted"
fi
contest="$root/scenes/hanging_cloth.json --set bodies.sheet.surface.grid.vertices=[17,17] --set solver.outer_iterations=3
    --set bodies.sheet.constraints.pin.vertices.vertices=[0,16] --steps 3 --rounds 2"
expect "compare" 0 "times as fast as with" "$program" compare $contest --solver cg,cholesky --set solver.step=projective
expect "compare with itself" 0 "0.00e+00" sh -c "'$program' compare $(echo $contest) --solver cg,cg | grep ^cg | sed 1d"
expect "compare says what auto is" 0 "auto begins with hybrid" "$program" compare $contest --solver auto,cg
expect "compare of one round" 0 ": 3 steps with integrator bdf2, 1 round, one thread" \
    "$program" compare $contest --rounds 1 --solver auto,cg
expect "compare in one way" 0 "cholesky" sh -c "'$program' compare $(echo $contest) --solver cg,cholesky --set solver.step=projective \
    --csv | awk -F, 'NR == 2 { linear = \$5 } NR == 3 && \$5 == 3 && linear > 3 && \$8 > 0 && \$8 < 0.1'"
expect "compare counts unsolved steps" 0 "3" sh -c "'$program' compare $(echo $contest) --solver cg,hybrid --csv |
    awk -F, 'NR == 1 { header = \$10 } END { if (header == \"unsolved_steps\") print \$10 }'"
expect "iterations of the first step are no preparation" 0 "good" sh -c "'$program' compare '$root/scenes/flag.json' \
    --set solver.step=projective --set solver.outer_iterations=50 --set bodies.flag.surface.grid.vertices=[25,17] --steps 4 --rounds 2 \
    --solver cg,hybrid --csv | awk -F, '\$1 == \"cg\" && \$2 < 0.4 * \$3 { print \"good\" }'"
expect "compare needs two" 2 "two solvers or more" "$program" compare $contest --solver cg
expect "compare of a solver that does not fit" 2 "does not fit" "$program" compare $contest --solver cg,dual
expect "compare in no steps" 2 "from 1 to" "$program" compare $contest --solver cg,hybrid --steps 0
for option in -s -n; do # symbolic and hard links
    plant "$dir/planted$option" $option
    expect "links ($option) at the names of files" 0 "" "$program" run "$scene" -o "$dir/planted$option" --time 0.02 --quiet
    expect "their target is untouched ($option)" 0 "mine" sh -c "test \$(wc -c <'$dir/target') = 5 && cat '$dir/target'"
    expect "the report is a file ($option)" 0 '"state_hash"' sh -c "test ! -L '$dir/planted$option/report.json' && cat '$dir/planted$option/report.json'"
    for name in metrics.csv lock; do
        rm -f "$dir/planted$option/metrics.csv" "$dir/planted$option/lock"
        ln $option "$dir/target" "$dir/planted$option/$name"
        expect "link ($option) at $name" 2 "$name: expected a regular file" "$program" run "$scene" -o "$dir/planted$option" --time 0.02
        expect "its target is untouched ($option, $name)" 0 "mine" sh -c "test \$(wc -c <'$dir/target') = 5 && cat '$dir/target'"
    done
done
ln -sf "$dir/target" "$dir/out/replay.html"
expect "link at the page of a replay" 0 "frames" "$program" replay "$dir/out"
expect "the page replaces the link" 0 "mine" sh -c "test ! -L '$dir/out/replay.html' && cat '$dir/target'"
cp "$scene" "$dir/precious.json"
expect "a report is no scene" 2 "--report: expected a new file, found the scene" \
    "$program" run "$dir/precious.json" --report "$dir/out/../precious.json" -o "$dir/out" --time 0.01
expect "the scene is still there" 0 "" cmp "$scene" "$dir/precious.json"
expect "a page is no film" 2 "expected a file ending with .html; \`projdyn render\` makes pictures and films" \
    "$program" replay "$dir/out" -o "$dir/film.mp4"
expect "a page to standard output" 0 "</html>" sh -c "'$program' replay '$dir/out' -o /dev/stdout | cat"
expect "links to open descriptors are written through" 0 '"state_hash"' sh -c \
    "'$program' run '$scene' -o '$dir/through' --time 0.02 --quiet --report /dev/stdout | cat"
expect "closed standard error" 0 "written to" sh -c "'$program' run '$scene' -o '$dir/closed' --time 0.06 2>&-"
expect "progress is in no file" 1 "" grep -r "wall time" "$dir/closed"
expect "closed standard output" 1 "standard output" sh -c "'$program' list >&-"
expect "replay of nothing" 2 "nothing-here" "$program" replay "$dir/nothing-here"
expect "same bits for one thread and two" 0 "same" sh -c "
    for n in 1 2; do '$program' run '$scene' -o '$dir/t'\$n --time 0.1 --threads \$n --quiet; done
    test \"\$(grep state_hash '$dir/t1/report.json')\" = \"\$(grep state_hash '$dir/t2/report.json')\" && echo same"
for shipped in "$root"/scenes/*.json; do
    expect "threads do not change $(basename "$shipped")" 0 "same" sh -c "
        for n in 1 2; do '$program' run '$shipped' -o '$dir/t'\$n --time 0.008 --threads \$n --no-frames --quiet || exit 1; done
        test \"\$(grep state_hash '$dir/t1/report.json')\" = \"\$(grep state_hash '$dir/t2/report.json')\" && echo same"
done
truncate -s 100 "$dir/out/water_000001.vtk"
expect "replay of a broken frame" 2 "water_000001.vtk" "$program" replay "$dir/out"

cat >"$dir/fall.json" <<EOF
{"duration": 9, "frame_interval": 9, "time_step": {"fixed": 1}, "gravity": [0, -1e6, 0],
 "bodies": [{"name": "rain", "constraints": [{"type": "fluid"}],
   "particles": {"radius": 0.01, "fill": [{"box": {"minimum": [0, 0, 0], "maximum": [0.1, 0.1, 0.1]}}]}}]}
EOF
expect "step that fails" 1 "point 0 is at" "$program" run "$dir/fall.json" -o "$dir/fall"
expect "failure is reported" 0 '"failed": "step' cat "$dir/fall/report.json"
cat >"$dir/jet.json" <<EOF
{"duration": 0.3, "frame_interval": 0.1, "time_step": {"fixed": 0.01}, "gravity": [0, 0, 0],
 "bodies": [{"name": "jet", "particles": {"radius": 0.05, "inlets":
   [{"rectangle": {"center": [0, 0, 0], "size": [0.3, 0.2]}, "direction": [1, 0, 0], "speed": 1, "start": 0.05}]}}],
 "outlets": [{"box": {"minimum": [0.14, -1, -1], "maximum": [9, 1, 1]}}]}
EOF
expect "capacity for a jet" 0 "0 particles of radius 0.05 m, capacity for 24 more" "$program" check "$dir/jet.json"
expect "estimate with an inlet" 0 "times as many particles by inlets" "$program" check "$root/scenes/honey.json"
expect "jet" 0 "unconstrained" "$program" run "$dir/jet.json" -o "$dir/jet" --ply --quiet
for frame in 0:0 1:12 2:12 3:12; do # passing the opening at 0.05, 0.15, ... s, leaving 0.14 s later
    expect "points of the jet, frame $frame" 0 "POINTS ${frame#*:} float" \
        grep -a POINTS "$dir/jet/jet_00000${frame%:*}.vtk"
    expect "vertices of the jet, frame $frame" 0 "element vertex ${frame#*:}" \
        grep -a "element vertex" "$dir/jet/jet_00000${frame%:*}.ply"
done
expect "the jet's particles" 0 '"peak": 15' cat "$dir/jet/report.json"
expect "emitted" 0 '"emitted": 24' cat "$dir/jet/report.json"
expect "removed" 0 '"removed": 12' cat "$dir/jet/report.json"
expect "replay of a jet" 0 "4 frames" "$program" replay "$dir/jet"
expect "its particles come and go" 0 '"points":[0,12,12,12]' cat "$dir/jet/replay.html"
expect "nothing yet" 0 "ends before the second frame" "$program" run "$dir/jet.json" -o "$dir/jet" --time 0.04 --quiet
expect "replay of nothing yet" 2 "at least one particle in some frame" "$program" replay "$dir/jet"
"$program" run "$scene" -o "$dir/busy" --time 100 --quiet 2>"$dir/busy_said" &
pid=$!
for _ in $(seq 100); do
    [ "$(cat "$dir/busy/metrics.csv" 2>/dev/null | wc -l)" -gt 2 ] && break
    sleep 0.1
done
expect "two runs in one directory" 2 "another run writes to this directory: process $pid" "$program" run "$scene" -o "$dir/busy" --time 0.02
expect "resume of a run that goes on" 2 "process $pid" "$program" run --resume "$dir/busy" --time 0.02
kill -KILL $pid
wait $pid 2>/dev/null
: >"$dir/busy/state.pdyn.0123abcd.tmp" # as a killed run leaves it
expect "the lock of a killed run is gone" 0 "this run replaces one in $dir/busy that had not ended" "$program" run "$scene" -o "$dir/busy" --time 0.02 --quiet
expect "and its temporary files" 0 "all whole" whole_frames "$dir/busy"
for signal in INT TERM USR1 HUP; do
    stop_run "$dir/stop$signal" $signal --set frame_interval=0.1
    expect "$signal" 0 "130" echo $ended
    expect "$signal is said" 0 "interrupted at" cat "$dir/stopped"
    expect "$signal is reported" 0 '"interrupted": true' cat "$dir/stop$signal/report.json"
    expect "frames after $signal" 0 "all whole" whole_frames "$dir/stop$signal"
done
expect "the frame is finished after Ctrl-C" 0 "ends at a frame" ends_at_frame "$dir/stopINT"
for signal in TERM USR1 HUP; do
    stop_run "$dir/now$signal" $signal --set frame_interval=50
    expect "$signal waits for no frame" 1 "" grep _000001 "$dir/now$signal/water.vtk.series"
done
expect "--time above the longest scene" 2 '--time: found "1e99", expected seconds above 0, at most 1000000' \
    "$program" run "$scene" --time 1e99
expect "--wall-time that is no time" 2 "expected seconds above 0" "$program" run "$scene" --wall-time soon
stop_run "$dir/twice" "INT INT" --set frame_interval=50
expect "second interrupt" 0 "130" echo $ended
expect "second interrupt waits for no frame" 1 "" grep _000001 "$dir/twice/water.vtk.series"
expect "second interrupt is reported" 0 '"interrupted": true' cat "$dir/twice/report.json"

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]

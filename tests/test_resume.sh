#!/bin/sh
# Runs that are killed and resumed. Arguments: the program, a scene.
program=$(realpath "$1") scene=$(realpath "$2")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir" || exit 1
failed=0

check() { # NAME COMMAND...
    name=$1
    shift
    if "$@" >said 2>&1; then echo "ok $name"; else echo "not ok $name"; sed 's/^/    /' said; failed=1; fi
}
refuses() { # TEXT COMMAND...: bad input, with this text
    text=$1
    shift
    "$@" >refused 2>&1
    [ $? = 2 ] && grep -qF "$text" refused || { cat refused; false; }
}
hash_of() { grep state_hash "$1/report.json"; }
lacks() { ! grep -q "$1" "$2"; }
numbers_of() { cut -d, -f1-17 "$1/metrics.csv"; } # without times
same() { [ "$(hash_of whole)" = "$(hash_of "$1")" ] && [ "$(numbers_of whole)" = "$(numbers_of "$1")" ]; }
same_frames() {
    for file in whole/*.vtk whole/*.vtk.series whole/solids/*; do cmp "$file" "$1/${file#whole/}" || return 1; done
    [ "$(cd whole && ls -R)" = "$(cd "$1" && ls -R)" ]
}
kill_often() { # DIR TIMES: kills a run, later and later, and lets it go on
    "$program" run "$scene" --quiet --threads 1 --save 2 -o "$1" &
    pid=$!
    for _ in $(seq 100); do # from its first frame on
        [ -e "$1/state.pdyn" ] && break
        sleep 0.1
    done
    for k in $(seq "$2"); do
        sleep "0.$k"
        kill -9 $pid 2>/dev/null
        wait $pid 2>/dev/null
        "$program" run --resume "$1" --quiet --threads 1 --save 2 &
        pid=$!
    done
    wait $pid
}

"$program" run "$scene" --quiet --threads 1 -o whole >/dev/null || exit 1
check "killed runs go on" kill_often killed 5
check "the same bits" same killed
check "the same frames" same_frames killed

stops_often() { # DIR: a run that stops after every step, until its end
    "$program" run "$scene" --quiet --threads 1 --save 0 -o "$1" --wall-time 1e-9
    code=$? stops=0
    while [ $code = 130 ]; do
        stops=$((stops + 1))
        "$program" run --resume "$1" --quiet --threads 1 --save 0 --wall-time 1e-9 2>>continue
        code=$?
    done
    [ $code = 0 ] && [ $((stops + 2)) = "$(wc -l <whole/metrics.csv)" ]
}
check "a run that stops after every step" stops_often stopped
check "says how to continue" grep -q "to continue: projdyn run --resume stopped" continue
check "the same bits after its stops" same stopped
check "the same frames after its stops" same_frames stopped

replaces() { # a new run in the directory of one that was interrupted, and another one
    "$program" run "$scene" --quiet --threads 1 -o "a run" --wall-time 1e-9
    "$program" run "$scene" --quiet --threads 1 -o "a run" --time 0.02 2>first
    "$program" run "$scene" --quiet --threads 1 -o "a run" --time 0.02 2>second
    grep "replaces one in a run that had not ended and could have been continued by: projdyn run --resume 'a run'\$" first && ! grep replaces second
}
check "says that an interrupted run is replaced, once" replaces
mkdir program && cp "a run/state.pdyn" program
check "a run of a program" refuses "a program wrote this state" "$program" run --resume program

"$program" run "$scene" --quiet --threads 1 -o longer --time 0.1 >/dev/null
check "a longer end" "$program" run --resume longer --quiet --threads 1 --time 0.2
check "the same bits after a longer end" same longer
check "a run without frames" "$program" run "$scene" --quiet --threads 1 -o bare --time 0.1 --no-frames
check "has none after its resume" "$program" run --resume bare --quiet --threads 1 --time 0.2
check "not one" [ "$(find bare -name '*_0*.vtk')" = "" ]
check "the same bits without frames" same bare
check "nothing left to do" "$program" run --resume longer --quiet
check "the same report then" same longer
early() { "$program" run --resume longer --quiet --time 0.05 2>&1 | grep "no step to take: the run has reached 0.2 s, and is to end at 0.05 s"; }
check "says that the end is before the state" early

# An inlet keeps room for what enters until the end of the scene, or of a run that is longer.
cat >jet.json <<EOF
{"duration": 0.3, "frame_interval": 0.1, "time_step": {"fixed": 0.01}, "gravity": [0, 0, 0],
 "bodies": [{"name": "jet", "particles": {"radius": 0.05, "inlets":
   [{"rectangle": {"center": [0, 0, 0], "size": [0.3, 0.2]}, "direction": [1, 0, 0], "speed": 1}]}}]}
EOF
"$program" run jet.json --quiet -o part --time 0.05
check "an inlet up to the end of the scene" "$program" run --resume part --quiet --time 0.3
check "that is where it stops" "$program" run jet.json --quiet -o all
check "with the same bits" [ "$(hash_of part)" = "$(hash_of all)" ]
check "not beyond it" refuses "budget" "$program" run --resume part --time 0.6
"$program" run jet.json --quiet -o long --time 0.4
check "a run longer than its scene" "$program" run --resume long --quiet --time 0.35

cp "$scene" moved.json
"$program" run moved.json -o moved --quiet --threads 1 --time 0.04
rm moved.json
check "a scene that was moved" refuses 'moved.json: No such file or directory; if it was moved, write its present path here' \
    "$program" run --resume moved
check "no run" refuses "no run to continue" "$program" run --resume nowhere
check "not beside a scene" refuses "taken from the resumed run" "$program" run --resume whole "$scene"
"$program" run "$scene" --quiet -o shorter --time 0.04 >/dev/null
check "not as a scene" refuses "to continue it: projdyn run --resume whole; to look at it: projdyn replay whole" \
    "$program" run whole
check "nor any folder" refuses "a regular file, found a folder" "$program" run whole/solids
check "not with another scene" refuses 'with other values of "gravity" in its scene; only the duration, colours, step lengths' \
    "$program" run --resume shorter --set gravity=[0,0,0]
check "nor another solver" refuses 'other values of "solver" in its scene' "$program" run --resume shorter --set solver.type=dual
check "nor other frames" refuses 'other values of "frame_interval" in its scene' "$program" run --resume shorter --set frame_interval=0.05
check "empty lists are those of a scene without them" "$program" run --resume shorter --quiet --time 0.04 --set outlets=[] --set probes=[]
check "not with an unknown key" refuses 'did you mean "solver"' "$program" run --resume shorter --set solvr.tolerance=1
check "with other iterations" "$program" run --resume shorter --quiet --time 0.08 --set solver.outer_iterations=1 \
    --set solver.tolerance=1e-9 --set time_step.maximum=0.001
check "with shorter steps" awk -F, 'NR > 1 && $1 > 0.041 && ($2 > 0.00101 || $3 != 1) {bad = 1} END {exit bad}' shorter/metrics.csv
check "they are kept" grep -q "solver.outer_iterations=1" shorter/run.json
check "but not the time" lacks 0.08 shorter/run.json
check "and go on without" "$program" run --resume shorter --quiet --time 0.1
check "with the same steps" awk -F, 'NR > 1 && $1 > 0.041 && $3 != 1 {bad = 1} END {exit bad}' shorter/metrics.csv
cp -r whole cut && truncate -s 5000 cut/state.pdyn
check "a cut state" refuses "cut/state.pdyn: the state is damaged" "$program" run --resume cut
cp -r whole short && truncate -s 100 short/metrics.csv
check "cut metrics" refuses "short/metrics.csv: the file is shorter" "$program" run --resume short
cp "$scene" scene.json
"$program" run scene.json --quiet -o other --time 0.04 >/dev/null
sed 's/0.53/0.55/' scene.json >changed.json && mv changed.json scene.json
check "another scene" refuses 'the state was saved with other values of "bodies" in its scene' "$program" run --resume other
rm other/state.pdyn
check "nothing saved" refuses "state.pdyn: cannot open" "$program" run --resume other
exit $failed

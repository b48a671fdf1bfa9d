#!/bin/sh
# Sweeps that are killed, and go on; runs that fail; commands for others to run. Arguments: the program, a scene.
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
ends() { # CODE TEXT COMMAND...
    code=$1 text=$2
    shift 2
    "$@" >ended 2>&1
    [ $? = "$code" ] && grep -qF -e "$text" ended || { cat ended; false; }
}
eight="--set duration=0.04 --set solver.tolerance=0.1,0.2,0.3,0.4 --set solver.outer_iterations=1,2" # runs
sweep() { # DIRECTORY OPTIONS...
    out=$1
    shift
    "$program" sweep "$scene" $eight -o "$out" "$@"
}
hashes() { cut -d, -f2,3,4 "$1/sweep.csv" >"$1.csv"; rev <"$1/sweep.csv" | cut -d, -f1,2 >>"$1.csv"; }
same() { hashes whole; hashes "$1"; cmp whole.csv "$1.csv"; }

check "a sweep" sweep whole
check "eight rows" test "$(grep -c ',good,' whole/sweep.csv)" = 8
check "as run by itself" sh -c "'$program' run '$scene' --set duration=0.04 --set solver.tolerance=0.3 \
    --set solver.outer_iterations=2 -o alone --threads 1 --quiet --no-frames &&
    grep '^0.04,0.3,2,good' whole/sweep.csv | grep \$(sed -n 's/.*\"state_hash\": \"\\(.*\\)\".*/\\1/p' alone/report.json)"
check "no frames" sh -c "! ls whole/*/sheet_*.vtk"

# Killed after some runs: what ended is told by the first or the second, never by both, and nothing is left running.
kill_in_the_middle() {
    "$program" sweep "$scene" $eight -o killed --jobs 2 >first &
    pid=$!
    for _ in $(seq 600); do
        [ "$(wc -l <first)" -ge 3 ] && break
        sleep 0.05
    done
    kill -9 $pid
    wait $pid 2>/dev/null
    sweep killed >second
    grep -h '^[0-9]*/8 ' first second | sed 's/^[^:]*://' | sort >told
    [ "$(grep -c '^[0-9]*/8 ' first)" -ge 3 ] && [ "$(wc -l <told)" = 8 ] && [ "$(uniq told | wc -l)" = 8 ] &&
        ! ls -d killed/*.part
}
check "killed and started again: no run twice, none lost" kill_in_the_middle
check "the same table" same killed
sweep killed >third
check "nothing left to do" sh -c '! grep ^[0-9]*/8 third'

two_at_a_time() {
    sweep shared --jobs 1 >first &
    sweep shared --jobs 1 >second
    wait $!
    grep -h '^[0-9]*/8 ' first second | sed 's/^[^:]*://' | sort >told
    [ "$(wc -l <told)" = 8 ] && [ "$(uniq told | wc -l)" = 8 ] && same shared
}
check "two at a time share the runs" two_at_a_time

sweep printed --print >commands
check "eight commands" test "$(wc -l <commands)" = 8
check "nothing is run" test ! -e printed
check "one command by itself" sh -c "sed -n 3p commands | sh"
check "missing runs are said" ends 1 "7 of 8 runs failed or are missing" sweep printed --collect
check "the others by themselves" sh -c "sh commands >/dev/null"
check "gathered" sweep printed --collect
check "the same table from commands" same printed
if parallel --version 2>/dev/null | grep -q GNU; then
    sweep parallel --print >commands
    check "GNU parallel" sh -c "parallel -j 2 <commands >/dev/null 2>&1"
    check "gathered from GNU parallel" sweep parallel --collect
    check "the same table from GNU parallel" same parallel
else
    echo "skipped: GNU parallel is not installed"
fi

bad() { "$program" sweep "$scene" --set duration=0.01,-1 --set gravity='[0, -1, 0],[0,-9.81,0]' -o bad; }
check "a run that fails" ends 1 "2 of 4 runs failed" bad
check "is recorded with its error" grep -q '^-1,"\[0, -1, 0\]",bad input,"--set duration=-1: duration: expected' bad/sweep.csv
check "the others are good" test "$(grep -c ',good,' bad/sweep.csv)" = 2

# A changed file makes other runs: a mesh of the scene, and one that a setting names.
mkdir files
tetrahedron() { # SIZE
    printf 'v 0 0 0\nv %s 0 0\nv 0 %s 0\nv 0 0 %s\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' "$1" "$1" "$1"
}
tetrahedron 1 >files/one.obj
tetrahedron 2 >files/two.obj
cat >files/scene.json <<'SCENE'
{"duration": 0.01, "frame_interval": 0.01, "bodies": [{"name": "body", "rigid": {"mesh": "one.obj", "density": 500}}]}
SCENE
meshes() { "$program" sweep files/scene.json --set bodies.body.rigid.mesh=one.obj,two.obj -o meshes; }
again() { meshes | grep -c '^[0-9]*/2 '; }
one() { "$program" sweep files/scene.json --set gravity='[0,-1,0]' -o one | grep -c '^[0-9]*/1 '; }
check "meshes of settings" test "$(again)" = 2
check "the same meshes" test "$(again)" = 0
tetrahedron 3 >files/two.obj
check "one has changed" test "$(again)" = 1
check "a mesh of the scene" test "$(one)" = 1
tetrahedron 4 >files/one.obj
check "has changed" test "$(one)" = 1
check "and not again" test "$(one)" = 0
printf '4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n' >files/tets.node
printf '1 4 0\n0 0 1 2 3\n' >files/tets.ele
cat >files/scene.json <<'SCENE'
{"duration": 0.01, "frame_interval": 0.01, "bodies": [{"name": "body", "volume": {"mesh": "tets.node", "density": 500}}]}
SCENE
check "a mesh of two files" test "$(one)" = 1
printf '1 4 0\n0 1 2 0 3\n' >files/tets.ele
check "the second one has changed" test "$(one)" = 1
check "and neither again" test "$(one)" = 0

# --time is the duration of all runs.
brief() { "$program" sweep "$scene" --time "$1" --set solver.tolerance=0.1,0.2 -o brief; }
check "a time" brief 0.015
check "is that of all runs" test "$(grep -c '^0.015,.*,good,' brief/sweep.csv)" = 2
check "a wrong time" ends 2 '--time: found "0.01,1", expected seconds above 0' brief 0.01,1
check "a time above the longest scene" ends 2 '--time: found "1e99", expected seconds above 0, at most 1000000' brief 1e99

# Probes: mean, maximum and impulse, also where the runs have different probes.
cat >probes.json <<EOF
{"duration": 0.02, "frame_interval": 0.01, "time_step": {"fixed": 0.005}, "probes": [],
 "bodies": [{"name": "sheet", "surface": {"grid": {"size": [1, 1], "vertices": [5, 5]}, "area_density": 0.4},
   "constraints": [{"type": "spring", "stretching_stiffness": 1000}, {"type": "pin", "vertices": {"border": true}}]}]}
EOF
cell() { # COLUMN ROW: of probed/sweep.csv, whose first cells are quoted
    python3 -c 'import csv, sys; print(list(csv.DictReader(open("probed/sweep.csv")))[int(sys.argv[2])][sys.argv[1]])' "$1" "$2"
}
probes_agree() { # the statistics of a run by itself
    "$program" run probes.json --set probes='[{"name": "hold", "pins": "sheet"}]' -o probe --threads 1 --quiet --no-frames
    awk -F, 'NR > 1 {sum += $3; if (NR == 2 || $3 > max) max = $3}
        END {printf "%.6g %.6g %.6g\n", sum / 4, max, 0.005 * sum}' probe/probes.csv >expected
    printf '%.6g %.6g %.6g\n' "$(cell mean_hold.force_y_N 0)" "$(cell max_hold.force_y_N 0)" \
        "$(cell impulse_hold.force_y_Ns 0)" | diff expected -
}
check "runs with different probes" "$program" sweep probes.json -o probed \
    --set probes='[{"name": "hold", "pins": "sheet"}],[{"name": "all", "body": "sheet"}]'
check "mean, maximum and impulse of a probe" probes_agree
memory_agrees() { # with the report of the run
    python3 -c 'import json, sys; print("%.9g" % (json.load(open(sys.argv[1]))["peak_memory_bytes"] / 1e6))' \
        "probed/$(cell directory 0)/report.json" >expected
    cell peak_memory_MB 0 | diff expected -
}
check "memory" memory_agrees
check "impulse of a moment" test -n "$(cell impulse_all.moment_x_Nms 1)"
check "an empty cell without the probe" test -z "$(cell mean_hold.force_y_N 1)$(cell impulse_all.force_y_Ns 0)"

# A scene that cannot be loaded, with any values, ends the sweep before its first run.
sed 's/"spring"/"sprung"/' probes.json >wrong.json
check "a wrong scene" ends 2 'wrong.json' "$program" sweep wrong.json --set duration=0.01,0.02 -o none
check "is not run" test ! -e none
sed 's/"duration": 0.02/"duration": null/' probes.json >template.json
check "a wrong path" ends 2 'did you mean "tolerance"?' "$program" sweep probes.json --set solver.tolerence=0.1,0.2 -o none
check "is not run, either" test ! -e none
check "a scene that needs the values" "$program" sweep template.json --set duration=0.01,0.02 -o template

check "no values" ends 2 "PATH=VALUE" "$program" sweep "$scene" --set duration
check "an empty value" ends 2 "found an empty value" "$program" sweep "$scene" --set duration=1,
check "a path twice" ends 2 "given twice" "$program" sweep "$scene" --set duration=1 --set duration=2
check "no scene" ends 2 "nowhere.json" "$program" sweep nowhere.json --set duration=1
check "no setting" ends 2 "at least one --set" "$program" sweep "$scene"
check "a point beyond" ends 2 "expected at most 7" sweep whole --point 8
check "jobs that are no number" ends 2 "from 1 to 1024" sweep whole --jobs two
exit $failed

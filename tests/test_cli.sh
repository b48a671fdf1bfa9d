#!/bin/sh
# Exit codes and messages of the command line. Arguments: the program, the source folder.
program=$1 root=$2
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
scene=$root/tests/pour.json
passed=0 failed=0

# expect NAME CODE TEXT COMMAND...: the exit code, and a text in what is printed
expect() {
    name=$1 code=$2 text=$3
    shift 3
    "$@" >"$dir/said" 2>&1
    got=$?
    if [ "$got" = "$code" ] && grep -qF -e "$text" "$dir/said"; then
        passed=$((passed + 1)) && echo "ok $name"
    else
        failed=$((failed + 1)) && echo "not ok $name: exit $got (expected $code), expected to read '$text' in:"
        sed 's/^/    /' "$dir/said"
    fi
}

expect "no command" 2 "Usage: projdyn COMMAND" "$program"
expect "help" 0 "replay" "$program" --help
expect "version" 0 "projdyn 0." "$program" --version
expect "unknown command" 2 'did you mean "check"' "$program" chekc
for command in run check list replay; do
    expect "$command --help" 0 "Usage: projdyn $command" "$program" $command --help
done
expect "run without a scene" 2 "expected one scene" "$program" run
expect "missing scene" 2 "nowhere.json" "$program" run "$dir/nowhere.json" -o "$dir/out"
expect "unknown option" 2 "frobnicate" "$program" run "$scene" --frobnicate
expect "threads that are no number" 2 "from 1 to 1024" "$program" run "$scene" --threads two
expect "negative time" 2 "seconds above 0" "$program" run "$scene" --time -1
expect "override without a value" 2 "--set solver" "$program" run "$scene" --set solver -o "$dir/out"
expect "unknown solver" 2 "cholesky" "$program" check "$scene" --set solver.type=choleski
expect "output folder is a file" 2 "$scene" "$program" run "$scene" -o "$scene/out"
expect "check" 0 "solver cg" "$program" check "$scene"
expect "list" 0 "bending" "$program" list
expect "list one" 0 "N/m" "$program" list spring
expect "list unknown" 2 "spring" "$program" list sprin
expect "run" 0 "projdyn replay" "$program" run "$scene" -o "$dir/out" --time 0.06
expect "plain progress" 0 "of wall time" "$program" run "$scene" -o "$dir/out" --time 0.06
expect "the report is there" 0 '"state_hash"' cat "$dir/out/report.json"
expect "full disk" 1 "/dev/full" "$program" run "$scene" -o "$dir/out" --time 0.02 --report /dev/full
expect "replay of nothing" 2 "nothing-here" "$program" replay "$dir/nothing-here"
expect "same bits for one thread and two" 0 "same" sh -c "
    for n in 1 2; do '$program' run '$scene' -o '$dir/t'\$n --time 0.1 --threads \$n --quiet; done
    test \"\$(grep state_hash '$dir/t1/report.json')\" = \"\$(grep state_hash '$dir/t2/report.json')\" && echo same"
truncate -s 100 "$dir/out/water_000001.vtk"
expect "replay of a broken frame" 2 "water_000001.vtk" "$program" replay "$dir/out"

"$program" run "$scene" -o "$dir/stop" --time 100 --quiet 2>"$dir/stopped" &
pid=$!
for _ in 1 2 3 4 5 6 7 8 9 10; do [ -f "$dir/stop/water_000001.vtk" ] || sleep 0.5; done
kill -INT $pid
wait $pid
expect "interrupt" 0 "130" echo $?
expect "interrupt is said" 0 "interrupted at" cat "$dir/stopped"
expect "interrupt is reported" 0 '"interrupted": true' cat "$dir/stop/report.json"

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]

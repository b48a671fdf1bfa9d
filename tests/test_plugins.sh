#!/bin/sh
# Plug-ins from the command line. Arguments: the program, the source folder, the template as a
# shared object, one of another abi, one that is no plug-in, one that is wrong, one that crashes,
# solver cg, one whose table of parameters has no end, one that makes a name when it is loaded.
program=$(realpath "$1") root=$(realpath "$2") good=$(realpath "$3") old=$(realpath "$4") empty=$(realpath "$5") wrong=$(realpath "$6") crash=$(realpath "$7") cg=$(realpath "$8") endless=$(realpath "$9") named=$(realpath "${10}")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
failed=0
cd "$dir" || exit 1

# expect NAME CODE TEXT COMMAND...: the exit code, and a text in what is printed
expect() {
    name=$1 code=$2 text=$3
    shift 3
    "$@" >"$dir/said" 2>&1
    got=$?
    if [ "$got" = "$code" ] && grep -qF -e "$text" "$dir/said"; then
        echo "ok $name"
    else
        failed=$((failed + 1))
        echo "not ok $name: exit $got (expected $code), expected to read '$text' in:"
        sed 's/^/    /' "$dir/said"
    fi
}

grep -v '"plugins"' "$root/examples/plugin/template.json" >sheet.json
expect "without its plug-in" 2 'unknown constraint "floor"' "$program" check sheet.json
expect "with its plug-in" 0 "constraint floor on sheet: 625 elements" "$program" check sheet.json --plugin "$good"
expect "list" 0 "floor" "$program" list --plugin "$good"
expect "list one" 0 "where the floor is" "$program" list floor --plugin "$good"
expect "twice the same" 0 "floor" "$program" list --plugin "$good" --plugin "$good"
expect "missing file" 2 "nowhere.so: the plug-in cannot be loaded" "$program" list --plugin nowhere.so
expect "no shared object" 2 "sheet.json: the plug-in cannot be loaded" "$program" list --plugin sheet.json
echo 'int x;' >roof.c
expect "source of a plug-in" 2 "compile it first: cc -shared" "$program" list --plugin roof.c
expect "another abi" 2 "expected abi" "$program" list --plugin "$old"
expect "no symbol" 2 "not a plug-in" "$program" list --plugin "$empty"
expect "a table without its end" 2 'type "endless": its table of parameters has no end: expected {0}' "$program" check --conformance "$endless"
expect "a name made at run time" 0 "pulls to the origin" "$program" list --plugin "$named"
cp "$good" floor.so && cp "$good" again.so
expect "file of the current folder" 0 "floor" "$program" list --plugin floor.so
expect "a name that is taken" 2 'the name "floor" is taken' "$program" list --plugin floor.so --plugin again.so

# the contract; the crash is in a process of its own
expect "conformance" 0 "no faults" "$program" check --conformance "$good"
expect "conformance of a wrong one" 1 "fault: floor (surface): project is no projection" "$program" check --conformance "$wrong"
expect "conformance of one that crashes" 1 "one that reads neighbour lists PDYN_NEIGHBOURS" "$program" check --conformance "$crash"
expect "conformance and a scene" 2 "expected no scene file" "$program" check --conformance "$good" sheet.json
expect "conformance and --set" 2 "expected no scene file, --set or" "$program" check --conformance "$good" --set a=1
expect "conformance of no plug-in" 2 "not a plug-in" "$program" check --conformance "$empty"

# in the scene, found from its folder
mkdir -p scenes/lib && cp "$good" scenes/lib/floor.so
sed '2s|^|  "plugins": ["lib/floor.so"],\n|' sheet.json >scenes/sheet.json
expect "in the scene" 0 "constraint floor" "$program" check scenes/sheet.json --allow-plugins
expect "in the scene, allowed by the environment" 0 "constraint floor" env PROJDYN_ALLOW_PLUGINS=1 "$program" check scenes/sheet.json
for command in check run sweep compare trade; do
    case $command in
        sweep) options="--set duration=0.01" ;;
        compare) options="--solver cg,hybrid --steps 1 --rounds 1" ;;
        *) options="" ;;
    esac
    expect "$command without permission" 2 "scenes/sheet.json:2:14: plugins: plug-ins run code and are loaded from a scene only with permission: the option --allow-plugins" \
        "$program" $command scenes/sheet.json $options
    expect "$command has the option" 0 "--allow-plugins" "$program" $command --help
done
expect "without permission nothing is written" 0 "nothing" sh -c "test ! -e out && echo nothing"
expect "compare with permission" 0 "hybrid" "$program" compare scenes/sheet.json --solver cg,hybrid --steps 1 --rounds 1 --allow-plugins
expect "sweep hands the permission on" 0 "1 of 1 runs are good" "$program" sweep scenes/sheet.json -o swept --set duration=0.01 --allow-plugins
expect "sweep prints the permission" 0 "--allow-plugins" "$program" sweep scenes/sheet.json --set duration=0.01 --print --allow-plugins
expect "bad parameter" 2 "expected a number from 0 to" "$program" check scenes/sheet.json --allow-plugins --set bodies.sheet.constraints.floor.stiffness=-1
sed 's|lib/floor.so|lib/roof.so|' scenes/sheet.json >scenes/roof.json
expect "missing in the scene" 2 "scenes/roof.json:2:15: plugins[0]: scenes/lib/roof.so: the plug-in cannot be loaded" "$program" check scenes/roof.json --allow-plugins

# the same bits with any number of threads, and after an interruption
run="$program run sheet.json --plugin floor.so --quiet --set time_step.fixed=0.01 --set frame_interval=0.05
    --set bodies.sheet.surface.grid.vertices=[9,9]"
for solver in cg cholesky hybrid; do
    $run --time 0.3 -o one --threads 1 --set solver.type=$solver && $run --time 0.3 -o three --threads 3 --set solver.type=$solver
    expect "threads, $solver" 0 "state_hash" sh -c "a=\$(grep state_hash one/report.json) && [ \"\$a\" = \"\$(grep state_hash three/report.json)\" ] && echo \"\$a\""
done
$run --time 0.1 -o part --set solver.type=hybrid
expect "resume without permission" 2 "part/run.json: plugins: $dir/floor.so runs code and is loaded only with --allow-plugins" "$program" run --resume part --time 0.3 --quiet
"$program" run --resume part --time 0.3 --quiet --allow-plugins
expect "the same bits when resumed" 0 "state_hash" sh -c "a=\$(grep state_hash part/report.json) && [ \"\$a\" = \"\$(grep state_hash one/report.json)\" ] && echo \"\$a\""

# a built-in solver from its sources alone: fluid on a sheet, the same iterations and the same bits
run="$program run $root/scenes/curtain.json --plugin $cg --quiet --time 0.05 --no-frames"
$run -o built-in --set solver.type=cg && $run -o copied --set solver.type=copied_cg
expect "cg outside of the library" 0 "state_hash" sh -c "a=\$(grep -A3 -e state_hash -e linear_iterations built-in/report.json) && [ \"\$a\" = \"\$(grep -A3 -e state_hash -e linear_iterations copied/report.json)\" ] && echo \"\$a\""
exit $((failed > 0))

#!/bin/sh
# CG or Cholesky? Sheets of n x n vertices whose matrix is constant, over stiffness K h^2/m and the
# tolerance of the linear solve; writes bench/cg_or_cholesky.csv and the tables of
# docs/guide/cg-or-cholesky.md. Takes about a quarter of an hour; `quick`: less, into out/ alone.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh
out=out/cg-or-cholesky
mkdir -p "$out"
case ${1:-} in
quick) sizes="17 33" numbers="1e0 1e4" docs=$out bench=$out ;;
"") sizes="33 65 129 257" numbers="1e-1 1e0 1e1 1e2 1e3 1e4 1e5 1e6" docs=docs/guide bench=bench ;;
*) echo "usage: scripts/cg_or_cholesky.sh [quick]" >&2; exit 2 ;;
esac
step=0.01 # s
# K = number m / h^2 with m = 0.2 kg/m^2 / (n - 1)^2; bending B / d^2 = K / 1000, d = 1 m / (n - 1)
stiffness() { awk -v n="$1" -v x="$2" -v h=$step 'BEGIN { printf "%.9g", x * 0.2 / (n - 1) ^ 2 / h ^ 2 }'; }
bending() { awk -v n="$1" -v K="$2" 'BEGIN { printf "%.9g", 1e-3 * K / (n - 1) ^ 2 }'; }
measure() { # n, K h^2/m, linear tolerance: five steps of three iterations, three of them timed, cg first
    K=$(stiffness "$1" "$2") rounds=2
    [ "$1" -lt 200 ] || rounds=1
    build/app/projdyn compare scenes/hanging_cloth.json --set time_step.integrator=euler --solver cg,cholesky --csv --steps 5 --rounds $rounds \
        --set time_step.fixed=$step --set frame_interval=1 --set solver.step=projective --set solver.tolerance=0 \
        --set solver.outer_iterations=3 --set solver.linear_tolerance="$3" --set solver.linear_iterations=3000 \
        --set bodies.sheet.surface.grid.vertices="[$1, $1]" --set bodies.sheet.constraints.pin.vertices.vertices="[0, $(($1 - 1))]" \
        --set bodies.sheet.constraints.spring.stretching_stiffness="$K" \
        --set bodies.sheet.constraints.bending.bending_rigidity="$(bending "$1" "$K")" | sed "1d; s/^/$1,$2,$3,/"
}
csv=$bench/cg_or_cholesky.csv
{
    echo "n,number,linear_tolerance,solver,prepare_ms,ms_per_step,outer_iterations,linear_iterations,step_residual,memory_mb,difference,catches_up,unsolved_steps"
    for n in $sizes; do for number in $numbers; do for tolerance in 1e-2 1e-6; do measure "$n" "$number" "$tolerance"; done; done; done
} >"$out/measured.csv"
[ "$out/measured.csv" -ef "$csv" ] || cp "$out/measured.csv" "$csv"
awk -v tolerance=1e-2 -f scripts/cg_or_cholesky.awk "$csv" >"$out/loose.md"
awk -v tolerance=1e-6 -f scripts/cg_or_cholesky.awk "$csv" >"$out/tight.md"
awk -F, 'NR == 1 { print "| n | prepare, ms: cg / cholesky | memory, MB |\n|---|---|---|" }
    $4 == "cg" { p = $5; m = $10 } $4 == "cholesky" && $1 != n { n = $1; printf "| %d | %.0f / %.0f | %.0f / %.0f |\n", n, p, $5, m, $10 }' \
    "$csv" >"$out/prepare.md"
scripts/fill_tables.sh "$out" docs/guide/cg-or-cholesky.md "$docs/cg-or-cholesky.md"

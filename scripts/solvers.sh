#!/bin/sh
# Measures the solvers of coupled scenes (scripts/solvers.py) in some 30 minutes and fills the tables
# of docs/results/solvers.md. `million`: with a million particles, too, which takes an hour and 4 GB.
# `quick`: short runs, written to out/solvers instead of docs/.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh
out=out/solvers docs=docs/results
seconds=0.3 shaken=0.8 sizes="6.1x0.035x0.05 6.1x0.035x0.08 2.87x0.035x0.05"
case ${1:-} in
quick) seconds=0.02 shaken=0.02 sizes=6.1x0x0.01 docs=$out ;;
million) sizes="$sizes 1.35x0.035x0.039" ;;
"") ;;
*) echo "usage: scripts/solvers.sh [quick|million]" >&2; exit 2 ;;
esac
mkdir -p "$out"
threads=1 next=2
while [ $next -le "$(nproc)" ]; do threads="$threads $next" next=$((2 * next)); done
export OMP_NUM_THREADS=1 # of a BLAS with threads: times are those of all threads
# shellcheck disable=SC2086
{
    scripts/solvers.py cost "$seconds" >"$out/cost.md"
    scripts/solvers.py sizes $sizes >"$out/sizes.md"
    scripts/solvers.py stiffness "$seconds" >"$out/stiffness.md"
    scripts/solvers.py shaken "$shaken" >"$out/shaken.md"
    scripts/solvers.py threads $threads >"$out/threads.md"
}
scripts/fill_tables.sh "$out" docs/results/solvers.md "$docs/solvers.md"

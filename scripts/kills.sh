#!/bin/sh
# A coupled run that is killed (-9) at random moments, again and again, and goes on each time; then one on a disk of 10 MB that
# gets full, and goes on where there is room. Both must end with the bits of a run that was never interrupted.
# Usage: kills.sh [KILLS [SEED]], 20 kills by default. Needs the right to mount for the second part (root, or user name spaces).
set -eu # shellcheck disable=SC2086
cd "$(dirname "$0")/.."
scripts/build.sh
program=$PWD/build/app/projdyn scene=$PWD/tests/pour.json kills=${1:-20} seed=${2:-1}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
options="--quiet --threads 1 --save 1"
start="run $scene --set time_step.maximum=0.0025 $options" # no spaces in these
hash_of() { sed -n 's/.*"state_hash": "\(.*\)".*/\1/p' "$1/report.json"; }
steps_of() { cut -d, -f1-17 "$1/metrics.csv"; } # without times
same() {
    [ "$(hash_of whole)" = "$(hash_of "$1")" ] && [ "$(steps_of whole)" = "$(steps_of "$1")" ] || return 1
    for file in whole/*.vtk whole/*.series; do cmp "$file" "$1/${file#whole/}" || return 1; done
}
begun=$(date +%s.%N)
"$program" $start -o whole
awk -v n="$kills" -v s="$seed" -v t="$(awk -v a="$begun" -v b="$(date +%s.%N)" 'BEGIN { print b - a }')" \
    'BEGIN { srand(s); for (k = 0; k < n; k++) print 0.02 + rand() * 3 * t / n }' >moments
"$program" $start -o killed &
pid=$!
done=0
while read -r moment; do
    sleep "$moment"
    kill -9 $pid 2>/dev/null && done=$((done + 1))
    wait $pid 2>/dev/null || true
    if [ -e killed/state.pdyn ]; then "$program" run --resume killed $options &
    else "$program" $start -o killed &
    fi
    pid=$!
done <moments
wait $pid
same killed
echo "$done kills at $kills moments: the same bits ($(hash_of killed))"

cat >fill.sh <<END
mount -t tmpfs -o size=10m none small
"$program" $start --set frame_interval=0.0005 -o small/out || code=\$?
cp -r small/out full
exit \${code:-0}
END
mkdir small
"$program" $start --set frame_interval=0.0005 -o whole
if ! unshare -rm sh -c 'mount -t tmpfs none small' 2>/dev/null; then
    echo "skipped: a full disk: mounting is not permitted"
    exit 0
fi
code=0
unshare -rm sh fill.sh 2>said || code=$?
echo "a full disk of 10 MB: exit code $code: $(tail -n 1 said)"
[ $code = 1 ] && grep -q "No space left" said
"$program" run --resume full $options
same full
echo "gone on with room: the same bits ($(hash_of full))"

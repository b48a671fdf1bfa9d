#!/bin/sh
# Runs the commands of the documents against an installed library: every ```sh block of README.md
# and docs/, one document after the other; then the indented `projdyn` commands, shortened; then
# doxygen for the reference. Checks first the form of the documents (check_documents.py), that the
# constraint of README.md builds and passes the conformance check, and that the guide explains
# every warning and lists every scene.
# Arguments: the build folder, the source folder.
set -eu
build=$(realpath "$1") root=$(realpath "$2")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
meson install -C "$build" --no-rebuild --quiet --destdir "$dir/prefix"
pc=$(find "$dir/prefix" -name projdyn.pc)
program=$(find "$dir/prefix" -type f -name projdyn -perm -u+x)
export PKG_CONFIG_SYSROOT_DIR="$dir/prefix" PKG_CONFIG_PATH="$(dirname "$pc")" PATH="$(dirname "$program"):$PATH"
mkdir "$dir/tree"
cp -r "$root/docs" "$root/README.md" "$root/examples" "$root/scenes" "$root/include" "$dir/tree"
cd "$dir/tree"

documents="README.md $(find docs -name '*.md' | LC_ALL=C sort)"

/usr/bin/python3 "$root/tests/check_documents.py" "$root" >said || { echo "not ok the form of documents:"; cat said; exit 1; }
echo "ok links, tables, lines"

# The guide explains every warning.
for code in $(sed -n 's/^ *X([A-Z_]*, "\([a-z-]*\)").*/\1/p' "$root/src/core/base/warnings.h"); do
    grep -q "^| .$code. |" docs/guide/troubleshooting.md || { echo "not ok warning $code: not in troubleshooting.md"; exit 1; }
done
echo "ok warnings"

# The guide lists every scene.
for scene in scenes/*.json; do
    grep -q "^| .${scene#scenes/}. |" docs/guide/scene.md || { echo "not ok $scene: not in scene.md"; exit 1; }
done
echo "ok scenes"

sed -n '/^```c$/,/^```$/{/^```/d;p}' README.md >readme.c
cc -shared -fPIC $(pkg-config --cflags projdyn) -o readme.so readme.c -lm
projdyn check --conformance ./readme.so >said || { echo "not ok README.md: its constraint:"; cat said; exit 1; }
echo "ok README.md: its constraint"

# test_guides.sh runs first-scene.md in an empty directory.
for document in $(echo "$documents" | grep -v first-scene); do
    sed -n '/^```sh$/,/^```$/{/^```/d;p}' "$document" >commands
    [ -s commands ] || continue
    sh -eux commands >said 2>&1 || { echo "not ok $document:"; tail -n 20 said; exit 1; }
    ! grep -q '^fault' said
    echo "ok $document: $(wc -l <commands) lines"
done

# Every other command of the documents, once, in their order, each on a small part of its scene: a run for
# a few milliseconds on one thread, a comparison of one step, a small picture. Left out: commands with a placeholder
# (SCENE) and scenes of 100,000 particles and more.
sed -e ':joined' -e '/\\$/{N;s/\\\n *//;bjoined' -e '}' $documents |
    grep -E '^    projdyn ' | grep -vE 'million|SCENE|radius=0.00287' | sed 's/ *#.*//' | awk '!seen[$0]++' >commands
while read -r command; do
    case $command in
    *--resume*) ;;
    "projdyn run"*) command="$command --threads 1 --time 0.004 --set frame_interval=0.002" ;;
    "projdyn sweep"*) command="$command --set duration=0.004 --set frame_interval=0.002" ;;
    "projdyn compare"*) command="$command --steps 1 --rounds 1" ;;
    "projdyn render"*docs/gallery/*) continue ;; # scripts/gallery.sh draws these
    "projdyn render"*)
        command -v chromium >/dev/null && command -v ffmpeg >/dev/null || continue
        command="$command --size 64x48"
        ;;
    "projdyn view"*)
        projdyn view --help >/dev/null 2>&1 || continue # a build without libwebsockets
        command="timeout --preserve-status -s INT 3 $command --no-browser"
        ;;
    "projdyn trade"*dam_break*) command="$command --window 0.01 --minutes 0.01 --set bodies.water.particles.radius=0.05" ;;
    "projdyn trade"*) command="$command --window 0.01 --minutes 0.01" ;;
    esac
    eval "$command" >said 2>&1 || { echo "not ok $command:"; tail -n 20 said; exit 1; }
    echo "ok $command"
done <commands

if command -v doxygen >/dev/null; then
    doxygen docs/Doxyfile >said 2>&1 || { echo "not ok the reference:"; tail -n 20 said; exit 1; }
    echo "ok the reference"
else
    echo "skipped: no doxygen"
fi

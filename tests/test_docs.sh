#!/bin/sh
# What the documents say can be done: runs every ```sh block of docs/*.md, one document after the
# other, against an installed library; reads every scene of an indented `projdyn run` or `check`; and
# makes the reference. Arguments: the build folder, the source folder.
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

for document in docs/*.md; do
    sed -n '/^```sh$/,/^```$/{/^```/d;p}' "$document" >commands
    [ -s commands ] || continue
    sh -eux commands >said 2>&1 || { echo "not ok $document:"; tail -n 20 said; exit 1; }
    ! grep -q '^fault' said
    echo "ok $document: $(wc -l <commands) lines"
done

# Scenes too large for a test, and commands with words to fill in, are left out.
grep -hE '^    projdyn (run|check) [a-z]' README.md docs/*.md | grep -vE 'million|SCENE' | sed 's/ *#.*//; s/^ *projdyn run/projdyn check/; s/ -o [^ ]*//' |
    sort -u >commands
while read -r command; do
    eval "$command" >said 2>&1 || { echo "not ok $command:"; cat said; exit 1; }
done <commands
echo "ok $(wc -l <commands) scenes"

if command -v doxygen >/dev/null; then
    doxygen docs/Doxyfile >said 2>&1 || { echo "not ok the reference:"; tail -n 20 said; exit 1; }
    echo "ok the reference"
else
    echo "skipped: no doxygen"
fi

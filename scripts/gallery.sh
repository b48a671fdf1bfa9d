#!/bin/sh
# Makes the pictures of docs/guide/gallery.md: runs the scenes of the plug-ins and a few others (minutes), and
# draws the last frame of each. Usage: gallery.sh [NAME...]
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh >/dev/null
scripts/install.sh chromium
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p docs/gallery
cp -r examples/plugin "$dir/plugin"
cp build/examples/*.so "$dir/plugin"

picture() { # NAME SCENE TIME [HIDDEN]
    build/app/projdyn run "$2" --allow-plugins -o "$dir/$1" --time "$3" --quiet 2>/dev/null
    build/app/projdyn render "$dir/$1" -o "docs/gallery/$1.png" --size 640x400 --view "hide=${4:-}" >/dev/null
    echo "docs/gallery/$1.png"
}
if [ $# = 0 ]; then
    picture soft_ball scenes/soft_ball.json 0.4
    picture flag_in_stream scenes/flag_in_stream.json 0.6 water
    picture dragged_cloth scenes/dragged_cloth.json 0.6 water
    picture flag scenes/flag.json 1.6
    picture sinking_cloth scenes/sinking_cloth.json 3 water
    picture underwater_curtain scenes/underwater_curtain.json 0.32 water
    picture taut_bag scenes/taut_bag.json 2
    picture floating_block scenes/floating_block.json 2
    set -- template rigid balloon grains sphere
fi
for name in "$@"; do
    picture "$name" "$dir/plugin/$name.json" "$(grep -o '"duration": [0-9.]*' "$dir/plugin/$name.json" | cut -d ' ' -f 2)"
done

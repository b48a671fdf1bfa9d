#!/bin/sh
# Makes the pictures of docs/guide/gallery.md: runs the scenes of the plug-ins and a few others (minutes), and
# takes a picture of the replay page's last frame. Usage: gallery.sh [NAME...]
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
    build/app/projdyn replay "$dir/$1" >/dev/null
    rm -f "$dir/profile/SingletonLock"
    chromium --headless --no-sandbox --disable-gpu --use-gl=angle --use-angle=swiftshader \
        --enable-unsafe-swiftshader --hide-scrollbars --user-data-dir="$dir/profile" --window-size=640,400 \
        --virtual-time-budget=10000 --screenshot="docs/gallery/$1.png" \
        "file://$dir/$1/replay.html#frame=100000&play=0&hide=${4:-}" >/dev/null 2>&1
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

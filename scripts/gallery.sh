#!/bin/sh
# Makes the pictures of docs/guide/gallery.md by the commands of that page. Usage: gallery.sh [NAME...]
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh >/dev/null
scripts/install.sh chromium ffmpeg pngquant
export PATH="$PWD/build/app:$PATH"
page=docs/guide/gallery.md
[ $# != 0 ] || set -- $(grep -o 'docs/gallery/[a-z_]*' $page | sed 's|.*/||' | sort -u)
sed -n '/^```sh$/,/^```$/{/^```/d;p}' $page | sh -eu
for name in "$@"; do
    grep "^    projdyn .* *out/$name\( \|\$\)" $page >out/commands || { echo "$page: no picture $name" >&2; exit 2; }
    sh -eu out/commands
    for picture in docs/gallery/"$name".png docs/gallery/"$name"-[1-9].png; do
        [ ! -f "$picture" ] || pngquant --force --ext .png "$picture"
    done
done

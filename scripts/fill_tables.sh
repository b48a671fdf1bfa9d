#!/bin/sh
# fill_tables.sh FOLDER FROM TO: FOLDER/NAME.md is put between <!-- NAME --> and <!-- end --> of FROM, which becomes TO.
# Without such a file the table stays.
set -eu
awk -v out="$1" '
    /^<!-- end -->$/ { skip = 0 }
    !skip
    /^<!-- [a-z_]+ -->$/ && $2 != "end" {
        file = out "/" $2 ".md"
        while ((getline line <file) > 0) {
            print line
            skip = 1
        }
    }' "$2" >"$1/filled.md"
mv "$1/filled.md" "$3"

#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Draw the pictures of docs/images again: tools/pictures.sh [NAME ...]; all where none is named.
#
# At the end, one line a picture: its name, which picture of its page it is, and what makes the
# page in the folder that is given last.
set -eu
cd "$(dirname "$0")/.."
root=$PWD
. tools/workspace.sh
wanted=" $* "
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT

# Draw what was asked for by name, or everything.
draw() {
    name=$1 picture=$2
    shift 2
    is_wanted "$name" || return 0
    echo "picture: $name ..."
    "$@" "$made/$name" >"$made/log" 2>&1 || {
        cat "$made/log" >&2
        exit 1
    }
    .venv/bin/python -P -c '
import sys
from pathlib import Path
from lta_report.screenshots import write_pictures
write_pictures(Path(sys.argv[1]), Path(sys.argv[2]))
' "$made/$name"/*.html "$made/$name.pictures"
    cp "$made/$name.pictures/$picture.png" "docs/images/$name.png"
}

compared() {
    ./lta simulate --seed 3 --out "$1.a"
    ./lta simulate --seed 4 --out "$1.b"
    ./lta compare "$1.a" "$1.b" --out "$1"
}

is_wanted() {
    case "$wanted" in '  ' | *" $1 "*) ;; *) return 1 ;; esac
}

draw flight top ./lta fly --seed 1 --out
if is_wanted film; then
    ./lta simulate --seed 3 --out "$made/film"
    ./lta report "$made/film" --video docs/images/flight.gif
fi
draw compare top compared
if is_wanted discover; then
    ./lta discover --demo --seed 5 --out "$made/discover"
    cp "$made/discover/picture.svg" docs/images/discover.svg
fi
draw cells top ./lta cells --out
draw energy_budget top ./lta energy budget --out
draw energy_hover voltage ./lta energy budget --out
draw light_plan coverage ./lta light plan warehouse --out
draw mission day ./lta mission greenhouse_summer --out

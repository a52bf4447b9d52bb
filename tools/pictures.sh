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

# Draw what was asked for by name, or everything. Pictures of one page share its command.
draw() {
    name=$1 picture=$2
    shift 2
    is_wanted "$name" || return 0
    echo "picture: $name ..."
    folder=$made/$(echo "$*" | cksum | tr -d ' ')
    [ -d "$folder" ] || "$@" "$folder" >"$made/log" 2>&1 || {
        cat "$made/log" >&2
        exit 1
    }
    .venv/bin/python -P -c '
import sys
from pathlib import Path
from PIL import Image
from lta_report.screenshots import write_picture
page, picture, out = sys.argv[1:]
# A figure is narrow, so that its letters are as large as those of the page of docs/ around it
write_picture(Path(page), Path(out), picture, width=1280 if picture == "top" else 760)
Image.open(out).convert("RGB").quantize(dither=Image.Dither.NONE).save(out, optimize=True)
' "$folder"/*.html "$picture" "docs/images/$name.png"
}

compared() {
    ./lta simulate --seed 3 --out "$1.a"
    ./lta simulate --seed 4 --out "$1.b"
    ./lta compare "$1.a" "$1.b" --out "$1"
}

# The tutorials' own commands: docs/tutorials/files_to_bag.md and blimp_afternoon.md
drafted() {
    awk '/^```python/ { code = 1; next } /^```/ { code = 0 } code' docs/tutorials/files_to_bag.md >"$1.py"
    mkdir "$1.log"
    (cd "$1.log" && "$root/.venv/bin/python" "$1.py")
    ./lta import --draft "$1.log/runs/lab/flight.csv" --out "$1"
}

calibrated() {
    .venv/bin/python examples/blimp_afternoon.py "$made/afternoon" --seed 1
    ./lta tests read "$made/afternoon/tests" --vehicle gtmab --out "$1"
}

commanded() {
    ./lta launch fly commanded:=true scenario:=breeze bag:="$1/bag" &
    graph=$!
    ./lta run examples/own_commander.py --ros-args -r __ns:=/lta1
    kill "$graph" # not SIGINT, which a shell's background jobs ignore
    wait "$graph" || true
    ./lta report "$1"
}

replayed() {
    ./lta simulate --seed 3 --out "$1.a"
    ./lta replay "$1.a" --strategy bag --against --out "$1" || [ $? = 1 ] # 1: it differs
}

plotted() {
    ./lta simulate --seed 3 --out "$1.a"
    mkdir "$1"
    ./lta bag plot "$1.a" motors --html "$1/plot.html"
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
draw map path ./lta simulate --scenario warehouse --out
draw heading heading ./lta simulate --scenario warehouse --out
draw bearing light ./lta simulate --scenario warehouse --out
draw energy_flight power ./lta simulate --scenario sunny_field --set 'vehicle.sensors.diodes.feedback=10 kohm' --out
draw airspeed airspeed ./lta simulate --strategy bag --seed 3 --out
draw vehicle views ./lta vehicle show gtmab --out
draw draft top drafted
draw tests_plan top ./lta tests plan gtmab --wrench --out
draw calibrated errors calibrated
draw light_link snr ./lta light link --feedback 10 --out
draw commanded altitude commanded
draw replay decision-1 replayed
draw recording unit-0 plotted
draw strategies by-0 ./lta sweep light_indoors --device cpu-batch --out

#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Build the wheel of all that needs no ROS: tools/wheel.sh [FOLDER], dist/ by default.
#
# It is built with the pinned setuptools of .venv and asks no index.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd -P)
mkdir -p "${1:-$root/dist}"
out=$(cd "${1:-$root/dist}" && pwd -P)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
cp "$root/tools/wheel/setup.py" "$root/LICENSE" "$work/"
# The commit is part of the wheel, whose results name it; machines of a cluster compare it.
(set +u && . "$root/tools/workspace.sh" && "$root/.venv/bin/python" -P -c \
    'from lta_bag.provenance import read_commit; print(read_commit())') >"$work/commit"
cd "$work"
if ! LTA_ROOT=$root "$root/.venv/bin/python" setup.py --quiet bdist_wheel --dist-dir "$out" \
    >"$work/log" 2>&1; then
    cat "$work/log" >&2
    echo 'The wheel could not be built; the lines above say why.' >&2
    exit 2
fi
ls "$out"/lta-*.whl

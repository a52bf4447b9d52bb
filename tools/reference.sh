#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Write the pages of docs/ that are made of declarations, in the built workspace (make reference).
set -eu
cd "$(dirname "$0")/.."
new=$(mktemp)
trap 'rm -f "$new"' EXIT
export PYTHONPATH="$PWD:$PYTHONPATH"
for page in topics effects verbs parameters vehicles vehicle_keys graph; do
    echo "$page"
    python -P -m tools.reference "$page" >"$new"
    case $page in graph) file=docs/images/graph.svg ;; *) file=docs/$page.md ;; esac
    cat "$new" >"$file"
done

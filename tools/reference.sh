#!/bin/sh
# Write the pages of docs/ that are made of declarations, in the built workspace (make reference).
set -eu
cd "$(dirname "$0")/.."
new=$(mktemp)
trap 'rm -f "$new"' EXIT
write() {
    page=$1
    shift
    echo "docs/$page"
    "$@" >"$new"
    cat "$new" >"docs/$page"
}
write topics.md python -P -m lta_cli.reference topics
write effects.md ./lta effects --markdown
write verbs.md python -P -m lta_cli.reference verbs
write parameters.md python -P -m lta_cli.reference parameters
write vehicles.md python -P -m lta_cli.reference vehicles
write vehicle_keys.md python -P -m lta_cli.reference vehicle_keys
write images/graph.svg python -P -m lta_cli.reference graph

#!/bin/sh
# Write the pages of docs/ that are made of declarations, in the built workspace (make reference).
set -eu
cd "$(dirname "$0")/.."
write() {
    page=$1
    shift
    "$@" >"docs/$page.new"
    mv "docs/$page.new" "docs/$page"
}
write topics.md python -m lta_config.topics_page
write effects.md ./lta effects --markdown
write verbs.md python -m lta_cli.reference verbs
write parameters.md python -m lta_cli.reference parameters
write vehicles.md python -m lta_cli.reference vehicles
write discovery_thresholds.md python -m lta_cli.reference thresholds
write images/graph.svg python -m lta_cli.reference graph
python test/score/hardware_pages.py

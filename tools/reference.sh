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
write verbs.md python -m lta_analysis.reference verbs
write parameters.md python -m lta_analysis.reference parameters
write vehicles.md python -m lta_analysis.reference vehicles
write discovery_thresholds.md python -m lta_analysis.reference thresholds
write images/graph.svg python -m lta_analysis.reference graph

#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Say whether this could be released: one line a condition, exit status 1 if one does not hold.
#
# It changes nothing and publishes nothing. A release is a tag, which a person sets.
set -u
root=$(cd "$(dirname "$0")/.." && pwd -P)
cd "$root"
version=$(sed -n "s/^VERSION: Final = '\(.*\)'$/\1/p" config/lta_config/version.py)
log=$(mktemp -d)
trap 'rm -rf "$log"' EXIT INT TERM
status=0

clean_tree() { [ -z "$(git status --porcelain)" ]; }
in_changelog() { grep -q "^## \[$version\]" CHANGELOG.md; }
not_tagged() { ! git rev-parse --quiet --verify "refs/tags/v$version"; }
style_and_types() { make check; }
wheel() { tools/wheel.sh; }
site() { tools/site.sh; }
# Versions, dependencies and generated pages agree with what they are made of.
agreement() { (. tools/workspace.sh && python -P -m pytest -q -n 0 test/contract); }
# Asks a database of vulnerabilities over the network; without --strict, what it does not find there passes.
known_faults() {
    command -v pip-audit || { echo 'pip-audit is missing: pipx install pip-audit'; return 1; }
    pip-audit --strict --disable-pip --require-hashes -r locked/build.txt -r locked/run.txt
}
# The wheel's own test is one of the long ones.
tests() { make test-long; }

hold() {
    if "$2" >"$log/$2" 2>&1; then
        echo "ok    $1"
    else
        echo "NOT   $1"
        tail -n 3 "$log/$2" | sed 's/^/      /'
        status=1
    fi
}

echo "LTA $version"
hold 'nothing is uncommitted' clean_tree
hold "CHANGELOG.md has a heading [$version]" in_changelog
hold "there is no tag v$version yet" not_tagged
hold 'style and types' style_and_types
hold 'versions, pins and generated pages agree' agreement
hold 'the wheel builds' wheel
hold 'the site builds, and no link of it is dead' site
hold 'nothing that is installed has a known vulnerability' known_faults
[ "$status" = 0 ] && hold 'all tests, the long ones too' tests
exit "$status"

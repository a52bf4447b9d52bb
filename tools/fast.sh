#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Run the unit tests that are nearest to what changed against main, for a minute at most.
set -eu
limit=50 # s, beside the start
files=$(.venv/bin/python tools/nearest_tests.py)
if [ -z "$files" ]; then
    echo 'No Python file under campaigns, config, src or test differs from main: nothing to test.'
    exit 0
fi
status=0
# shellcheck disable=SC2086  # words
timeout --signal=INT "$limit" .venv/bin/python -P -m pytest -q -n 2 --dist loadfile \
    --no-loadscope-reorder -m 'not long' "$@" $files || status=$?
if [ "$status" = 124 ]; then
    echo "The nearest $(echo "$files" | wc -l) files of tests take longer than a minute; make test runs them all."
fi
exit "$status"

#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Run the unit tests of each package with colcon: tools/test_packages.sh [FOLDER ...]
set -eu
cd "$(dirname "$0")/.."
root=$PWD
. tools/workspace.sh
[ $# -gt 0 ] || set -- $(dirname config/setup.py src/*/setup.py)
status=0
colcon --log-base log test --paths "$@" --return-code-on-test-failure || status=$?
colcon test-result --all
exit "$status"

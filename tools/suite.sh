#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Run the tests that a marker expression chooses: tools/suite.sh EXPRESSION [pytest's arguments]
#
# A file at a time in each worker, in the order of their names: by their numbers of tests, long
# files of few tests would come last. One worker more than there are cores, since tests of whole
# graphs wait for most of their time.
set -u
chosen=$1
shift
# OMP_NUM_THREADS, which make sets for the tests, would be taken for the number of cores.
workers=$(($(env -u OMP_NUM_THREADS nproc) + 1))
exec .venv/bin/python -P -m pytest -q -n "$workers" --maxprocesses 5 --dist loadfile \
    --no-loadscope-reorder -m "$chosen" "$@"

#!/bin/sh
# Run the tests that a marker expression chooses: tools/suite.sh EXPRESSION [pytest's arguments]
#
# What needs nothing but a core, or waits for events alone, goes side by side, a file at a time on
# each core. What starts processes and watches the clock follows one by one: where not the whole
# file does, its tests that do are marked `alone`. Either part may have no test (status 5). Files
# go by their names: by their numbers of tests, long files of few tests would come last, and two
# that compile the same kernel at the same time.
set -u
chosen=$1
shift
status=5
run() {
    .venv/bin/python -m pytest -q "$@"
    now=$?
    [ "$now" = 5 ] && return
    if [ "$status" = 5 ] || [ "$status" = 0 ]; then
        status=$now
    fi
    # Interrupted: the rest is not wanted either.
    [ "$now" = 2 ] && exit "$status"
}
clock='integration and (alone or not beside)'
run -n auto --maxprocesses 4 --dist loadfile --no-loadscope-reorder -m "not ($clock) and ($chosen)" "$@"
# The second part is looked for where it is, unless the arguments name files of their own.
case " $* " in
    *' test/'*) files= ;;
    *) files="test/integration $(grep -rl 'mark\.integration' test --include='test_*.py' | sort)" ;;
esac
# shellcheck disable=SC2086  # words
run -m "$clock and ($chosen)" $files "$@"
exit "$status"

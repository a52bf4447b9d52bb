#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Make .venv hold exactly what locked/*.txt say; do nothing if it does.
#
#   tools/environment.sh run     what flying needs
#   tools/environment.sh test    and what `make test` needs
#
# The stamp is removed first and written last: an interrupted run is never believed.
set -eu
level=$1
root=$(cd "$(dirname "$0")/.." && pwd -P)
venv=$root/.venv
stamp=$venv/.lta
needed_mb=2500
cd "$root"
# Packages of a sourced ROS would pass for installed, and a user install for one into .venv.
unset PYTHONPATH PYTHONHOME
export PIP_USER=0

telling=
stop() {
    [ -z "$telling" ] || kill "$telling" 2>/dev/null || :
    echo "$*" >&2
    exit 2
}

# Print the first interpreter that can make an environment, newest first; 3.14 where there is no other.
choose_python() {
    lacking=
    for python in ${PYTHON:-python3.13 python3.12 python3.11 python3 python3.14}; do
        "$python" -I -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 15))' \
            2>/dev/null || continue
        if "$python" -I -c 'import ensurepip, venv' 2>/dev/null; then
            # Not the link in an activated environment, perhaps the very one to be made anew.
            "$python" -I -c 'import sys; print(getattr(sys, "_base_executable", sys.executable))'
            return
        fi
        lacking=$python
    done
    if [ -n "$lacking" ]; then
        stop "$lacking has no venv module; install it (Debian, Ubuntu:" \
            "apt install python3-venv) and run make again."
    fi
    found=$(${PYTHON:-python3} -V 2>/dev/null || echo 'not there')
    stop "LTA needs Python 3.11 to 3.14 and ${PYTHON:-python3} is $found; install one or name it:" \
        'make PYTHON=/path/to/python3.'
}

check_machine() {
    [ "$(uname -sm)" = 'Linux x86_64' ] || stop "ROS 2 comes as wheels for Linux on x86-64 and" \
        "this is $(uname -sm); run LTA on such a machine, or in a container for linux/amd64."
    case $root in
    *[[:space:]:]*) stop "The folder $root has a space or a colon in its name, which colcon's" \
        'scripts cannot hold; move it.' ;;
    esac
    free_mb=$(($(df -Pk . | awk 'NR == 2 { print $4 }') / 1024))
    [ "$free_mb" -ge "$needed_mb" ] || stop "The environment needs $needed_mb MB and" \
        "$free_mb MB are free under $root; free disk space and run make again."
}

# Say every 20 s that it goes on; ends with this script. sleep does not keep the output open for
# whoever reads it.
tell_progress() {
    seconds=0
    while sleep 20 >/dev/null 2>&1 && kill -0 $$ 2>/dev/null; do
        seconds=$((seconds + 20))
        echo "environment: $seconds s, fetching and unpacking packages ..."
    done
}

# uv does not read pip's configuration: pass on where packages come from and which certificates hold.
pass_settings_to_uv() {
    settings=$("$venv/bin/python" -P -m pip config list 2>/dev/null) || return 0
    setting() {
        printf '%s\n' "$settings" | sed -n "s/^[^=]*\.$1='\(.*\)'\$/\1/p" | head -n 1
    }
    : "${UV_DEFAULT_INDEX:=$(setting index-url)}" "${UV_INDEX:=$(setting extra-index-url)}"
    : "${UV_FIND_LINKS:=$(setting find-links)}" "${SSL_CERT_FILE:=$(setting cert)}"
    for name in UV_DEFAULT_INDEX UV_INDEX UV_FIND_LINKS SSL_CERT_FILE; do
        eval "[ -z \"\$$name\" ] || export $name"
    done
}

# Both take the listed packages alone, and only files with a listed hash, from whatever index.
with_pip() {
    "$venv/bin/python" -P -m pip install --disable-pip-version-check --no-input --no-compile \
        --no-deps --require-hashes "$@" >>"$venv/install.log" 2>&1
}

with_uv() {
    [ -x "$venv/bin/uv" ] && UV_INDEX_STRATEGY=unsafe-best-match "$venv/bin/uv" pip install \
        --quiet --no-config --python "$venv/bin/python" --no-deps --no-build-isolation \
        --require-hashes "$@" >>"$venv/install.log" 2>&1
}

# What comes as source only is built with the setuptools of locked/build.txt, not with the newest.
install() {
    if ! with_uv "$@"; then
        echo 'environment: uv could not install the packages; pip goes on ...'
        with_pip --no-build-isolation "$@" || fail_to_install
    fi
}

fail_to_install() {
    reason=$(sed -n 's/^ERROR: //p' "$venv/install.log" | head -n 1)
    stop "pip cannot install the environment (${reason:-see $venv/install.log}); check the" \
        'network and the pip configuration and run make again.'
}

# colcon takes a prefix with a local_setup file for a workspace to build upon; the package.xml
# files of the ROS wheels below it are no sources.
make_underlay() {
    : >"$venv/local_setup.sh"
    : >"$venv/local_setup.bash"
    : >"$venv/COLCON_IGNORE"
    ln -sf ../../lta "$venv/bin/lta"
}

key() {
    {
        echo "$root $("$1" -I -c 'import sys; print(sys.version, sys.base_prefix)')"
        cat locked/uv.txt locked/build.txt locked/run.txt locked/test.txt tools/environment.sh
    } | sha256sum | cut -d ' ' -f 1
}

# An environment that is in order needs no look at the machine, unless a Python is asked for.
python=$venv/bin/python
if [ -n "${PYTHON:-}" ] || [ ! -x "$python" ]; then
    python=$(choose_python)
fi
wanted=$(key "$python")
found=$(cat "$stamp" 2>/dev/null || :)
case $found in
"test $wanted" | "$level $wanted") exit 0 ;;
esac

begun=$(date +%s)
check_machine
rm -f "$stamp"
if [ "$found" != "run $wanted" ]; then
    python=$(choose_python)
    wanted=$(key "$python")
    echo "environment: $("$python" -V) in .venv (first time: about a minute on a free machine) ..."
    rm -rf "$venv"
    "$python" -I -m venv "$venv"
    : >"$venv/install.log"
    with_pip --requirement locked/build.txt || fail_to_install
    with_pip --requirement locked/uv.txt || : # pip does its work then
    make_underlay
fi
pass_settings_to_uv
tell_progress &
telling=$!
case $level in
run) install --requirement locked/build.txt --requirement locked/run.txt ;;
test)
    echo 'environment: what the tests need as well ...'
    install --requirement locked/build.txt --requirement locked/run.txt --requirement locked/test.txt
    ;;
esac
kill "$telling" 2>/dev/null || :
telling=
# On all cores, where pip takes one, and without the half that nobody imports: tests of packages and
# pymavlink's dialects. What does not compile stays as it is, as with pip.
(cd "$venv" && bin/python -P -m compileall -q -j 0 -x '/(tests|dialects)/' lib >>install.log 2>&1) || :
echo "$level $wanted" >"$stamp"
echo "environment: ready (took $(($(date +%s) - begun)) s)."

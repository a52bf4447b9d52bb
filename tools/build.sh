#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Build the workspace with colcon, if a package declaration changed since the last time.
#
# Python and data files are linked, not copied: editing them needs no build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd -P)
stamp=$root/install/.lta
cd "$root"

# One build at a time; the next one finds its work done. The lock ends with this process.
exec 9<.
flock -n 9 || {
    echo 'workspace: another build is running here; waiting for it ...'
    flock 9
}

# Messages that no wheel has.
messages=$(cat tools/messages.py tools/messages/*/package.xml tools/messages/*/msg/*.msg \
    src/lta_msgs/package.xml src/lta_msgs/msg/*.msg src/lta_msgs/action/*.action .venv/.lta |
    sed 's/^test /run /' | sha256sum | cut -d ' ' -f 1)
if [ "$(cat .venv/.messages 2>/dev/null || :)" != "$messages" ]; then
    env -u PYTHONPATH AMENT_PREFIX_PATH="$root/.venv" \
        .venv/bin/python tools/messages.py tools/messages/* src/lta_msgs || exit 2
    echo "$messages" >.venv/.messages
fi

wanted=$(
    {
        cat .venv/.lta tools/build.sh colcon.meta
        cat config/setup.* config/package.xml src/*/setup.* src/*/package.xml
        cat firmware/light_board/mavlink/*.xml # lta_bridge is generated from them
        find config -name __pycache__ -prune -o -name '*.egg-info' -prune -o -type f -print | sort
    } | sed 's/^test /run /' | sha256sum | cut -d ' ' -f 1
)
[ "$(cat "$stamp" 2>/dev/null || :)" != "$wanted" ] || exit 0

begun=$(date +%s)
echo 'workspace: colcon build (about ten seconds) ...'
rm -rf build install
mkdir -p log
# On the wheels lta_msgs is in .venv; its CMakeLists.txt is for a full ROS.
set -- config
for each in src/*/setup.py; do
    set -- "$@" "${each%/setup.py}"
done
# A warning is an error: a package whose package.xml is not valid is left out with no more than that.
# A sourced ROS would be taken as one more underlay, with another Python.
if ! env -u PYTHONPATH -u COLCON_PREFIX_PATH VIRTUAL_ENV="$root/.venv" \
    AMENT_PREFIX_PATH="$root/.venv" PATH="$root/.venv/bin:$PATH" \
    colcon --log-base log build --symlink-install --base-paths "$@" \
    >log/build.log 2>&1 || grep -q WARNING log/build.log; then
    cat log/build.log >&2
    echo 'colcon could not build the workspace; the lines above and log/latest_build say why.' >&2
    exit 2
fi
# Python looks for each module in every folder of its path: one for all packages instead of two for each.
mkdir install/python
for each in build/*/*.egg-info; do
    ln -s "$root/$each" "$root/${each%.egg-info}" install/python
done
# What local_setup.sh sets, for tools/workspace.sh: that script starts Python, which every command would wait for.
env -i PATH="$PATH" sh -c '. install/local_setup.sh
for each in COLCON_PREFIX_PATH AMENT_PREFIX_PATH; do
    eval "echo \"$each \$$each\""
done' >install/environment
echo "PYTHONPATH $root/install/python" >>install/environment

# Once, not by a dozen processes at the same time when the first graph starts.
.venv/bin/python -P -m compileall -q -j 0 config src
echo "$wanted" >"$stamp"
echo "workspace: ready (took $(($(date +%s) - begun)) s)."

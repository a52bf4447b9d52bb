#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Install the ros2 command of ROS 2 Jazzy beside the wheels, which lack it. `./ros2` runs it.
#
#   tools/ros2cli.sh [FROM]     FROM: where the repositories are, https://github.com/ros2 by default
#
# Its packages are plain Python, but for the messages of composable nodes, which `launch_ros` imports
# and tools/messages.py compiles. `ros2 bag` is C++ and is not among them.
set -eu
from=${1:-https://github.com/ros2}
root=$(cd "$(dirname "$0")/.." && pwd -P)
target=$root/.ros2
sources=$(mktemp -d "$root/.ros2.XXXXXX")
trap 'rm -rf "$sources"' EXIT

stop() {
    echo "$*" >&2
    exit 2
}

clone() {
    echo "ros2: fetching $1 $2 ..."
    git -c advice.detachedHead=false clone --quiet --depth 1 --branch "$2" "$from/$1" "$sources/$1" ||
        stop "$from/$1 $2 cannot be fetched; check the network and run make ros2 again."
}

clone ros2cli 0.32.2
clone rosidl_runtime_py 0.13.1
clone launch 3.4.3
clone launch_ros 0.26.6
clone rcl_interfaces 2.0.2
set -- "$sources/rosidl_runtime_py"
for package in cli action interface lifecycle node param pkg run service topic; do
    set -- "$@" "$sources/ros2cli/ros2$package"
done
for package in launch/launch launch/launch_xml launch/launch_yaml launch_ros/launch_ros launch_ros/ros2launch; do
    set -- "$@" "$sources/$package"
done
AMENT_PREFIX_PATH=$root/.venv "$root/.venv/bin/python" "$root/tools/messages.py" \
    "$sources/rcl_interfaces/composition_interfaces" || stop 'ros2: no messages for launch; see above.'
pip() {
    "$root/.venv/bin/python" -P -m pip install --quiet --disable-pip-version-check \
        --ignore-installed --prefix "$sources/made" "$@" || stop 'ros2: pip failed; see above.'
}
pip --no-deps --no-build-isolation "$@"
pip --no-deps argcomplete importlib-metadata osrf-pycommon psutil zipp
rm -rf "$target"
mv "$sources/made" "$target"
echo 'ros2: ready; ./ros2 topic list shows the topics of a running graph.'

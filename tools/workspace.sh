# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Enter the built workspace: sourced by ./lta and the Makefile, with `root` set.

# The Python path of a sourced ROS would come before the wheels of .venv.
if [ -n "${ROS_DISTRO:-}" ]; then
    unset PYTHONPATH AMENT_PREFIX_PATH
fi
AMENT_PREFIX_PATH=$root/.venv${AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}
export AMENT_PREFIX_PATH
# A "ros2" on the PATH belongs to another ROS, whose paths are gone: `lta launch` starts the graph itself.
export LTA_UNDERLAY=wheels
# As install/local_setup.sh does; a second time adds nothing.
while read -r name paths; do
    eval "case :\${$name:-}: in *:\$paths:*) ;; *) export $name=\"\$paths\${$name:+:\$$name}\" ;; esac"
done <"$root/install/environment"
unset name paths
PATH=$root/.venv/bin:$PATH

export RMW_IMPLEMENTATION="${RMW_IMPLEMENTATION:-rmw_fastrtps_cpp}"
# Nothing outside this machine hears or reaches the graph unless asked for. How its processes find each other: see the two files.
this_machine=$root/config/fastdds/this_machine.xml profiles=$root/config/fastdds/network.xml
export ROS_AUTOMATIC_DISCOVERY_RANGE="${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}"
if [ "${FASTRTPS_DEFAULT_PROFILES_FILE:-}$ROS_AUTOMATIC_DISCOVERY_RANGE" != "${this_machine}SYSTEM_DEFAULT" ]; then
    case ${FASTRTPS_DEFAULT_PROFILES_FILE:-} in
    "$root"/config/fastdds/*) unset FASTRTPS_DEFAULT_PROFILES_FILE ;; # chosen for another range
    esac
    if [ "$ROS_AUTOMATIC_DISCOVERY_RANGE$RMW_IMPLEMENTATION${ROS_STATIC_PEERS:-}${FASTRTPS_DEFAULT_PROFILES_FILE:-}" = LOCALHOSTrmw_fastrtps_cpp ]; then
        profiles=$this_machine
        ROS_AUTOMATIC_DISCOVERY_RANGE=SYSTEM_DEFAULT # as the profile says
        unset ROS_LOCALHOST_ONLY                     # which would come before it
    fi
fi
export FASTRTPS_DEFAULT_PROFILES_FILE="${FASTRTPS_DEFAULT_PROFILES_FILE:-$profiles}"
# Pydantic would look for plugins in every installed package, in every process: a tenth of its start.
export PYDANTIC_DISABLE_PLUGINS="${PYDANTIC_DISABLE_PLUGINS:-__all__}"
# The matrices are small: more threads only take cores from the other nodes.
export OPENBLAS_NUM_THREADS="${OPENBLAS_NUM_THREADS:-1}" OMP_NUM_THREADS="${OMP_NUM_THREADS:-1}"
# Images set it to stay small; here every process of a graph would compile the same hundred files.
unset PYTHONDONTWRITEBYTECODE

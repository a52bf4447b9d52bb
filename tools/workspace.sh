# Enter the built workspace: sourced by ./lta and the Makefile, with `root` set.

# The Python path of a sourced ROS would come before the wheels of .venv.
if [ -n "${ROS_DISTRO:-}" ]; then
    unset PYTHONPATH AMENT_PREFIX_PATH
fi
AMENT_PREFIX_PATH=$root/.venv${AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}
export AMENT_PREFIX_PATH
# A "ros2" on the PATH belongs to another ROS, whose paths are gone: `lta launch` starts the graph itself.
export LTA_UNDERLAY=wheels
. "$root/install/local_setup.sh"
PATH=$root/.venv/bin:$PATH

# Nothing outside this machine hears or reaches the graph unless asked for.
export ROS_AUTOMATIC_DISCOVERY_RANGE="${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}"
export RMW_IMPLEMENTATION="${RMW_IMPLEMENTATION:-rmw_fastrtps_cpp}"
# The processes of a graph find each other at once; see the file.
export FASTRTPS_DEFAULT_PROFILES_FILE="${FASTRTPS_DEFAULT_PROFILES_FILE:-$root/config/fastdds.xml}"
# Pydantic would look for plugins in every installed package, in every process: a tenth of its start.
export PYDANTIC_DISABLE_PLUGINS="${PYDANTIC_DISABLE_PLUGINS:-__all__}"
# The matrices are small: more threads only take cores from the other nodes.
export OPENBLAS_NUM_THREADS="${OPENBLAS_NUM_THREADS:-1}" OMP_NUM_THREADS="${OMP_NUM_THREADS:-1}"

"""
The environment of the processes that a launch starts.

Each node is one thread of work, so its linear algebra gets one thread, and what it prints comes
at once. The ROS wheels restart every interpreter once to set the library path (about 0.2 s of CPU
a node after its imports); setting the path here, with the wheels' own function, spares that.
"""

from importlib import import_module
from importlib.util import find_spec
import os

BOOTSTRAPPER = 'ros_wheels_bootstrapper'
BOOTSTRAPPED = '_ROS_WHEELS_BOOTSTRAP_COMPLETE'
THREADS = ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS')


def child_environment() -> dict[str, str]:
    """Return this process's environment with what a node needs beside it."""
    environment = {**os.environ, 'PYTHONUNBUFFERED': '1', **dict.fromkeys(THREADS, '1')}
    if BOOTSTRAPPED not in os.environ and find_spec(BOOTSTRAPPER) is not None:
        environment |= {BOOTSTRAPPED: '1', 'LD_LIBRARY_PATH': _library_path()}
    return environment


def _library_path() -> str:
    """Return the library path as the wheels would set it."""
    os.environ[BOOTSTRAPPED] = '1'  # without the mark the import restarts this interpreter
    try:
        return str(import_module(BOOTSTRAPPER).get_ros_paths())
    finally:
        del os.environ[BOOTSTRAPPED]

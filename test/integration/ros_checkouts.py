# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The programs of a genuine ROS 2 that the wheels lack, from a folder of checkouts.

LTA_ROS_CHECKOUTS names the folder. It holds, each in a folder of its name, ros2cli (0.32.2),
launch (3.4.3), launch_ros (0.26.6), osrf_pycommon (2.1.6) and rosidl_runtime_py (0.13.1); for the
test of `make ros2` also rcl_interfaces (2.0.2), for that of the rosdep keys rosdistro, for that of
the linters ament_lint (0.17.1).
"""

import os
from pathlib import Path
import shutil
import subprocess
import sys
from tempfile import TemporaryDirectory

CHECKOUTS = os.environ.get('LTA_ROS_CHECKOUTS', '')
WITHOUT = 'LTA_ROS_CHECKOUTS names no folder of checkouts of ROS 2'
PACKAGES = (
    'launch/launch',
    'launch/launch_xml',
    'launch/launch_yaml',
    'launch_ros/launch_ros',
    'launch_ros/ros2launch',
    'osrf_pycommon',
    'rosidl_runtime_py',
    *(
        f'ros2cli/{name}'
        for name in (
            'ros2cli', 'ros2action', 'ros2interface', 'ros2lifecycle', 'ros2node', 'ros2param',
            'ros2pkg', 'ros2run', 'ros2service', 'ros2topic',
        )
    ),
)  # fmt: skip
# What they import from packages that are not there, and of which we have no use
STAND_INS = {
    # of launch_ros: composable nodes
    'composition_interfaces/__init__.py': '',
    'composition_interfaces/srv.py': """
class LoadNode:
    class Request: pass
    class Response: pass
""",
    # of ros2cli: completion of words in a shell
    'argcomplete/__init__.py': 'def autocomplete(parser, **kwargs): pass\n',
    'argcomplete/completers.py': """
class SuppressCompleter: pass
class DirectoriesCompleter: pass
class FilesCompleter:
    def __init__(self, *words, **kwargs): pass
""",
    # The standard library's by another name
    'importlib_metadata.py': 'from importlib.metadata import *\n',
}


def install(folder: Path) -> dict[str, str]:
    """Install the checkouts into a folder; return the variables by which a process finds them."""
    pip = [sys.executable, '-m', 'pip', 'install', '--quiet', '--disable-pip-version-check']
    alone = ['--no-deps', '--no-build-isolation', '--no-index', '--ignore-installed']
    # setuptools builds where the source is: in a copy, so that the checkouts stay as they are
    with TemporaryDirectory() as copies:
        paths = [str(Path(copies) / package) for package in PACKAGES]
        for package, path in zip(PACKAGES, paths, strict=True):
            built = shutil.ignore_patterns('build', '*.egg-info', '__pycache__')
            shutil.copytree(Path(CHECKOUTS) / package, path, ignore=built)
        subprocess.run([*pip, *alone, '--prefix', folder, *paths], check=True)
    (site,) = folder.glob('lib/python*/site-packages')
    for name, text in STAND_INS.items():
        (site / name).parent.mkdir(exist_ok=True)
        (site / name).write_text(text, encoding='utf-8')
    return {
        'PATH': f'{folder / "bin"}:{os.environ["PATH"]}',
        'PYTHONPATH': f'{site}:{os.environ.get("PYTHONPATH", "")}',
        'AMENT_PREFIX_PATH': f'{folder}:{os.environ["AMENT_PREFIX_PATH"]}',
    }

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write docs/licences.md: the licence of every package that LTA is installed with.

`make lock` runs it. What a package says of itself counts, in this order: `STATED`, its
licence expression, its classifiers, its licence field, ROS's package.xml.
"""

from collections import defaultdict
from importlib import metadata
from pathlib import Path
import re
import sys
from typing import Final
import xml.etree.ElementTree as ElementTree

ROOT: Final = Path(__file__).resolve().parents[1]
PAGE: Final = ROOT / 'docs/licences.md'
LOCKS: Final = {
    'uv': 'What installs the rest',
    'build': 'What builds the rest',
    'run': 'What flying needs',
    'test': 'What tests need beside it, not installed by `make demo`',
    'compiler': 'What compiles the messages where the machine has no compiler',
}
# Read in the licence file that the package brings, as it says nothing elsewhere, or is seldom
# installed.
STATED: Final = {
    'ros-fastcdr': 'Apache-2.0', 'ros-fastrtps': 'Apache-2.0', 'setuptools': 'MIT',
    'ziglang': 'MIT',
}  # fmt: skip
# Wheels of several ROS packages under one name: that of the package.xml which speaks for them.
ROS_NAMES: Final = {
    'ros-jazzy-common-interfaces': 'common_interfaces',
    'ros-jazzy-rclpy': 'rclpy',
    'ros-jazzy-rmw-fastrtps-cpp': 'rmw_fastrtps_cpp',
}
HEAD: Final = """# Licences

LTA is under the Apache License 2.0. `make lock` wrote this list of all that it is installed with
from what each package says of itself, in the versions of `locked/`. Nothing of it is copied into
LTA.

The base install has nothing under the GPL alone (`test_locked.py`). docutils, which colcon brings,
names the GPL for a few of its files beside the public domain and BSD of the rest. pymavlink
(LGPL-3.0, unmodified) generates the code for the light board's messages when LTA is built, and is
not imported in flight. By its README, what it generates is under the MIT licence; the headers of
its generator's files name the GPL. cflib (GPL) is a tool of the tests; to fly a real Crazyflie you
install it yourself. What is asked for by hand (`requirements-dask.txt`, `-docs`, `-gpu`,
`-pybamm`) is not listed.

The pages that LTA writes contain two libraries of JavaScript with their licence texts: plotly.js
(MIT), which comes with plotly, and, for 3-D views, three.js (MIT), which comes with trimesh.
"""


def packages(lock: str) -> list[str]:
    """Return the name of each package of a locked file."""
    text = (ROOT / f'locked/{lock}.txt').read_text(encoding='utf-8')
    return re.findall(r'^([\w.-]+)==', text, re.MULTILINE)


def licence(name: str) -> str:
    """Return what an installed package says of its licence, '' for nothing."""
    if name in STATED:
        return STATED[name]
    says = metadata.metadata(name)
    classifiers = [
        one.rsplit(' :: ', 1)[-1]
        for one in says.get_all('Classifier') or ()
        if one.startswith('License :: ') and not one.endswith('OSI Approved')
    ]
    field = (says.get('License') or '').strip().split('\n')[0]
    return (
        says.get('License-Expression')
        or ', '.join(classifiers)
        or field
        or of_ros(ROS_NAMES.get(name, name.removeprefix('ros-').replace('-', '_')))
    )


def of_ros(name: str) -> str:
    """Return the licences in the package.xml of a ROS package, '' for none."""
    path = Path(sys.prefix) / f'share/{name}/package.xml'
    if not path.exists():
        return ''
    return ', '.join(one.text or '' for one in ElementTree.parse(path).iter('license'))


def page() -> str:
    """Return the page."""
    parts = [HEAD]
    for lock, about in LOCKS.items():
        under: dict[str, list[str]] = defaultdict(list)
        for name in packages(lock):
            under[licence(name)].append(name)
        rows = (f'| {each} | {", ".join(under[each])} |' for each in sorted(under))
        parts.append(
            '\n'.join([f'## {about}', '', '| licence | packages |', '|---|---|', *rows, ''])
        )
    return '\n'.join(parts)


if __name__ == '__main__':
    PAGE.write_text(page(), encoding='utf-8')

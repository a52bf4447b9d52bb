# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find packages and executables by the ament index, as ROS 2 does.

For each package, a prefix in AMENT_PREFIX_PATH has a marker file in
`share/ament_index/resource_index/packages/`, data in `share/<package>/` and executables in
`lib/<package>/`.
"""

import os
from pathlib import Path

from lta_config.errors import BadInput, unknown_name_error

AMENT_INDEX = Path('share/ament_index/resource_index')
PACKAGE_MARKERS = AMENT_INDEX / 'packages'
MIDDLEWARES = AMENT_INDEX / 'rmw_typesupport'
OUR_PREFIX = 'lta_'


def list_prefixes() -> list[Path]:
    """Return the prefixes of the index; earlier ones override later ones."""
    return [Path(item) for item in os.environ.get('AMENT_PREFIX_PATH', '').split(':') if item]


def find_package_prefix(package: str) -> Path:
    """
    Return the prefix in which a package is installed.

    Raises `BadInput` if no prefix has the package.
    """
    # The first prefix wins, so an overlay hides its underlay
    for prefix in list_prefixes():
        if (prefix / PACKAGE_MARKERS / package).is_file():
            return prefix
    if not package.startswith(OUR_PREFIX.strip('_')):
        raise BadInput(
            f"The package '{package}' is not installed here; install it (of ROS 2 Jazzy: sudo apt "
            f'install ros-jazzy-{package.replace("_", "-")}), or source the workspace that has it.'
        )
    ours = list_resources(PACKAGE_MARKERS, OUR_PREFIX)
    # Offer only our packages: a ROS installation has hundreds
    if ours:
        raise unknown_name_error('package', package, ours)
    raise BadInput(
        f"The package '{package}' is not in AMENT_PREFIX_PATH, and no other LTA package is; "
        'build the workspace (make build) and source its setup file.'
    )


def list_resources(folder: Path, prefix: str) -> list[str]:
    """Return the entries of an index folder that start with `prefix`, over all prefixes."""
    names = {path.name for item in list_prefixes() for path in (item / folder).glob(f'{prefix}*')}
    return sorted(names)


def list_middlewares() -> list[str]:
    """Return the installed RMW implementations."""
    # rmw_implementation selects one of the others at run time
    return [name for name in list_resources(MIDDLEWARES, 'rmw_') if name != 'rmw_implementation']


def find_executable(package: str, executable: str) -> Path:
    """
    Return the path of a package's executable, as `ros2 run` finds it.

    Raises `BadInput` with the known executables if there is no such one.
    """
    folder = find_package_prefix(package) / 'lib' / package
    path = folder / executable
    if path.is_file() and os.access(path, os.X_OK):
        return path
    files = sorted(folder.glob('*')) if folder.is_dir() else []
    names = [item.name for item in files if item.is_file() and os.access(item, os.X_OK)]
    if not names:
        raise BadInput(
            f"The package '{package}' has no executables in {folder}; build the workspace again "
            'with make.'
        )
    raise unknown_name_error(f'executable of {package}', executable, names)

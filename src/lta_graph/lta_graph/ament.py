"""
The ament index: where packages and their executables are, as ROS 2 itself finds them.

Every prefix in AMENT_PREFIX_PATH holds a marker file a package in
`share/ament_index/resource_index/packages/`, its data in `share/<package>/` and its executables in
`lib/<package>/`.
"""

import os
from pathlib import Path

from lta_config.errors import BadInput, unknown_name

INDEX = Path('share/ament_index/resource_index')
MARKERS = INDEX / 'packages'
MIDDLEWARES = INDEX / 'rmw_typesupport'
OURS = 'lta_'


def list_prefixes() -> list[Path]:
    """Return the prefixes of the index, the overriding ones first."""
    return [Path(item) for item in os.environ.get('AMENT_PREFIX_PATH', '').split(':') if item]


def find_package_prefix(package: str) -> Path:
    """
    Return the prefix that a package is installed in.

    Raises
    ------
    BadInput
        If no prefix has the package.

    """
    for prefix in list_prefixes():
        if (prefix / MARKERS / package).is_file():
            return prefix
    ours = list_resources(MARKERS, OURS)
    if ours:
        raise unknown_name('package', package, ours)
    raise BadInput(
        f"Package '{package}' is not in AMENT_PREFIX_PATH, nor is any other of LTA; "
        'build the workspace (make build) and source its setup file.'
    )


def list_resources(folder: Path, prefix: str) -> list[str]:
    """Return the names in one folder of the index that begin with a prefix, in all prefixes."""
    found = {path.name for item in list_prefixes() for path in (item / folder).glob(f'{prefix}*')}
    return sorted(found)


def list_middlewares() -> list[str]:
    """Return the ROS middlewares that are installed."""
    return [name for name in list_resources(MIDDLEWARES, 'rmw_') if name != 'rmw_implementation']


def find_package_share(package: str) -> Path:
    """Return the folder with a package's data."""
    return find_package_prefix(package) / 'share' / package


def find_executable(package: str, executable: str) -> Path:
    """
    Return the path of a package's executable, as `ros2 run` finds it.

    Raises
    ------
    BadInput
        If the package has no such executable; those that it has are listed.

    """
    folder = find_package_prefix(package) / 'lib' / package
    path = folder / executable
    if path.is_file() and os.access(path, os.X_OK):
        return path
    files = sorted(folder.glob('*')) if folder.is_dir() else []
    names = [item.name for item in files if item.is_file() and os.access(item, os.X_OK)]
    if not names:
        raise BadInput(f"Package '{package}' has no executables in {folder}; build it again.")
    raise unknown_name(f'executable of {package}', executable, names)

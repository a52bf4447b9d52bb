# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Check the software: wheels, their versions, the workspace, a browser."""

from importlib import metadata
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys

from lta_bridge.hardware.check_result import HardwareCheck
from lta_cli.without_ros import is_wheel_without_graph
from lta_config.machine import find_cache_folder, list_cache_bases

MODULES = (
    'sensor_msgs', 'lta_msgs.msg', 'tf2_msgs.msg', 'numpy', 'scipy', 'numba', 'pydantic', 'yaml',
    'mcap', 'plotly',
)  # fmt: skip
OWN_PACKAGES = ('analysis', 'bridge', 'config', 'control', 'energy', 'graph', 'sim', 'vlc')
BROWSERS = ('chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable')
IMPORT_PATIENCE = 60.0  # s; the first import after an installation reads from a cold disk cache
MAKE_AGAIN = "Run 'make build'; if the problem remains, 'make clean' and then 'make build'."


def check_dependency_imports() -> HardwareCheck:
    """Check that the dependencies can be imported; a subprocess survives a crashing library."""
    # Print each name before its import: the last one printed is the one that failed
    modules = MODULES if is_wheel_without_graph() else ('rclpy', *MODULES)
    script = '; '.join(f'print({module!r}, flush=True); import {module}' for module in modules)
    result = subprocess.run(
        # -P: no module is taken from the current folder
        [sys.executable, '-P', '-c', script],
        capture_output=True,
        text=True,
        timeout=IMPORT_PATIENCE,
    )
    if result.returncode != 0:
        module = result.stdout.split()[-1]
        why = (result.stderr.strip().splitlines() or [f'exit status {result.returncode}'])[-1]
        return HardwareCheck('wheels', 'fail', f'cannot import {module}: {why}', MAKE_AGAIN)
    text = f'{len(modules)} of {len(modules)} Python packages can be imported'
    return HardwareCheck('wheels', 'ok', text)


def read_version_pins(constraints: Path) -> dict[str, str]:
    """Return the versions that a constraints file pins, by normalised name."""
    lines = (line.split('#')[0].strip() for line in constraints.read_text().splitlines())
    pairs = (line.split('==') for line in lines if '==' in line)
    return {_normalize_name(name): version for name, version in pairs}


def _normalize_name(name: str) -> str:
    # Name normalisation of PEP 503
    return re.sub(r'[-_.]+', '-', name).lower()


def check_dependency_versions(
    constraints: Path = Path(sys.prefix).parent / 'constraints.txt',
) -> HardwareCheck:
    """Check that the installed versions are the ones that LTA was tested with."""
    if not constraints.is_file():
        text = f'versions not compared: {sys.prefix} was not created by "make build"'
        return HardwareCheck('versions', 'ok', text)
    pins = read_version_pins(constraints)
    # A pinned package that is not installed is fine: only the tests need it. Records without
    # INSTALLER come from inside the ROS wheels, not from pip, and report other versions.
    installed = {
        _normalize_name(item.name): item.version
        for item in metadata.distributions()
        if _normalize_name(item.name) in pins and item.read_text('INSTALLER')
    }
    other = [
        f'{name} {version} is installed, LTA was tested with {pins[name]}'
        for name, version in installed.items()
        if version != pins[name]
    ]
    if other:
        return HardwareCheck('versions', 'warn', '; '.join(other), MAKE_AGAIN)
    return HardwareCheck(
        'versions', 'ok',
        f'{len(installed)} Python packages have the version that LTA was tested with',
    )  # fmt: skip


def check_workspace_packages() -> HardwareCheck:
    """Check that the workspace is built and its packages are in the ament index."""
    prefixes = [Path(path) for path in os.environ.get('AMENT_PREFIX_PATH', '').split(':') if path]
    # Marker files of the ament resource index, one per package
    index = Path('share/ament_index/resource_index/packages')
    missing = [
        f'lta_{name}'
        for name in OWN_PACKAGES
        if not any((prefix / index / f'lta_{name}').is_file() for prefix in prefixes)
    ]
    if missing:
        text = f'packages missing in the ament index: {", ".join(missing)}'
        return HardwareCheck('packages', 'fail', text, MAKE_AGAIN)
    return HardwareCheck(
        'packages',
        'ok',
        f'{len(OWN_PACKAGES)} of {len(OWN_PACKAGES)} LTA packages in the ament index',
    )


def check_cache_folder() -> HardwareCheck:
    """Check that compiled kernels can be kept."""
    folder = find_cache_folder('kernels')
    if not any(folder.is_relative_to(base) for base in list_cache_bases()):
        return HardwareCheck(
            'cache', 'warn',
            f'neither XDG_CACHE_HOME nor ~/.cache is writable; compiled kernels are in {folder} '
            'and are lost with the temporary files',
            'Set XDG_CACHE_HOME to a folder that you can write.',
        )  # fmt: skip
    return HardwareCheck('cache', 'ok', str(folder))


def check_browser() -> HardwareCheck:
    """Check for Chromium, which renders the figures of a page as PNG."""
    for name in BROWSERS:
        if (path := shutil.which(name)) is not None:
            return HardwareCheck('browser', 'ok', path)
    return HardwareCheck(
        'browser',
        'warn',
        'Chromium not found; HTML reports can be written, PNG files of figures cannot',
        'Install Chromium (Debian, Ubuntu: sudo apt install chromium).',
    )

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Collect a bag's provenance: everything needed to repeat the flight."""

from collections.abc import Mapping
from datetime import datetime, UTC
import hashlib
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
import platform
import subprocess

from lta_config.files import find_file, load_yaml, parse_yaml, share_folder
from lta_config.python_file import is_strategy_file
from lta_config.version import VERSION
import yaml

CODE = (':/src', ':/config')  # folders that affect results, unlike documentation
COMMIT_FILE = 'commit'  # written by tools/wheel.sh
LIBRARIES = ('numpy', 'scipy', 'numba', 'mcap', 'ros-jazzy-rclpy')


def read_commit() -> str:
    """Return the commit of the workspace or wheel, or 'unknown'; '-dirty' if code changed."""
    noted = share_folder() / COMMIT_FILE
    if noted.is_file():
        # A wheel is outside its repository, and may be installed inside another one
        return noted.read_text(encoding='utf-8').strip()
    try:
        name = _run_git('describe', '--always', '--abbrev=40')
        changed = _run_git('status', '--porcelain', '--untracked-files=no', '--', *CODE)
    except (OSError, subprocess.SubprocessError):
        return 'unknown'
    return f'{name}-dirty' if changed else name


def _run_git(*words: str) -> str:
    """Return the output of a git command; raise as `subprocess.run` does."""
    done = subprocess.run(
        # No lock on the index: several flights may start at once
        ['git', '--no-optional-locks', *words],
        cwd=share_folder(),
        capture_output=True,
        text=True,
        timeout=5.0,  # s
        check=True,
    )
    return done.stdout.strip()


def hash_config(folder: Path) -> str:
    """Return one SHA-256 over the names and contents of all configuration files in a folder."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob('*.yaml')):
        # Names too, so that a renamed file changes the hash
        digest.update(str(path.relative_to(folder)).encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def describe_environment() -> dict[str, str]:
    """Return versions, commit, configuration and machine of this process."""
    return {
        'lta': VERSION,
        'commit': read_commit(),
        'config_sha256': hash_config(share_folder()),
        'created': datetime.now(UTC).isoformat(timespec='seconds'),
        'platform': f'{platform.platform()} Python {platform.python_version()}',
        'libraries': ' '.join(filter(None, map(find_release, LIBRARIES))),
    }


def find_release(name: str) -> str:
    """Return a library's name and version; empty if it is not installed, as ROS may not be."""
    try:
        return f'{name} {version(name)}'
    except PackageNotFoundError:
        return ''


def collect_provenance(vehicle: str, scenario: str, gains: str, **choices: str) -> dict[str, str]:
    """
    Return the provenance to store in a bag.

    Parameters
    ----------
    vehicle, scenario, gains : str
        Names or paths; the whole files are stored in the bag.
    choices : str
        Other choices: seed, strategy, time. A strategy from a file is stored as well.

    """
    own = {}
    if is_strategy_file(strategy := choices.get('strategy', '')):
        own['strategy_file'] = Path(strategy).read_text(encoding='utf-8')
    return {
        'vehicle': vehicle,
        'scenario': scenario,
        'gains': gains,
        **choices,
        **own,
        **describe_environment(),
        'vehicle_file': read_whole_vehicle(vehicle),
        'scenario_file': find_file('scenario', scenario).read_text(encoding='utf-8'),
        'gains_file': find_file('gains', gains).read_text(encoding='utf-8'),
    }


def read_whole_vehicle(name: str) -> str:
    """Return the text of a vehicle file, with the content of aero and cell files of the user."""
    path = find_file('vehicle', name)
    text = path.read_text(encoding='utf-8')
    content = parse_yaml(text, str(path))
    aero, array = content.get('aero'), content.get('energy', {}).get('array') or {}
    own = False
    # Who reads the recording opens no file that it names
    if isinstance(aero, str) and '.' in aero:
        content['aero'], own = load_yaml(find_file('aero', aero))['aero'], True
    if isinstance(cell := array.get('cell'), str) and '.' in cell:
        array['cell'], own = load_yaml(find_file('cell', cell)), True
    return yaml.safe_dump(content, sort_keys=False) if own else text


def merge_provenance(origins: Mapping[str, Mapping[str, str]]) -> dict[str, str]:
    """
    Return the origin of a bag of several robots.

    Parameters
    ----------
    found : mapping
        The origin of each robot's part, by its namespace.

    Returns
    -------
    dict of str to str
        Values shared by all robots under their own keys, others as 'lta2/seed'. 'robots' lists
        the names of the robots, separated by spaces.

    """
    first = next(iter(origins.values()))
    # The times of creation differ by seconds only; keep one
    every = [{**origin, 'created': first['created']} for origin in origins.values()]
    keys = dict.fromkeys(key for origin in every for key in origin)
    merged = {'robots': ' '.join(origins)}
    for key in keys:
        values = {origin.get(key) for origin in every}
        # Equal for all robots: store it once, without a prefix
        if len(values) == 1:
            merged[key] = first[key]
            continue
        merged |= {
            f'{robot}/{key}': origin[key] for robot, origin in origins.items() if key in origin
        }
    return merged


def extract_robot_origin(origin: Mapping[str, str], robot: str) -> dict[str, str]:
    """Return the origin of one robot in a bag, as if the bag held only this robot."""
    if 'robots' not in origin:
        return dict(origin)
    shared = {key: value for key, value in origin.items() if '/' not in key and key != 'robots'}
    mark = f'{robot}/'
    own = {key.removeprefix(mark): value for key, value in origin.items() if key.startswith(mark)}
    return {**shared, **own}

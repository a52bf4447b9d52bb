# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Check the machine: Python, platform, disk, cores, memory."""

import os
from pathlib import Path
import platform as host
import shutil
import sys

from lta_bridge.hardware.check_result import grade_value, HardwareCheck, MEGABYTE
from lta_config.machine import count_cores

OLDEST_PYTHON, NEWEST_PYTHON = (3, 11), (3, 14)  # as in the Makefile; a test compares


def check_python_version(version: tuple[int, int] = sys.version_info[:2]) -> HardwareCheck:
    """Check the version of the running interpreter."""
    text = f'{host.python_version()} ({sys.executable})'
    if not OLDEST_PYTHON <= version <= NEWEST_PYTHON:
        oldest, newest = ('.'.join(map(str, bound)) for bound in (OLDEST_PYTHON, NEWEST_PYTHON))
        remedy = f'LTA needs Python {oldest} to {newest}; run: make PYTHON=/path/to/python'
        return HardwareCheck('python', 'fail', text, remedy)
    return HardwareCheck('python', 'ok', text)


def check_platform() -> HardwareCheck:
    """Check the operating system and the processor."""
    text = f'{host.system()} {host.release()}, {host.machine()}'
    if (host.system(), host.machine()) != ('Linux', 'x86_64'):
        remedy = 'The ROS 2 wheels need Linux on x86-64; use such a machine or container.'
        return HardwareCheck('platform', 'fail', text, remedy)
    return HardwareCheck('platform', 'ok', text)


def check_disk_space(runs: Path = Path('runs')) -> HardwareCheck:
    """Check the disk space for recordings; a flight takes some tens of megabytes."""
    # `runs` may not exist yet: use the nearest existing parent
    folder = next(path for path in (runs.absolute(), *runs.absolute().parents) if path.is_dir())
    free = shutil.disk_usage(folder).free / MEGABYTE
    text = f'{free:.0f} MB free on the disk of {runs.absolute()}'
    if not os.access(folder, os.W_OK):
        return HardwareCheck(
            'disk',
            'fail',
            f'{folder} is not writable',
            'Run lta in a folder that you can write to.',
        )
    return grade_value(
        'disk', free, 2000.0, 200.0, text, 'Delete old recordings, or work on another disk.'
    )


def check_processor_cores() -> HardwareCheck:
    """Check the processor cores that this process may use."""
    count = count_cores()
    text = f'{count} cores, load {os.getloadavg()[0]:.1f}'
    remedy = (
        'A flight runs seven nodes and is slow on one core; use two cores or more, or one process '
        'for all nodes (--processes one, processes:=one).'
    )
    return grade_value('cores', count, 2, 1, text, remedy)


def check_available_memory(table: Path = Path('/proc/meminfo')) -> HardwareCheck:
    """Check the memory available; the whole graph takes about 1 GB."""
    lines = dict(line.split(':', 1) for line in table.read_text().splitlines())
    # The value is in kB; MemAvailable includes caches that can be freed
    free = int(lines['MemAvailable'].split()[0]) * 1024 / MEGABYTE
    text = f'{free:.0f} MB available'
    return grade_value('memory', free, 1500.0, 500.0, text, 'Close other programs before you fly.')

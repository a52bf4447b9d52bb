"""
Is there room in shared memory, and what have killed nodes left in it.

Fast DDS keeps a file for each participant (fastrtps_ and 16 digits) and for each port
(fastrtps_port7411, with a semaphore sem.fastrtps_port7411_mutex), and beside it a file that its
owner locks for as long as it lives: _el for one, _sl for several. A node that is killed leaves all
of them; once they are many, the memory is full, and nodes fall back on UDP or fail.
"""

import os
from pathlib import Path
import re
import shutil
import sys
from typing import Final

from lta_analysis.doctor.check import Check, graded, MEGABYTE

FOLDER: Final = Path('/dev/shm')
LOCKS: Final = Path('/proc/locks')
LOCK: Final = re.compile(r'(?P<file>fastrtps_([0-9a-z]{16}|port\d{1,5}))_[es]l')
HELD: Final = re.compile(r'[0-9a-f]+:[0-9a-f]+:(\d+) ')  # device and inode
TOOL: Final = 'fastdds'  # of Fast DDS itself


def room(folder: Path = FOLDER) -> Check:
    """Check the room in shared memory, through which Fast DDS sends on one machine."""
    if not folder.is_dir():
        return Check(
            'shared memory',
            'warn',
            f'{folder} is not there; Fast DDS sends over UDP instead, which is slower',
            f'Mount a tmpfs on {folder}.',
        )
    free = shutil.disk_usage(folder).free / MEGABYTE
    left = stale(folder)
    found = f'{free:.0f} MB free in {folder}'
    if not left:
        remedy = f'Enlarge {folder} (--shm-size=256m where a container has it).'
        return graded('shared memory', free, 50.0, 10.0, found, remedy)
    size = sum(file.stat().st_size for file in left) / MEGABYTE
    state = graded('shared memory', free, 50.0, 10.0, '', '').state
    return Check(
        'shared memory',
        'warn' if state == 'ok' else state,
        f'{found}; killed nodes left {len(left)} files ({size:.0f} MB) there',
        f"Run '{tool()} shm clean': it removes them, and none of a node that runs.",
    )


def tool() -> str:
    """Return how to call the tool of Fast DDS that cleans up, which comes with it."""
    beside = Path(sys.prefix) / 'bin' / TOOL
    return str(beside) if beside.is_file() else TOOL


def stale(folder: Path, locks: Path = LOCKS) -> list[Path]:
    """
    Return the files of Fast DDS whose owner is gone, in alphabetical order.

    An owner holds its lock, which the kernel tells without touching it. One in another container
    may share the memory and not be told of: the tool that removes tries each lock once more.
    """
    try:
        held = set(HELD.findall(locks.read_text()))
    except OSError:  # a kernel that does not tell
        return []
    found: set[Path] = set()
    with os.scandir(folder) as entries:
        for entry in entries:
            match = LOCK.fullmatch(entry.name)
            if match and str(entry.inode()) not in held:
                name = match['file']
                found |= {folder / entry.name, folder / name, folder / f'sem.{name}_mutex'}
    return sorted(file for file in found if file.exists())

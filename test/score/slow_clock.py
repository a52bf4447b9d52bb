"""Let time pass more slowly for trials: a busy machine then keeps up with flights in real time."""

import os
from pathlib import Path
import subprocess
import time
from typing import Final

SOURCE: Final = Path(__file__).with_suffix('.c')
FACTOR: Final = 'LTA_SLOWER'


def get_factor() -> int:
    """Return by how much time is slower for the trials, 1 for not at all."""
    return int(os.environ.get(FACTOR, '1'))


def slow_down(factor: int, folder: Path) -> None:
    """Slow down time in all processes that this one starts from now on; the folder is kept."""
    if factor == 1:
        return
    folder.mkdir(parents=True, exist_ok=True)
    library = folder.resolve() / 'slow_clock.so'
    words = ['gcc', '-shared', '-fPIC', '-O2', '-Wall', '-Wextra', '-o', library, SOURCE, '-ldl']
    subprocess.run(words, check=True)
    since = str(time.time_ns())
    os.environ |= {FACTOR: str(factor), 'LTA_SLOW_SINCE': since, 'LD_PRELOAD': str(library)}

"""
Measure what a person waits for: whole commands, from the shell script to the end.

`command.*` is processor time, of all processes, with a filled cache; `_wall` is time on the wall,
which counts on an idle machine only, and `_cold` processor time with an empty cache, so that
everything is compiled. The flight is seed 1 of GT-MAB in the lamp room, 22 s with calibration.
"""

from functools import partial
import os
from pathlib import Path
import resource
import subprocess
import tempfile
import time

from bench import Figure

LTA = Path(__file__).resolve().parents[2] / 'lta'
COMMANDS = {
    'help': ('--help',),
    'simulate': ('simulate',),
    'fly': ('fly',),
    'fly_one': ('fly', '--processes', 'one'),
}


def run(words: tuple[str, ...], cache: Path | None = None) -> tuple[float, float]:
    """Run a command in an empty folder; return its processor time and its wall time. [s]"""
    environment = dict(os.environ) | ({} if cache is None else {'XDG_CACHE_HOME': str(cache)})
    with tempfile.TemporaryDirectory() as folder:
        spent, begin = children_time(), time.monotonic()
        subprocess.run([LTA, *words], cwd=folder, env=environment, check=True, capture_output=True)
        return children_time() - spent, time.monotonic() - begin


def children_time() -> float:
    """Return the processor time of all processes that ended and were waited for. [s]"""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def cold() -> float:
    """Return the processor time of the first flight of all. [s]"""
    with tempfile.TemporaryDirectory() as cache:
        return run(COMMANDS['simulate'], Path(cache))[0]


def figures() -> list[Figure]:
    """Return what is measured here."""
    return [
        *(
            Figure(
                f'command.{name}{suffix}',
                's',
                partial(lambda words, index: run(words)[index], words, index),
                rounds=3,
                choose=min,
            )
            for name, words in COMMANDS.items()
            for index, suffix in enumerate(('', '_wall'))
        ),
        Figure('command.simulate_cold', 's', cold, rounds=1, choose=min),
    ]

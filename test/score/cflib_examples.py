"""
Run cflib's published examples unchanged, each against a fresh drone.

    python test/score/cflib_examples.py EXAMPLES [PROGRAM]

EXAMPLES is a folder of them, of a checkout of bitcraze/crazyflie-lib-python (GPL: beside this
repository, not in it). They fly the emulated drone, or PROGRAM: a build of the real firmware for
Linux, which `make real-firmware` leaves in runs/firmware. Left out are those that need several
drones, a window or a device; every other script that takes its address from CFLIB_URI is run.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import os
from pathlib import Path
import shutil
import subprocess
import sys
import tempfile
from typing import Final

import add_paths  # noqa: F401
from linux_crazyflie import Process
from lta_emulation.crazyflie.body import BenchBody
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.firmware_build import AS_SOLD
from lta_emulation.crazyflie.server import CrazyflieServer

PATIENCE: Final = 120.0  # s
LEFT_OUT: Final = {
    'sbs_swarm': 'several drones',
    'persistent_params_from_file': 'asks for a file in a window',
}


@contextmanager
def start_drone(program: Path | None) -> Iterator[str]:
    """Start a drone, and yield its URI."""
    if program is None:
        with CrazyflieServer(Firmware(BenchBody(), build=AS_SOLD)) as server:
            yield server.uri
    else:
        with Process(program) as process:
            yield process.uri


def run_example(script: Path, program: Path | None) -> str:
    """Return how an example ends, in words."""
    with start_drone(program) as uri:
        try:
            done = subprocess.run(
                [sys.executable, script.name],
                cwd=script.parent,
                env=os.environ | {'CFLIB_URI': uri},
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                timeout=PATIENCE,
            )
        except subprocess.TimeoutExpired:
            return f'does not end within {PATIENCE:.0f} s'
    last = (done.stdout + done.stderr).strip().splitlines() or ['']
    return 'runs' if done.returncode == 0 else f'ends with {done.returncode}: {last[-1]}'


def main() -> int:
    """Print a line for each example; return 1 unless all run."""
    program = Path(sys.argv[2]) if len(sys.argv) > 2 else None
    ends = {}
    with tempfile.TemporaryDirectory() as folder:
        # cflib caches tables of contents beside a script; those there would be another drone's
        copy = shutil.copytree(
            sys.argv[1], Path(folder) / 'examples', ignore=shutil.ignore_patterns('cache')
        )
        for script in sorted(copy.rglob('*.py')):
            if script.stem in LEFT_OUT or 'uri_from_env' not in script.read_text():
                continue
            ends[script.stem] = run_example(script, program)
            sys.stdout.write(f'{script.stem}: {ends[script.stem]}\n')
            sys.stdout.flush()
    sys.stdout.write(f'{list(ends.values()).count("runs")} of {len(ends)} run\n')
    return int(set(ends.values()) != {'runs'})


if __name__ == '__main__':
    sys.exit(main())

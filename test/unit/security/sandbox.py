# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A place in which `lta` meets hostile files: bounded, and watched for what it leaves behind.

Run as a program it is the process that has all verbs loaded and forks one for each command.
"""

from dataclasses import dataclass
import gc
import importlib
import json
import os
from pathlib import Path
import resource
import signal
import subprocess
import sys
import traceback
import unicodedata

from lta_graph.terminal_streams import guard_streams

MEMORY = 1_000_000  # kB that any verb may take for any hostile file, beyond what it takes to load
DISK = 1 << 28  # bytes of a file that it may write
STREAMS = {1: '.out', 2: '.err'}
LOADED = ['lta_cli.app', 'lta_data.importers.run', 'lta_data.export.run', 'lta_analysis.plot']
LOADED += [f'lta_analysis.{name}' for name in ('bags', 'door', 'flights', 'vehicles')]
LOADED += ['lta_analysis.checked_bags', 'lta_flight.simulate']
LOADED += ['lta_flight.report.page', 'lta_vehicle.difference', 'lta_vehicle.views.report']
LOADED += ['lta_bridge.description.urdf', 'lta_vehicle.trim', 'pandas']
# Requests import their reports when they run
STUDIES = 'lta_analysis.comparison.request lta_studies.cfd.request lta_studies.light.plan.request'
STUDIES += ' lta_studies.mission.run lta_flight.replay.run lta_flight.sweep.run'
LOADED += ['lta_cli.request_command', *STUDIES.split()]
LOADED += [f'{name.rpartition(".")[0]}.report' for name in STUDIES.split()]


@dataclass(frozen=True)
class Outcome:
    """What became of a command: status, both streams, memory beyond loading [kB]."""

    status: int
    out: str
    err: str
    grown: int


def find_control(text):
    """Return the characters of a text that act on a terminal, but for line breaks and tabs."""
    found = {c for c in text if unicodedata.category(c) in ('Cc', 'Cf', 'Cs', 'Zl', 'Zp')}
    return found - {'\n', '\t'}


class Sandbox:
    """Forks commands from one process; `with Sandbox() as sandbox: sandbox.run(words, folder)`."""

    def __enter__(self):
        environment = os.environ | {'PYTHONPATH': os.pathsep.join(sys.path), 'COLUMNS': '200'}
        self._server = subprocess.Popen(
            [sys.executable, __file__],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        return self

    def __exit__(self, *_):
        self._server.stdin.close()
        self._server.wait()
        self._server.stdout.close()

    def run(self, words, folder):
        """Run one command line in a folder, in a process of its own; one that hangs is ended."""
        from waiting import PATIENCE  # not where this runs as a program, which loads but verbs

        order = {'words': list(map(str, words)), 'folder': str(folder), 'patience': PATIENCE}
        self._server.stdin.write(json.dumps(order) + '\n')
        self._server.stdin.flush()
        told = json.loads(self._server.stdout.readline())
        places = [Path(folder, name) for name in STREAMS.values()]
        streams = [place.read_text(errors='replace') for place in places]
        for place in places:
            place.unlink()
        return Outcome(told['status'], *streams, told['grown'])


def serve():
    """Fork a process for each order on stdin, and tell on stdout what became of it."""
    for name in LOADED:
        importlib.import_module(name)
    pages = int(Path('/proc/self/statm').read_text().split()[1])
    loaded = pages * resource.getpagesize() // 1024
    gc.freeze()  # a child that looked through all that is loaded would copy it
    for line in sys.stdin:
        order = json.loads(line)
        child = os.fork()
        if child == 0:
            signal.alarm(round(order['patience']))
            command(order['words'], order['folder'])
        _, status, used = os.wait4(child, 0)
        told = {
            'status': os.waitstatus_to_exitcode(status),
            'grown': used.ru_maxrss - loaded,
        }
        sys.stdout.write(json.dumps(told) + '\n')
        sys.stdout.flush()


def command(words, folder):
    """Run a command line as `lta` does, within bounds, and end this process."""
    os.chdir(folder)
    for number, name in STREAMS.items():
        os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    resource.setrlimit(resource.RLIMIT_FSIZE, (DISK, DISK))
    sys.argv = ['lta', *words]
    guard_streams()  # as `lta` does first
    try:
        from lta_cli.app import run_command_line

        code = run_command_line()
    except BaseException:
        traceback.print_exc()
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


if __name__ == '__main__':
    serve()

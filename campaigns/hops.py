# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
List the source files that a message enters, from its callback in a node to what is published.

A graph flies in one process, with compiled functions as Python. A reader who follows a message
through a node opens these files; generated messages are not counted.
"""

from argparse import ArgumentParser, Namespace
import atexit
from collections import defaultdict
from collections.abc import Iterator
from contextlib import suppress
import json
import os
from pathlib import Path
import signal
import subprocess
import sys
import tempfile
from types import FrameType
from typing import Any, Final

from lta_report.formatting import format_markdown_table

from campaigns.harness import Campaign, Case, Row, Rows

ARGUMENTS: Final = ('fly', 'record:=false', 'time:=lockstep')
# What a reader asks: from a topic to the next, by node and topic of the callback
PATHS: Final = {
    'from odom to the duties': ('controller',),
    'from a block of light to the setpoint': ('demodulator', 'navigator'),
}
FRAME: Final = '/ros/'  # the node's own frame: delivery, checks of messages, publishing
DOMAIN: Final = '77'  # where nobody else flies
Entered = dict[str, set[str]]  # files by node and callback


def trace(out: str) -> None:
    """Fly a graph, and write which files each callback of a node enters."""
    from lta_graph.ros import one_process

    entered: Entered = defaultdict(set)
    stack: list[tuple[FrameType, str]] = []  # the callback that runs

    def look(frame: FrameType, event: str, _: Any) -> None:
        path = frame.f_code.co_filename
        if event == 'call' and '/lta_' in path and '/lta_msgs/' not in path:
            if not stack and '/nodes/' in path and frame.f_code.co_name.startswith('_on_'):
                node = Path(path).stem
                stack.append((frame, f'{node}.{frame.f_code.co_name}'))
            if stack:
                entered[stack[-1][1]].add(path[path.rindex('/lta_') + 1 :])
        elif event == 'return' and stack and stack[-1][0] is frame:
            stack.pop()

    def write() -> None:
        sys.setprofile(None)
        content = {name: sorted(files) for name, files in entered.items()}
        Path(out).write_text(json.dumps(content), encoding='utf-8')

    atexit.register(write)
    sys.argv = ['one_process', *ARGUMENTS]
    sys.setprofile(look)
    one_process.main()


def run(case: Case, options: Namespace) -> Row:
    """Return the files that each callback enters."""
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / 'entered.json'
        graph = subprocess.Popen(
            [sys.executable, '-c', f'from campaigns.hops import trace; trace({str(out)!r})'],
            env=os.environ | {'NUMBA_DISABLE_JIT': '1', 'ROS_DOMAIN_ID': DOMAIN},
            stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        with suppress(subprocess.TimeoutExpired):
            graph.wait(options.seconds)
        graph.send_signal(signal.SIGINT)
        said = graph.communicate()[1]
        if not out.exists():
            return {'wrong': said[-500:]}
        return {'entered': json.loads(out.read_text(encoding='utf-8'))}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the number of files of each callback, and those of the paths."""
    for row in rows.values():
        entered: dict[str, list[str]] = row.get('entered', {})
        table = [
            [name, str(sum(FRAME not in one for one in files)), str(len(files))]
            for name, files in sorted(entered.items())
        ]
        yield format_markdown_table(['node and callback', 'files', "with the node's frame"], table)
        for title, nodes in PATHS.items():
            files = {
                one for name, some in entered.items() if name.partition('.')[0] in nodes
                for one in some if FRAME not in one
            }  # fmt: skip
            yield ''
            yield f'{title[0].upper()}{title[1:]}: {len(files)} files: {", ".join(sorted(files))}.'


def add_arguments(parser: ArgumentParser) -> None:
    """Add how long the graph runs."""
    parser.add_argument('--seconds', type=float, default=60.0, help='of wall time')


CAMPAIGN: Final = Campaign(lambda options: ['fly'], run, list_table, add_arguments=add_arguments)

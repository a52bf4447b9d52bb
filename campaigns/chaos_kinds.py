# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What goes wrong with a whole graph in flight, and what must then be said, and by when motors stand.

A strike is called with the trial and returns the words (a regular expression) that must be told in
/diagnostics and said on the terminal; empty where the answer to whoever does it says all.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
import math
import os
from pathlib import Path
import resource
import signal
import subprocess
import time
from typing import Any, Final

from lta_config.topics import robot_topic
from lta_graph.ros.message_validation import find_message_type
from rcl_interfaces.srv import DescribeParameters, ListParameters

from campaigns.chaos_graph import second_graph, TABLE
from campaigns.chaos_hook.sitecustomize import EXCEPTION, MEMORY, SLOW_DISK, STALL
from campaigns.chaos_spoilt import spoil, SPOILT
from campaigns.fault_kinds import CUT_OFF, LANDS, STALE
from campaigns.graph_trial import SLACK

ALL: Final = ('lockstep', 'realtime', 'hardware')
SIMULATED: Final = ('lockstep', 'realtime')
PACED: Final = ('realtime', 'hardware')
SHORT: Final = 32 << 20  # bytes that a node may still take
SPOILS: Final = 1.0  # s in which nonsense comes
EVERY: Final = 0.05  # s between two of it
FLOODS: Final = 3.0  # s
LONGEST: Final = 20.0  # s of SIGSTOP
GIVEN_UP: Final = 9.0  # s after which `lta fly` may end what stands still
STATED: Final = {  # s to motors that stand where a node's end ends the flight (fault_kinds.py)
    'crazyflie_bridge': CUT_OFF[0],
    'controller': STALE[0],
    'estimator': STALE[0],
}
ORDERLY: Final = LANDS[0] + 0.4  # s: the launcher sees the end, and the bridge lands


@dataclass(frozen=True, slots=True)
class ChaosKind:
    """One kind of fault."""

    about: str  # in the words of the table
    strike: Callable[[Any], str]  # does it to a trial, and returns what must be told
    ends: bool = False  # whether the flight ends by it; otherwise it goes on once it is over
    ways: tuple[str, ...] = ALL  # how graphs are started that it is done to
    silent: bool = False  # whether whoever does it is told by the answer alone
    latest: float = math.inf  # until when the flight goes on for long enough [s of flight]


def killed(trial: Any) -> str:
    """Kill any node."""
    os.kill(trial.graph.node(trial.pick()), signal.SIGKILL)
    return f'{trial.target} was killed by SIGKILL'


def broken(trial: Any) -> str:
    """Raise an exception in any node."""
    os.kill(trial.graph.node(trial.pick()), EXCEPTION)
    # One that comes while C makes a Python message is told in pybind11's words.
    return f'{trial.target}: (state: )?broke: RuntimeError: (injected|Unable to convert)'


def stopped(trial: Any) -> str:
    """Stop any node for 1 to 20 s."""
    pid = trial.graph.node(trial.pick())
    trial.lasts = LONGEST ** trial.random.random()
    os.kill(pid, signal.SIGSTOP)
    trial.cure = lambda: os.kill(pid, signal.SIGCONT)
    trial.may_end = trial.lasts > GIVEN_UP and trial.graph.way == 'lockstep'
    return f'No messages arrive from .*{trial.target}'


def starved(trial: Any) -> str:
    """Let any node eat all memory that it may have, which is little more than it has."""
    pid = trial.graph.node(trial.pick())
    pages = int(Path(f'/proc/{pid}/statm').read_text().split()[0])
    resource.prlimit(pid, resource.RLIMIT_AS, (pages * resource.getpagesize() + SHORT,) * 2)
    os.kill(pid, MEMORY)
    return f'{trial.target}(: state)?:? (was killed by|ended with|broke)'


def filled(trial: Any) -> str:
    """Fill the disk of the bag."""
    trial.target = 'recorder'
    filler = trial.disk / 'filler'
    free = os.statvfs(trial.disk)
    with filler.open('wb') as file, suppress(OSError):  # a little less may be left
        file.write(bytes(free.f_bavail * free.f_frsize))
    return 'free disk space'


def slowed(trial: Any) -> str:
    """Let the disk of the bag stand still for some seconds."""
    trial.target, trial.lasts = 'recorder', STALL
    os.kill(trial.graph.node('recorder'), SLOW_DISK)
    return 'recorder: .*disk is slow'


def unplugged(trial: Any) -> str:
    """Pull the cable of the light board, and put it back."""
    board = trial.graph.hardware.board
    trial.target, trial.lasts, trial.cure = 'teensy_bridge', 2.0, board.toggle_cable
    board.toggle_cable()
    return 'teensy_bridge: .*plug the light board in'


def lost(trial: Any) -> str:
    """Let nothing through the air any more."""
    server = trial.graph.hardware.crazyflie
    trial.target, trial.stated = 'crazyflie_bridge', CUT_OFF[0]
    server.up.silent = server.down.silent = True
    return 'crazyflie_bridge: .*(no packets|heard|nothing)'


def jumped(trial: Any) -> str:
    """Tell another time of the clock, an hour off, for a while."""
    trial.target = '/clock'
    message = find_message_type(TABLE['/clock'])()
    message.clock.sec = 3600 if trial.random.random() < 0.5 else 0
    trial.publish('/clock', message, SPOILS)
    return 'other nodes also publish .*/clock'


def doubled(trial: Any) -> str:
    """Fly a second graph on the same domain."""
    trial.target = 'second graph'
    trial.since = time.monotonic()
    trial.stack.enter_context(second_graph(trial.graph))
    # Its nodes come one by one, over some seconds.
    names = [robot_topic('lta1', name) for name in ('imu', 'motors', 'odom', 'energy/status')]
    known = trial.peer.node.count_publishers
    trial.peer.until(lambda: not trial.graph.alive or any(known(name) > 1 for name in names))
    trial.struck, trial.may_end = time.monotonic(), True
    return 'other nodes also publish'


def flooded(trial: Any) -> str:
    """Publish on any input as fast as it goes."""
    name = trial.pick_topic()
    trial.publish(name, trial.graph.pattern(name), FLOODS, 0.0)
    return f'other nodes also publish .*{name}'


def nonsense(trial: Any) -> str:
    """Set any parameter of any node to what cannot be meant."""
    node = trial.pick()
    names = trial.peer.ask(ListParameters, f'{node}/list_parameters').result.names
    known = trial.peer.ask(DescribeParameters, f'{node}/describe_parameters', names=names)
    numbers = [each.name for each in known.descriptors if each.type == 3 and not each.read_only]
    name = trial.random.choice(numbers) if numbers else 'time'
    value = trial.random.choice([float('nan'), float('inf'), -1e300, 'nonsense'])
    trial.target = f'{node} {name} = {value}'
    trial.struck = time.monotonic()
    answer = trial.peer.set(node, name, value)
    if answer.successful:
        trial.wrong(f'{trial.target} was taken')
    if not answer.reason:
        trial.wrong(f'{trial.target} was refused without a word')
    return ''


def malformed(kind: str) -> Callable[[Any], str]:
    """Return what publishes spoilt messages on any input."""

    def strike(trial: Any) -> str:
        name = trial.pick_topic()
        pattern = trial.graph.pattern(name)
        trial.publish(name, spoil(kind, pattern), SPOILS, EVERY)
        return f'other nodes also publish .*{name}'

    return strike


KINDS: Final = {
    'killed': ChaosKind('SIGKILL', killed, ends=True),
    'stopped': ChaosKind('SIGSTOP for 1 to 20 s', stopped),
    'memory': ChaosKind('out of memory', starved, ends=True),
    'exception': ChaosKind('an exception', broken, ends=True),
    'full disk': ChaosKind('a full disk', filled, ends=True),
    'slow disk': ChaosKind('a disk that stalls for 3 s', slowed, ways=PACED),
    'light': ChaosKind('the light board unplugged', unplugged, ways=('hardware',)),
    'radio': ChaosKind('the radio lost', lost, ways=('hardware',)),
    'clock': ChaosKind('a clock that jumps by an hour', jumped, ways=SIMULATED),
    'second': ChaosKind('a second graph on the domain', doubled, ways=('realtime',), latest=5.0),
    'flood': ChaosKind('a flood on an input', flooded),
    'parameter': ChaosKind('an invalid parameter value', nonsense, silent=True),
    **{
        f'message {kind}': ChaosKind(f'messages: {about}', malformed(kind))
        for kind, (about, _) in SPOILT.items()
    },
}  # fmt: skip


def mount_small_disk(folder: Any) -> bool:
    """Mount a small disk, where we may."""
    folder.mkdir()
    command = ['mount', '-t', 'tmpfs', '-o', 'size=64m', 'tmpfs', folder]
    return subprocess.run(command, capture_output=True).returncode == 0


def limit(trial: Any) -> float:
    """Return how long motors may turn after a strike [s]."""
    stated = trial.stated or STATED.get(trial.target, ORDERLY)
    return float(stated) + SLACK

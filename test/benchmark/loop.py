"""
Measure the closed loop in one process: `python test/benchmark/loop.py` prints name, value, unit.

One flight to the lamp, flown several times on one core; the fastest counts, by the time that the
process had, since other processes share the machine. `loop.realtime` is simulated seconds a
second; the rest says where the time of a control step goes: in a flight whose parts are timed,
less what the timing costs. `loop.warm` is a whole process from its first import to its first step,
with a filled cache.
"""

from collections import defaultdict
from collections.abc import Callable
import os
from pathlib import Path
import subprocess
import sys
import time
from typing import Any

from lta_analysis.loop import Loop, Policy
from lta_config.topics import topic_table
from lta_control.gains_file import load_gains
from lta_control.strategies import strategy
from lta_sim.readings import Outcome
from lta_sim.scenario import load_scenario
from lta_sim.vehicle import load_vehicle
from lta_sim.world import World

SEED, ROUNDS = 1, 5
PARTS = {
    'sense_motion': ('world', 'sense_motion'),
    'sense_rest': ('world', 'sense_rest'),
    'light_block': ('world', '_light_block'),
    'decide': ('', '_decide'),
    'navigate': ('', '_navigate'),
    'advance': ('world', 'advance'),
}


def start() -> Loop:
    """Return a flight before its first step."""
    scenario, table = load_scenario('lamp_room'), topic_table()
    vehicle = load_vehicle('gtmab', scenario.air.density)
    policy = Policy(strategy('bag'), load_gains('gtmab'))
    return Loop(World(vehicle, scenario, table, SEED), table, policy)


def fly(loop: Loop) -> tuple[float, int]:
    """Return the time of a whole flight [s] and its steps."""
    begin, steps = time.process_time(), 1
    while loop.step() is Outcome.FLYING:
        steps += 1
    return time.process_time() - begin, steps


def realtime() -> tuple[float, float]:
    """Return simulated seconds a second, and the time of a step. [us]"""
    flights = [fly(start()) for _ in range(ROUNDS)]
    spent, steps = min(flights)
    return steps * topic_table().control_ns * 1e-9 / spent, 1e6 * spent / steps


def timed(function: Callable[..., Any], spent: list[float]) -> Callable[..., Any]:
    """Return a function that adds up its own time."""
    clock = time.perf_counter

    def run(*arguments: object) -> object:
        begin = clock()
        result = function(*arguments)
        spent[0] += clock() - begin
        return result

    return run


def split() -> dict[str, float]:
    """Return the time of each part of a step, the least of some flights. [us a step]"""
    empty, times = [0.0], defaultdict(list)
    nothing = timed(lambda: None, empty)
    for _ in range(100_000):
        nothing()
    cost = empty[0] / 100_000
    for _ in range(ROUNDS):
        loop, spent = start(), {name: [0.0] for name in PARTS}
        for name, (owner, method) in PARTS.items():
            holder = getattr(loop, owner) if owner else loop
            setattr(holder, method, timed(getattr(holder, method), spent[name]))
        _, steps = fly(loop)
        for name, (total,) in spent.items():
            calls = steps // 10 if name in ('light_block', 'navigate') else steps
            times[name].append(1e6 * (total - calls * cost) / steps)
    return {name: min(rows) for name, rows in times.items()}


def warm() -> float:
    """Return the time of a new process from import to its first step. [s]"""
    script = (
        'import sys, time; begin = time.process_time()\n'
        'import loop\n'
        'loop.start().step()\n'
        'sys.stdout.write(str(time.process_time() - begin))\n'
    )
    path = os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)])
    command = [sys.executable, '-c', script]
    environment = os.environ | {'PYTHONPATH': path}
    times = [subprocess.check_output(command, env=environment, text=True) for _ in range(3)]
    return min(map(float, times))


def main() -> None:
    """Print the table."""
    pace, step = realtime()
    parts = split()
    rows = [
        ('loop.realtime', pace, 'simulated s/s on one core'),
        ('loop.step', step, 'us per control step'),
        *((f'loop.{name}', value, 'us per control step') for name, value in parts.items()),
        ('loop.warm', warm(), 's of processor time'),
    ]
    for name, value, unit in rows:
        sys.stdout.write(f'{name:<22} {value:>14,.3f} {unit}\n')


if __name__ == '__main__':
    main()

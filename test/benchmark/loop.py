"""
Measure the closed loop in one process: how many seconds it flies in one, and where its time goes.

One flight to the lamp on one core, sensors, ADC blocks, FFT and control included. The time is what
the process had, as others share the machine. `loop.warm` is a whole process from its first import
to its first step, without the start of the interpreter and with a filled cache.
"""

from collections.abc import Callable
from functools import partial
import os
from pathlib import Path
import subprocess
import sys
import time
from typing import Any

from bench import Figure
from lta_config.topics import load_topic_table
from lta_control.gains_file import load_gains
from lta_control.strategies import find_navigation_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_stack import FlightStack
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_sim.readings import FlightOutcome
from lta_sim.world import World

SEED = 1
# Who does each part of a step; the first three are the world's, the others the drone's.
PARTS = {
    'sense_motion': lambda loop: loop.world,
    'sense_rest': lambda loop: loop.world,
    'advance': lambda loop: loop.world,
    '_estimate_and_control': lambda loop: loop,
    '_navigate': lambda loop: loop,
}
FIRST = """
import sys, time; begin = time.process_time()
import loop
loop.start().step()
sys.stdout.write(str(time.process_time() - begin))
"""


def start() -> ClosedLoop:
    """Return a flight before its first step."""
    scenario, table = load_scenario('lamp_room'), load_topic_table()
    vehicle = load_vehicle('gtmab', scenario.air.density)
    policy = FlightStack(find_navigation_strategy('bag'), load_gains('gtmab'))
    return ClosedLoop(World(vehicle, scenario, table, SEED), table, policy)


def fly(loop: ClosedLoop) -> tuple[float, int]:
    """Return the time of a whole flight [s] and its steps."""
    begin, steps = time.process_time(), 1
    while loop.step() is FlightOutcome.FLYING:
        steps += 1
    if loop.world.outcome is not FlightOutcome.REACHED:
        raise AssertionError(f'the flight ended with {loop.world.outcome}; it must reach the lamp')
    return time.process_time() - begin, steps


def realtime() -> float:
    """Return simulated seconds a second."""
    spent, steps = fly(start())
    return steps * load_topic_table().control_ns * 1e-9 / spent


def part(name: str) -> float:
    """Return the time of one part of a control step, on average. [us]"""
    loop, spent, clock = start(), [], time.process_time
    owner = PARTS[name](loop)
    function: Callable[..., Any] = getattr(owner, name)

    def timed(*arguments: object) -> object:
        begin = clock()
        result = function(*arguments)
        spent.append(clock() - begin)
        return result

    setattr(owner, name, timed)
    _, steps = fly(loop)
    return 1e6 * sum(spent) / steps


def warm() -> float:
    """Return the time of a new process from import to its first step. [s]"""
    path = os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)])
    environment = os.environ | {'PYTHONPATH': path}
    command = [sys.executable, '-c', FIRST]
    return float(subprocess.check_output(command, env=environment, text=True))


def figures() -> list[Figure]:
    """Return what is measured here."""
    parts = [
        Figure(f'loop.{name.lstrip("_")}', 'us of a control step', partial(part, name), choose=min)
        for name in PARTS
    ]
    return [
        Figure('loop.realtime', 's/s', realtime),
        *parts,
        Figure('loop.warm', 's', warm, rounds=4, choose=min),
    ]

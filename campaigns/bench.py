# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Measure speeds of LTA on this machine.

All figures are sampled turn about over the whole run and the best sample of each counts (the
median of the graph's), so that other work on the machine spoils them least. Rates are by processor
time, those of the graph by the wall clock.
"""

from argparse import Namespace
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, partial
import os
from pathlib import Path
import resource
import statistics
import subprocess
import tempfile
import time
from typing import Any, Final

import lta_analysis
from lta_config.machine import count_cores
from lta_config.topics import load_topic_table
from lta_control.laws import load_gains
from lta_control.strategies import find_navigation_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight import fly_once
from lta_flight.flight_spec import load_spec
from lta_flight.flight_stack import FlightStack
from lta_flight.progress import FlightProgress
from lta_flight.simulate import simulate_once
from lta_model.effects import initial_memory
from lta_model.scenario import load_scenario
from lta_model.state import pack_state
from lta_model.vehicle import load_vehicle
from lta_sim.kernels.kernel import advance
from lta_sim.readings import FlightOutcome
from lta_sim.world import World
from lta_vlc.diodes import build_even_ring
from lta_vlc.lamp import LampFinder, LampPrior
from lta_vlc.receiver import BeaconReceiver
from lta_vlc.settings import DemodulationSettings
import numpy as np
from rich.console import Console

from campaigns import ROOT
from campaigns.harness import Campaign, Case, Row, Rows

STEP: Final = 2e-3  # of the kernel [s]
DUTY: Final = np.array([0.145, 0.145, 0.2, 0.2])  # forward, and slowly up
# Wind, noise, sunlight and a cell that is not full
SURROUNDED: Final = np.array([0.1, 0.05, 0.0, 0.3, -0.2, 0.1, 300.0, 3.8, 0.02, 0.01, 0.0])
SAMPLE_RATE: Final = 10_000.0  # of each diode, as in config/topics.yaml [1/s]
SAMPLES: Final = 1000  # of a light block
BLOCKS: Final = 50
TRUTH: Final = 'ground_truth/odom'
PATHS: Final = (
    *(f'pose.pose.position.{axis}' for axis in 'xyz'),
    *(f'pose.pose.orientation.{axis}' for axis in 'xyzw'),
    *(f'twist.twist.{part}.{axis}' for part in ('linear', 'angular') for axis in 'xyz'),
)


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure, and the function that measures it."""

    unit: str
    measure: Callable[[], float]  # returns one sample; the first may be slow, as it may compile
    about: str
    choose: Callable[[Iterable[float]], float] = max  # takes the figure from the samples


def step_kernel(steps: int = 300_000) -> float:
    """Return the pace of one vehicle [steps/s]."""
    model, state = load_vehicle('gtmab').build_model(), pack_state(memory=initial_memory())
    begin = time.process_time()
    last = advance(state, model, DUTY, SURROUNDED, STEP, steps)
    taken = time.process_time() - begin
    if not np.isfinite(last).all():
        raise FloatingPointError('the vehicle left the numbers')
    return steps / taken


def fly_to_lamp() -> float:
    """Return simulated seconds a second of a whole flight, by processor time."""
    scenario, table = load_scenario('lamp_room'), load_topic_table()
    vehicle = load_vehicle('gtmab', scenario.air.density)
    policy = FlightStack(find_navigation_strategy('bag'), load_gains('gtmab'))
    loop = ClosedLoop(World(vehicle, scenario, table, 1), table, policy)
    begin, steps = time.process_time(), 1
    while loop.step() is FlightOutcome.FLYING:
        steps += 1
    if loop.world.outcome is not FlightOutcome.REACHED:
        raise AssertionError(f'the flight ended with {loop.world.outcome}; it must reach the lamp')
    return steps * table.control_ns * 1e-9 / (time.process_time() - begin)


def build_blocks(diodes: int, beacons: tuple[float, ...]) -> np.ndarray:
    """Return blocks of ADC counts in which half the ring sees the beacons; shape (b, n, d)."""
    generator = np.random.default_rng(1)
    time_axis = np.arange(BLOCKS * SAMPLES) / SAMPLE_RATE
    beacon = sum(np.sin(2.0 * np.pi * frequency * time_axis) for frequency in beacons)
    facing = np.maximum(np.cos(2.0 * np.pi * np.arange(diodes) / diodes), 0.0)
    counts = 800.0 + 200.0 * np.outer(beacon, facing)
    counts += generator.normal(0.0, 5.0, counts.shape)
    return np.rint(counts).astype(np.uint16).reshape(BLOCKS, SAMPLES, diodes)


def measure_blocks(blocks: np.ndarray, work: Callable[[np.ndarray], object]) -> float:
    """Return the pace of some work on each block, on one core [s/s]."""
    begin = time.process_time()
    for block in blocks:
        work(block)
    return BLOCKS * SAMPLES / SAMPLE_RATE / (time.process_time() - begin)


def estimate_lamps() -> float:
    """Return the pace from the block of eight diodes to a lamp estimate [s/s]."""
    finder, prior = LampFinder(build_even_ring(8, 0.07)), LampPrior()
    settings = DemodulationSettings()
    receiver = BeaconReceiver(settings, SAMPLE_RATE, SAMPLES)

    def work(block: np.ndarray) -> object:
        peaks = receiver.demodulate_next_block(block).peaks[0]
        found = finder.find_lamp(peaks, settings.threshold, prior)
        if found.lamp is None:
            raise AssertionError('the beacon is in every block')
        return found

    return measure_blocks(build_blocks(8, (150.0,)), work)


def demodulate() -> float:
    """Return the pace of demodulation alone, of two beacons [s/s]."""
    settings = DemodulationSettings(frequency=150.0, others=(250.0,))
    receiver = BeaconReceiver(settings, SAMPLE_RATE, SAMPLES)
    return measure_blocks(build_blocks(16, (150.0, 250.0)), receiver.demodulate_next_block)


def fly(processes: Any) -> float:
    """Return the pace of a flight through the graph [s/s]."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / 'flight'
        watcher = FlightProgress(Console(quiet=True))
        flight = fly_once('gtmab', 'lamp_room', 'bag', 1, watcher, processes=processes, out=out)
        return flight.pace


def tabulate() -> float:
    """Return how many messages a second become columns."""
    bag, begin = simulate_flight(), time.process_time()
    table = lta_analysis.open(bag)[TRUTH]
    columns = {path: table[path] for path in PATHS}
    return len(columns[PATHS[0]]) / (time.process_time() - begin)


@cache
def simulate_flight() -> Path:
    """Return the bag of a flight."""
    out = Path(tempfile.mkdtemp(prefix='lta-bench-')) / 'flight'
    spec = load_spec('gtmab', 'lamp_room', 'bag', '')
    return simulate_once(spec, 1, out, FlightProgress(Console(quiet=True)))[0].bag


def run_command(*words: str, cache: str = '') -> float:
    """Run a command in an empty folder; return the processor time of all its processes [s]."""
    environment = os.environ | ({'XDG_CACHE_HOME': cache} if cache else {})
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([ROOT / 'lta', *words], cwd=folder, env=environment, check=True,
                       capture_output=True)  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run_cold() -> float:
    """Return the processor time of a flight with an empty cache [s]."""
    with tempfile.TemporaryDirectory() as empty:
        return run_command('simulate', cache=empty)


FIGURES: Final = {
    'kernel.single': Figure(
        'steps/s', step_kernel,
        "one vehicle on one core, RK4 in double precision, with GT-MAB's effects on"),
    'loop.realtime': Figure(
        's/s', fly_to_lamp,
        'the closed loop in one process on one core: sensors, 8 x 10 kS/s light blocks with '
        'reflections, FFT, fit, estimator, control, energy'),
    'vlc.realtime': Figure(
        's/s', estimate_lamps, 'from ADC block to lamp estimate: 8 diodes, one beacon'),
    'vlc.demodulation': Figure(
        's/s', demodulate,
        'demodulation of 16 diodes and two beacons, between bins, with tracking and fault '
        'detection'),
    'graph.realtime': Figure(
        's/s', partial(fly, 'many'), 'a whole flight of the graph in lockstep, seven processes',
        statistics.median),
    'graph.one_process': Figure(
        's/s', partial(fly, 'one'), 'the same flight with `processes:=one`', statistics.median),
    'tables.one_topic': Figure('messages/s', tabulate, 'Odometry as columns'),
    'command.help': Figure('s', partial(run_command, '--help'), '`lta --help`', min),
    'command.simulate': Figure(
        's', partial(run_command, 'simulate'),
        '`lta simulate`, a flight of 21 s with bag and page', min),
    'command.simulate_cold': Figure('s', run_cold, '`lta simulate` with an empty cache', min),
    'command.fly_one': Figure(
        's', partial(run_command, 'fly', '--processes', 'one'),
        '`lta fly --processes one`, the same flight', min),
    'command.fly': Figure(
        's', partial(run_command, 'fly'), '`lta fly`, the same in seven processes', min),
}  # fmt: skip
KINDS: Final = tuple(dict.fromkeys(name.partition('.')[0] for name in FIGURES))


def run(case: Case, options: Namespace) -> Row:
    """Return a sample of each figure of a kind."""
    return {'values': {name: figure.measure() for name, figure in FIGURES.items()
                       if name.partition('.')[0] == case.kind}}  # fmt: skip


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the figures."""
    samples = defaultdict[str, list[float]](list)
    for row in rows.values():
        for name, value in row.get('values', {}).items():
            samples[name].append(value)
    yield f'On {count_cores()} cores.'
    yield ''
    yield '| | measured | what |'
    yield '|---|---|---|'
    for name, figure in FIGURES.items():
        if samples[name]:
            measured = f'{format_value(figure.choose(samples[name]))} {figure.unit}'
            yield f'| `{name}` | {measured} | {figure.about} |'


def format_value(value: float) -> str:
    """Return a value with three digits, millions in words."""
    if abs(value) >= 1e6:
        return f'{value / 1e6:.3g} million'
    return f'{float(f"{value:.3g}"):,.0f}' if abs(value) >= 100.0 else f'{value:.3g}'


CAMPAIGN: Final = Campaign(
    lambda options: KINDS, run, list_table, each=5, page='validation.md',
    smoke='--kinds kernel vlc --each 1',
)  # fmt: skip

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly two hours at the graph's full speed.

One endless flight in lockstep from lantern to lantern, as a user starts it. Checks the memory of
every process and every message in the bag of each topic with a period.
"""

from argparse import ArgumentParser, Namespace
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
import tempfile
import time
from typing import Final, NamedTuple

from command import Lta, Started
from domain import free_domain
from lta_bag.reader import read_bag
from lta_bridge.log_time_assigner import read_stamp
from lta_config.topics import load_topic_table, robot_topic
from lta_graph.ros.listener import DiagnosticsListener
import numpy as np
from numpy.typing import NDArray

from campaigns.graph_trial import write_endless_flight
from campaigns.harness import Campaign, Case, Row, Rows

LEAK: Final = 4.0  # MB/h, the most that counts as flat: 100 MB a day
TABLE: Final = load_topic_table()
ROBOT: Final = 'lta1'
NODES: Final = (
    'simulator', 'estimator', 'controller', 'demodulator', 'navigator', 'energy_monitor',
    'recorder',
)  # fmt: skip
LOOK: Final = 5.0  # s between two looks at the memory
WARM: Final = 0.2  # part of the run that memory may settle in
BEGUN: Final = 1.0  # s of flight
PERIODIC: Final = tuple(
    name
    for name, row in TABLE.topics.items()
    if row.recorded and row.period is not None and name != '/tf'  # it repeats odom
)
EDGE_NS: Final = 300_000_000  # three blocks: a topic may begin so late, and end so early
ASTRIDE: Final = 1  # message that the end of a flight may cut from its answer
LONGEST_LEG: Final = 200.0  # s of flight: three times what one takes


class Slope(NamedTuple):
    """How a process's memory changes: where it stands [MB], slope and half its interval [MB/h]."""

    held: float
    slope: float
    within: float

    @property
    def flat(self) -> bool:
        """Whether it is surely no leak, or too small to matter."""
        return self.slope - self.within < LEAK


def read_own_memory(pid: int) -> float:
    """Return the memory that is a process's own [MB]."""
    for line in Path(f'/proc/{pid}/status').read_text().splitlines():
        if line.startswith('RssAnon:'):
            return float(line.split()[1]) / 1024.0
    raise ValueError(f'process {pid} has no memory')


def fit_slope(times: NDArray[np.float64], held: NDArray[np.float64]) -> Slope:
    """
    Return the slope of memory by least squares, its interval from blocks that hang together.

    `times`, shape (looks,) [s]. `held`, shape (looks,) [MB].
    """
    hours = times / 3600.0
    line = np.polyfit(hours, held, 1)
    rest = held - np.polyval(line, hours)
    # Neighbours are alike: one look in so many counts.
    alike = np.clip(np.corrcoef(rest[:-1], rest[1:])[0, 1], 0.0, 0.99) if rest.std() > 0.0 else 0.0
    counted = max(3.0, len(hours) * (1.0 - alike) / (1.0 + alike))
    spread = np.sqrt((rest**2).sum() / len(hours)) / (hours.std() * np.sqrt(counted - 2.0))
    return Slope(float(held.mean()), float(line[0]), float(2.0 * spread))


def flown(listener: DiagnosticsListener) -> float:
    """Return the time of flight that the simulator tells [s]."""
    fact = listener.facts.get('simulator: flight')
    return float(fact.values['time_s']) if fact else 0.0


def lamp(listener: DiagnosticsListener) -> str:
    """Return the lantern that the drone is about."""
    fact = listener.facts.get('navigator: mission')
    return str(fact.values.get('lamp', '')) if fact else ''


class Looks(NamedTuple):
    """When memory was looked at [s], that of each process [MB], legs, and pace by halves."""

    times: NDArray[np.float64]
    held: dict[str, NDArray[np.float64]]
    legs: int
    paces: list[float]


def watched(graph: Started, listener: DiagnosticsListener, seconds: float) -> Looks:
    """Look at a flight for a while [s]."""
    pids = {name: graph.node(name) for name in NODES}
    looks: list[list[float]] = []  # wall time, time of flight, memory of each process
    began, here, legs = time.monotonic(), '', 0
    while (now := time.monotonic() - began) < seconds:
        listener.poll(0.2)
        assert graph.popen.poll() is None, graph.text
        before, here = here, lamp(listener)
        legs += bool(before) and before != here
        if not looks or now - looks[-1][0] >= LOOK:
            looks.append([now, flown(listener), *map(read_own_memory, pids.values())])
    times, flights, *held = np.transpose(looks)
    middle, settled = len(times) // 2, times >= WARM * seconds
    paces = [
        float((part[-1] - part[0]) / (wall[-1] - wall[0]))
        for part, wall in ((flights[: middle + 1], times[: middle + 1]),
                           (flights[middle:], times[middle:]))
    ]  # fmt: skip
    memory = {name: each[settled] for name, each in zip(pids, held, strict=True)}
    return Looks(times[settled], memory, legs, paces)


def lost(bag_path: Path, steps: int) -> str:
    """Return what is wrong with the rhythm of the topics in the bag, empty for nothing."""
    bag = read_bag(bag_path)
    if not bag.is_complete:
        return 'the bag is not whole'
    rows = {robot_topic(ROBOT, name): TABLE[name] for name in PERIODIC}
    counts = Counter[str]()
    first: dict[str, int] = {}
    due: dict[str, int] = {}
    for topic, _, data in bag.iterate_messages(list(rows)):
        counts[topic] += 1
        if not rows[topic].stamped:
            continue
        if (stamp := read_stamp(data) or 0) != due.setdefault(topic, stamp):
            return f'a message on {topic} is of {stamp} ns, where that of {due[topic]} ns is due'
        first.setdefault(topic, stamp)
        due[topic] = stamp + rows[topic].period_ns
    end = TABLE.start_ns + steps * TABLE.control_ns
    wrong = []
    for topic, row in rows.items():
        if (
            not row.stamped
        ):  # its log time is told by counting: it has one for each that it answers
            if abs(counts[topic] - counts[robot_topic(ROBOT, row.answers)]) > ASTRIDE:
                wrong.append(f'{topic} has {counts[topic]} messages')
        elif first.get(topic, end) >= TABLE.start_ns + EDGE_NS or due[topic] + EDGE_NS < end:
            wrong.append(f'{topic} began late or ended early')
    return ', '.join(wrong)


def faults(listener: DiagnosticsListener) -> list[str]:
    """Return what nodes say of messages that they have not got."""
    told = [fact.message for task, fact in listener.facts.items() if task.endswith(': losses')]
    recorder = listener.facts.get('recorder: recording')
    if recorder and recorder.message != 'recording':
        figures = recorder.values.items()
        topics = ', '.join(f'{key}: {count}' for key, count in figures if 'lost' in key)
        told.append(f'{recorder.message} ({topics})')
    return told


class Soaked(NamedTuple):
    """What was seen of a flight."""

    flown: float  # s
    paces: list[float]  # of the first half and of the second
    memory: dict[str, Slope]
    legs: int
    size: float  # of the bag [GB]
    wrong: list[str]

    @property
    def steps(self) -> int:
        """Control steps that were flown."""
        return round(self.flown / (1e-9 * TABLE.control_ns))


def soaked(lta: Lta, folder: Path, seconds: float) -> Soaked:
    """Fly for so long, and look at everything [wall s]."""
    with DiagnosticsListener(ROBOT) as listener:
        graph = lta.start(
            'launch', 'fly', 'time:=lockstep',
            *(f'{name}:={what}' for name, what in write_endless_flight(folder).items()),
            f'bag:={folder / "bag"}',
        )  # fmt: skip
        while flown(listener) < BEGUN:
            listener.poll(0.1)
            assert graph.popen.poll() is None, graph.text
        first = flown(listener)
        looks = watched(graph, listener, seconds)
        far, wrong = flown(listener), faults(listener)
        if looks.legs < int((far - first) / LONGEST_LEG):
            wrong.append(f'the drone flew from lantern to lantern {looks.legs} times')
        graph.interrupt()
        graph.end()
    memory = {name: fit_slope(looks.times, each) for name, each in looks.held.items()}
    size = 1e-9 * sum(each.stat().st_size for each in (folder / 'bag').rglob('*'))
    found = Soaked(far, looks.paces, memory, looks.legs, size, wrong)
    if gap := lost(folder / 'bag', found.steps):
        wrong.append(gap)
    return found


def run(case: Case, options: Namespace) -> Row:
    """Fly, and return what was seen."""
    with tempfile.TemporaryDirectory() as name, free_domain():
        lta = Lta()
        try:
            seen = soaked(lta, Path(name), 60.0 * options.minutes)
        finally:
            lta.kill()
    grows = [f'the memory of {name} grows' for name, one in seen.memory.items() if not one.flat]
    wrong = '; '.join([*seen.wrong, *grows])
    return {**seen._asdict(), 'steps': seen.steps, 'wrong': wrong}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the flights, and the memory of each process."""
    for row in rows.values():
        if 'flown' not in row:
            continue
        first, second = row['paces']
        yield (
            f'{row["flown"]:.0f} s of flight in {options.minutes:.0f} minutes, {row["steps"]} '
            f'control steps, {first:.1f} times real time in the first half and {second:.1f} in '
            f'the second, {row["legs"]} hand-overs; a bag of {row["size"]:.1f} GB.'
        )
        yield ''
        yield f'| process | private memory | slope, 95 % | may be below {LEAK:.0f} MB/h |'
        yield '|---|---|---|---|'
        for name, values in row['memory'].items():
            one = Slope(*values)
            yield (
                f'| {name} | {one.held:.1f} MB | {one.slope:+.1f} ± {one.within:.1f} MB/h | '
                f'{"yes" if one.flat else "no"} |'
            )


def add_arguments(parser: ArgumentParser) -> None:
    """Add the length of the flight."""
    parser.add_argument('--minutes', type=float, default=120.0, help='wall time')


CAMPAIGN: Final = Campaign(
    lambda options: ['flight'], run, list_table, add_arguments=add_arguments,
    page='reliability.md', alone=True,
)  # fmt: skip

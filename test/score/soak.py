"""
Fly for a long time at the graph's full speed: `make soak` (2 hours; less: ARGS='--minutes 5').

Starts one endless flight in lockstep from lantern to lantern, as a user starts it. Checks the
memory of every process, the latency of a step at the beginning and at the end, and every message
in the bag of each topic with a period. Writes its part of docs/reliability.md.
"""

import argparse
from collections import Counter
from pathlib import Path
import signal
import sys
import tempfile
import time
from typing import Final, NamedTuple

import add_paths  # noqa: F401
from command import Lta, Started
from domain import free_domain
from endless import endless
from lta_bridge.log_time_assigner import read_stamp
from lta_config.topics import load_topic_table, robot_topic
from lta_data.bag.reader import read_bag
from lta_graph.ros.listener import DiagnosticsListener
from machine import work_time
import numpy as np
from numpy.typing import NDArray
from reliability import put
from rich.progress import Progress
from soak_latency import latency
from soak_memory import LEAK, resident, Slope, slope_of

TABLE: Final = load_topic_table()
ROBOT: Final = 'lta1'
NODES: Final = (
    'simulator', 'estimator', 'controller', 'demodulator', 'navigator', 'energy_monitor',
    'recorder',
)  # fmt: skip
MINUTES: Final = 120.0
LOOK: Final = 5.0  # s between two looks at the memory
WARM: Final = 0.2  # part of the run that memory may settle in
WINDOW: Final = 0.1  # part of the run in which steps are timed, at either end
LONGEST_WINDOW: Final = 120.0  # s
SLOWER: Final = 1.25  # times the begin, that a percentile may be at the end
PERCENTILES: Final = (50, 90, 99)
BEGUN: Final = 1.0  # s of flight
PERIODIC: Final = tuple(
    name
    for name, row in TABLE.topics.items()
    if row.recorded and row.period is not None and name != '/tf'  # it repeats odom
)
EDGE_NS: Final = 300_000_000  # three blocks: a topic may begin so late, and end so early
ASTRIDE: Final = 1  # message that the end of a flight may cut from its answer
LONGEST_LEG: Final = 200.0  # s of flight: three times what one takes
HEAD: Final = """\
## A long flight

`make soak` flew {minutes:.0f} minutes of wall time in lockstep, as fast as the graph answers:
{flown:.0f} s of flight, {pace:.1f} times real time, {steps} control steps, from lantern to lantern
of `warehouse_patrol`, with a battery that does not run out and {legs} hand-overs. {short}

| process | private memory | slope, 95 % | flat: slope may be below {leak:.0f} MB/h |
|---|---|---|---|
{memory}

The latency of a step is the time from `imu` to the `motors` that answer it, by their log times:
{begin} steps at the beginning and {end} at the end. The same work in a process outside the graph
took {slowness:.2f} times as long at the end.

| steps | latency at the beginning | at the end | ratio | below {slower} |
|---|---|---|---|---|
{ways}

{drift}
"""
SHORT: Final = (
    'A complete soak takes {minutes:.0f} minutes: this one is too short to detect slow leaks.'
)
WELL: Final = (
    'The bag ({size:.1f} GB) has every message of all {topics} topics with a period: stamped\n'
    'messages one period apart from start to end, others as often as the messages that they\n'
    'answer. No time drifted, and no node reports a lost message.'
)


def flown(listener: DiagnosticsListener) -> float:
    """Return the time of flight that the simulator tells. [s]"""
    fact = listener.facts.get('simulator: flight')
    return float(fact.values['time_s']) if fact else 0.0


def lamp(listener: DiagnosticsListener) -> str:
    """Return the lantern that the drone is about."""
    fact = listener.facts.get('navigator: mission')
    return str(fact.values.get('lamp', '')) if fact else ''


def watched(
    graph: Started, listener: DiagnosticsListener, seconds: float
) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]], int]:
    """Return when memory was looked at [s], that of each process [MB], and how many legs came."""
    pids = {name: graph.node(name) for name in NODES}
    times: list[float] = []
    held: dict[str, list[float]] = {name: [] for name in NODES}
    began, here, legs = time.monotonic(), '', 0
    with Progress(disable=not sys.stderr.isatty()) as bar:
        task = bar.add_task('flying', total=seconds)
        while (now := time.monotonic() - began) < seconds:
            listener.poll(0.2)
            assert graph.popen.poll() is None, graph.text
            before, here = here, lamp(listener)
            legs += bool(before) and before != here
            if not times or now - times[-1] >= LOOK:
                times.append(now)
                for name, pid in pids.items():
                    held[name].append(resident(pid))
                bar.update(task, completed=now)
    settled = np.array(times) >= WARM * seconds
    flat = {name: np.array(each)[settled] for name, each in held.items()}
    return np.array(times)[settled], flat, legs


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


def table(begin: NDArray[np.float64], end: NDArray[np.float64]) -> list[str]:
    """Return the lines of the table of step latencies."""
    rows = []
    for part in PERCENTILES:
        first, last = (1e3 * float(np.percentile(each, part)) for each in (begin, end))
        rows.append(
            f'| {part} % within | {first:.2f} ms | {last:.2f} ms | {last / first:.2f} | '
            f'{"yes" if last < SLOWER * first else "no"} |'
        )
    return rows


class Soaked(NamedTuple):
    """What was seen of a flight."""

    flown: float  # s
    pace: float
    memory: dict[str, Slope]
    begin: NDArray[np.float64]  # s
    end: NDArray[np.float64]  # s
    slowness: float  # of the machine, at the end over at the beginning
    legs: int
    size: float  # of the bag [GB]
    wrong: list[str]

    @property
    def steps(self) -> int:
        """Control steps that were flown."""
        return round(self.flown / (1e-9 * TABLE.control_ns))


def soaked(lta: Lta, folder: Path, seconds: float) -> Soaked:
    """Fly for so long, and look at everything. [wall s]"""
    window = min(LONGEST_WINDOW, WINDOW * seconds)
    with DiagnosticsListener(ROBOT) as listener:
        graph = lta.start(
            'launch', 'fly', 'time:=lockstep',
            *(f'{name}:={what}' for name, what in endless(folder).items()),
            f'bag:={folder / "bag"}',
            'split_size:=100',  # MB; an index of each chunk is in memory until its file is full
        )  # fmt: skip
        while flown(listener) < BEGUN:
            listener.poll(0.1)
            assert graph.popen.poll() is None, graph.text
        fast = work_time()
        begin = latency(window)
        listener.poll(0.2)
        before, at = flown(listener), time.monotonic()
        times, held, legs = watched(graph, listener, seconds - 2.0 * window)
        watched_for = flown(listener) - before
        pace = watched_for / (time.monotonic() - at)
        end = latency(window)
        slowness = work_time() / fast
        listener.poll(0.5)
        far, wrong = flown(listener), faults(listener)
        if legs < int(watched_for / LONGEST_LEG):
            wrong.append(f'the drone flew from lantern to lantern {legs} times')
        graph.interrupt()
        graph.end()
    memory = {name: slope_of(times, each) for name, each in held.items()}
    size = 1e-9 * sum(each.stat().st_size for each in (folder / 'bag').rglob('*'))
    found = Soaked(far, pace, memory, begin, end, slowness, legs, size, wrong)
    if gap := lost(folder / 'bag', found.steps):
        wrong.append(gap)
    return found


def paged(seen: Soaked, minutes: float) -> str:
    """Return the part of the page."""
    memory = (
        f'| {name} | {each.held:.1f} MB | {each.slope:+.1f} ± {each.within:.1f} MB/h | '
        f'{"yes" if each.flat else "no"} |'
        for name, each in seen.memory.items()
    )
    return HEAD.format(
        minutes=minutes,
        flown=seen.flown,
        pace=seen.pace,
        steps=seen.steps,
        short='' if minutes >= MINUTES else SHORT.format(minutes=MINUTES),
        leak=LEAK,
        memory='\n'.join(memory),
        begin=len(seen.begin),
        end=len(seen.end),
        slower=SLOWER,
        legs=seen.legs,
        slowness=seen.slowness,
        ways='\n'.join(table(seen.begin, seen.end)),
        drift=f'Not as required: {"; ".join(seen.wrong)}.'
        if seen.wrong
        else WELL.format(topics=len(PERIODIC), size=seen.size),
    )


def main() -> int:
    """Fly, print and write the page; 1 where anything is not as it should be."""
    parser = argparse.ArgumentParser(description='A long flight.')
    parser.add_argument('--minutes', type=float, default=MINUTES)
    minutes = parser.parse_args().minutes
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # the graph ends with us
    with tempfile.TemporaryDirectory() as name, free_domain():
        lta = Lta()
        try:
            seen = soaked(lta, Path(name), 60.0 * minutes)
        finally:
            lta.kill()
    text = paged(seen, minutes)
    sys.stdout.write(text + '\n')
    put('soak', text)
    flat = all(each.flat for each in seen.memory.values())
    return int(bool(seen.wrong) or '| no |' in text or not flat)


if __name__ == '__main__':
    sys.exit(main())

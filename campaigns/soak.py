"""
Fly two hours at the graph's full speed.

One endless flight in lockstep from lantern to lantern, as a user starts it. Checks the memory of
every process, the latency of a step at the beginning and at the end, and every message in the bag
of each topic with a period.
"""

from argparse import ArgumentParser, Namespace
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
import statistics
import tempfile
import time
from typing import Final, NamedTuple

from command import Lta, Started
from domain import free_domain
from lta_bridge.log_time_assigner import read_stamp
from lta_config.topics import load_topic_table, robot_topic
from lta_data.bag.reader import read_bag
from lta_graph.ros.listener import DiagnosticsListener, join_graph
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.qos import select_profile
import numpy as np
from numpy.typing import NDArray
from rclpy.subscription import Subscription

from campaigns.graph_trial import write_endless_flight
from campaigns.harness import Campaign, Case, Row, Rows

LEAK: Final = 4.0  # MB/h, the most that counts as flat: 100 MB a day
TABLE: Final = load_topic_table()
ENDS: Final = ('imu', 'motors')  # of a step
NAP: Final = 0.001  # s


def measure_latency(seconds: float) -> NDArray[np.float64]:
    """
    Look on for a while [s], and return how long each step took, by the times of its messages.

    DDS sends with each message when it was written: whoever looks on may get it late, and out of
    turn.

    The result has shape (steps,) [s].
    """
    with join_graph('onlooker', '/lta1') as (node, _):
        readers = []
        for name in ENDS:
            row = TABLE[name]
            kind, quality = find_message_type(row), select_profile(row, lockstep=True)
            readers.append(node.create_subscription(kind, name, taken_by_hand, quality, raw=True))
        return timed(readers, seconds)


def taken_by_hand(data: bytes) -> None:
    """Never called: nobody spins."""


def timed(readers: Sequence[Subscription], seconds: float) -> NDArray[np.float64]:
    """Return how long each step took [s] that the readers of the two ends hear in a while. [s]"""
    began, until = time.time_ns(), time.monotonic() + seconds
    written: dict[str, dict[int, int]] = {name: {} for name in ENDS}
    while time.monotonic() < until:
        found = 0
        for reader, name in zip(readers, ENDS, strict=True):
            while (taken := reader.handle.take_message(reader.msg_type, True)) is not None:
                data, about = taken
                written[name][read_stamp(data) or 0] = about['source_timestamp']
                found += 1
        if not found:
            time.sleep(NAP)
    first, last = (written[name] for name in ENDS)
    both = [k for k in last if k in first and first[k] >= began]
    return np.array([1e-9 * (last[k] - first[k]) for k in both])


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
    """Return the memory that is a process's own. [MB]"""
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


TABLE: Final = load_topic_table()
ROBOT: Final = 'lta1'
NODES: Final = (
    'simulator', 'estimator', 'controller', 'demodulator', 'navigator', 'energy_monitor',
    'recorder',
)  # fmt: skip
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
    while (now := time.monotonic() - began) < seconds:
        listener.poll(0.2)
        assert graph.popen.poll() is None, graph.text
        before, here = here, lamp(listener)
        legs += bool(before) and before != here
        if not times or now - times[-1] >= LOOK:
            times.append(now)
            for name, pid in pids.items():
                held[name].append(read_own_memory(pid))
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
            *(f'{name}:={what}' for name, what in write_endless_flight(folder).items()),
            f'bag:={folder / "bag"}',
        )  # fmt: skip
        while flown(listener) < BEGUN:
            listener.poll(0.1)
            assert graph.popen.poll() is None, graph.text
        fast = measure_work()
        begin = measure_latency(window)
        listener.poll(0.2)
        before, at = flown(listener), time.monotonic()
        times, held, legs = watched(graph, listener, seconds - 2.0 * window)
        watched_for = flown(listener) - before
        pace = watched_for / (time.monotonic() - at)
        end = measure_latency(window)
        slowness = measure_work() / fast
        listener.poll(0.5)
        far, wrong = flown(listener), faults(listener)
        if legs < int(watched_for / LONGEST_LEG):
            wrong.append(f'the drone flew from lantern to lantern {legs} times')
        graph.interrupt()
        graph.end()
    memory = {name: fit_slope(times, each) for name, each in held.items()}
    size = 1e-9 * sum(each.stat().st_size for each in (folder / 'bag').rglob('*'))
    found = Soaked(far, pace, memory, begin, end, slowness, legs, size, wrong)
    if gap := lost(folder / 'bag', found.steps):
        wrong.append(gap)
    return found


def measure_work() -> float:
    """Return how long the machine takes for a piece of work outside the graph: the median. [s]"""
    times = []
    for _ in range(100):
        began, total = time.perf_counter(), 0
        for k in range(100_000):
            total += k * k
        times.append(time.perf_counter() - began)
    return statistics.median(times)


def run(case: Case, options: Namespace) -> Row:
    """Fly, and return what was seen."""
    with tempfile.TemporaryDirectory() as name, free_domain():
        lta = Lta()
        try:
            seen = soaked(lta, Path(name), 60.0 * options.minutes)
        finally:
            lta.kill()
    steps = [[1e3 * float(np.percentile(part, share)) for part in (seen.begin, seen.end)]
             for share in PERCENTILES]  # fmt: skip
    wrong = [
        *seen.wrong,
        *(f'the memory of {name} grows' for name, one in seen.memory.items() if not one.flat),
        *('steps are slower at the end' for begin, end in steps[:1] if end > SLOWER * begin),
    ]
    return {
        'flown': seen.flown, 'pace': seen.pace, 'steps': seen.steps, 'legs': seen.legs,
        'memory': {name: list(one) for name, one in seen.memory.items()}, 'latency': steps,
        'slowness': seen.slowness, 'size': seen.size, 'wrong': '; '.join(wrong),
    }  # fmt: skip


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the flights, the memory of each process and the latency of a control period."""
    for row in rows.values():
        if 'flown' not in row:
            continue
        yield (
            f'{row["flown"]:.0f} s of flight in {options.minutes:.0f} minutes, {row["pace"]:.1f} '
            f'times real time, {row["steps"]} control steps, {row["legs"]} hand-overs; a bag of '
            f'{row["size"]:.1f} GB.'
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
        yield ''
        yield '| steps | latency at the beginning | at the end |'
        yield '|---|---|---|'
        for share, (begin, end) in zip(PERCENTILES, row['latency'], strict=True):
            yield f'| {share} % within | {begin:.2f} ms | {end:.2f} ms |'
        yield ''
        yield f'Work outside the graph took {row["slowness"]:.2f} times as long at the end.'


def add_arguments(parser: ArgumentParser) -> None:
    """Add the length of the flight."""
    parser.add_argument('--minutes', type=float, default=120.0, help='wall time')


CAMPAIGN: Final = Campaign(
    lambda options: ['flight'], run, list_table, add_arguments=add_arguments,
    page='reliability.md', alone=True,
)  # fmt: skip

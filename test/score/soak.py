"""
A long flight at the graph's full speed: `make soak` (two hours; ARGS='--minutes 5' for less).

One flight in lockstep that does not end, started as a user starts it. Memory of every process all
the while, the way of a step through the graph at the beginning and at the end, and in the bag
every stamp of the fastest topic. Writes its part of docs/reliability.md.
"""

import argparse
from pathlib import Path
import sys
import tempfile
import time
from typing import Final, NamedTuple

import beside  # noqa: F401
from command import Lta, ROOT, Started
from domain import free_domain
from lta_analysis.bag.reader import read_bag
from lta_config.topics import robot_topic, topic_table
from lta_graph.ros.listener import DiagnosticsListener
import numpy as np
from numpy.typing import NDArray
from reliability import put
from rich.progress import Progress
from soak_latency import Latency, stamp_of
from soak_memory import LEAK, resident, Slope, slope_of

TABLE: Final = topic_table()
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
ENDLESS: Final = '86400 s'  # the longest that a scenario takes
BEGUN: Final = 1.0  # s of flight
RECORDED: Final = ('imu', 'battery', '/diagnostics')
TRUE_TOPIC: Final = 'imu'
HEAD: Final = """\
## A long flight

`make soak` flew {minutes:.0f} minutes of wall time in lockstep, as fast as the graph answers:
{flown:.0f} s of flight, {pace:.1f} times real time, {steps} control steps. {short}

| process | memory of its own | slope, 95 % | flat: may be below {leak:.0f} MB/h |
|---|---|---|---|
{memory}

The way of a step through the graph, from `imu` to the `motors` that answer it, as an onlooker
sees it; {begin} steps at the beginning and {end} at the end:

| of the steps | took at the beginning | at the end | ratio | below {slower} |
|---|---|---|---|---|
{ways}

{drift}
"""
SHORT: Final = 'A whole soak is {minutes:.0f} minutes: this one says little of slow leaks.'
WELL: Final = (
    'Every stamp of `imu` in the bag is start + k * period, without a gap, and no node misses '
    'anything:\nno time drifted and no message was lost.'
)


def scenario(folder: Path) -> Path:
    """Return the shipped scene without an end."""
    text = (ROOT / 'config/scenarios/lamp_room.yaml').read_text()
    path = folder / 'endless.yaml'
    path.write_text(text.replace('radius: 1.0 m', 'radius: 0.01 m').replace('60 s', ENDLESS, 1))
    return path


def flown(listener: DiagnosticsListener) -> float:
    """Return the time of flight that the simulator tells. [s]"""
    fact = listener.facts.get('simulator: flight')
    return float(fact.values['time_s']) if fact else 0.0


def watched(
    graph: Started, listener: DiagnosticsListener, seconds: float
) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
    """Return when memory was looked at [s], and that of each process [MB]."""
    pids = {name: graph.node(name) for name in NODES}
    times: list[float] = []
    held: dict[str, list[float]] = {name: [] for name in NODES}
    began = time.monotonic()
    with Progress(disable=not sys.stderr.isatty()) as bar:
        task = bar.add_task('flying', total=seconds)
        while (now := time.monotonic() - began) < seconds:
            listener.poll(0.2)
            if not times or now - times[-1] >= LOOK:
                times.append(now)
                for name, pid in pids.items():
                    held[name].append(resident(pid))
                bar.update(task, completed=now)
    settled = np.array(times) >= WARM * seconds
    return np.array(times)[settled], {k: np.array(v)[settled] for k, v in held.items()}


def lost(bag_path: Path, steps: int) -> str:
    """Return what is wrong with the fastest topic in the bag, empty for nothing."""
    bag, name = read_bag(bag_path), robot_topic(ROBOT, TRUE_TOPIC)
    period, expected = TABLE[TRUE_TOPIC].period_ns, TABLE.start_ns
    count = 0
    for _, _, data in bag.messages([name]):
        if (stamp := stamp_of(data)) != expected:
            return f'message {count} is stamped {stamp} ns, not {expected} ns'
        expected, count = expected + period, count + 1
    if not bag.complete:
        return 'the bag is not whole'
    return '' if count > steps else f'{count} messages in the bag, {steps} steps were told'


def faults(listener: DiagnosticsListener) -> list[str]:
    """Return what nodes say of messages that they have not got."""
    told = [fact for task, fact in listener.facts.items() if task.endswith(': losses')]
    recorder = listener.facts.get('recorder: recording')
    return [fact.message for fact in told] + (
        [recorder.message] if recorder and recorder.message != 'recording' else []
    )


def table(begin: NDArray[np.float64], end: NDArray[np.float64]) -> list[str]:
    """Return the lines of the table of the way of a step."""
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
            'launch', 'fly', 'time:=lockstep', f'scenario:={scenario(folder)}',
            f'bag:={folder / "bag"}', f'topics:={" ".join(RECORDED)}',
        )  # fmt: skip
        while flown(listener) < BEGUN:
            listener.poll(0.1)
            assert graph.popen.poll() is None, graph.text
        with Latency() as latency:
            begin = latency.during(window)
        listener.poll(0.2)
        before, at = flown(listener), time.monotonic()
        times, held = watched(graph, listener, seconds - 2.0 * window)
        pace = (flown(listener) - before) / (time.monotonic() - at)
        with Latency() as latency:
            end = latency.during(window)
        listener.poll(0.5)
        far, wrong = flown(listener), faults(listener)
        graph.interrupt()
        graph.end()
    memory = {name: slope_of(times, each) for name, each in held.items()}
    found = Soaked(far, pace, memory, begin, end, wrong)
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
        ways='\n'.join(table(seen.begin, seen.end)),
        drift=f'Not as it should be: {"; ".join(seen.wrong)}.' if seen.wrong else WELL,
    )


def main() -> int:
    """Fly, print and write the page; 1 where anything is not as it should be."""
    parser = argparse.ArgumentParser(description='A long flight.')
    parser.add_argument('--minutes', type=float, default=MINUTES)
    minutes = parser.parse_args().minutes
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

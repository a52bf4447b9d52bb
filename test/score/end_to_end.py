"""
Flights to the lamp through the real firmware: `make end-to-end FIRMWARE=/path/to/sources`.

The Crazyflie firmware runs as a Linux process (firmware/crazyflie/linux), the portable part of the
light board's firmware as another (firmware/light_board/host). One simulated world moves by the
motors of the first, gives it what its sensors read, and gives the second the samples of its
converter. The graph flies both over UDP and a serial port, in real time, as it would fly a drone.

`end_to_end.py FIRMWARE --seeds 20` flies and writes docs/hardware_flights.md; rows stay in
runs/end_to_end, and a campaign that was stopped goes on.
"""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
import json
import os
from pathlib import Path
import subprocess
import sys
import threading
import time
from typing import Final, final, Self

import add_paths  # noqa: F401
from campaign import campaign, Case, Row, tried, version
from command import Lta
from diagnostic_msgs.msg import DiagnosticArray
from linux_crazyflie import build, commit_of, Process
from lta_config.topics import load_topic_table
from lta_emulation.crazyflie.commander import BodyCommand
from lta_emulation.crazyflie.firmware_bench import FirmwareBench
from lta_emulation.crazyflie.simulated_body import SimulatedBody
from lta_emulation.emulated_hardware import build_simulated_body
from lta_emulation.teensy.emulated_board import Cable
import numpy as np
from numpy.typing import NDArray
from outcome import Outcome
from outcome import tried as tried_here
from peer import Peer
from std_srvs.srv import SetBool

ROOT: Final = Path(__file__).resolve().parents[2]
PAGE: Final = ROOT / 'docs/hardware_flights.md'
PROGRAMS: Final = 'LTA_END_TO_END'  # folder of both programs
LONGEST: Final = 80.0  # s from take-off to the lamp
LANDS: Final = 30.0  # s from the request to motors that stand
HUNG: Final = 400.0  # s
READY: Final = {
    'crazyflie_bridge: link': 'connected',
    'teensy_bridge: light board': 'receiving light',
    'estimator: estimate': 'biases are known',
    'demodulator: light': 'beacon found',
    'navigator: mission': 'climb',
}
HEAD: Final = """# Flights through the real firmware

`make end-to-end FIRMWARE=/path/to/crazyflie-firmware` writes this page. The Crazyflie firmware
(commit `{commit}`, with our app) and the portable part of the light board's firmware run as
processes of Linux. One simulated world (GT-MAB, lamp_room) moves by the motors of the first, gives
it the readings of its sensors, and gives the second the samples of its converter. The graph flies
both over UDP and a serial port in real time, from arming to the lamp (1 m) and a request to land.
Timers, radio and converters are simulated; nothing here ran on a board.

**{reached} of {count} seeds reached the lamp, and the motors of {stopped} stopped on request.**
{late} The request is to land; whether the drone
then reaches the floor is not measured.

| seed | start [m from the lamp] | reached after [s] | closest [m] | motors stopped after [s] | \
missed exchanges |
|---|---|---|---|---|---|
"""


@dataclass(frozen=True, slots=True)
class FlightRow(Outcome):
    """A flight: distances [m], time to the lamp [s], exchanges that the firmware missed."""

    begun: float = 0.0
    reached: float | None = None
    closest: float = 0.0
    missed: int = 0


@final
class LightCore:
    """
    The portable part of the light board's firmware as a process, at the end of a serial port.

    Parameters
    ----------
    program : Path
        From firmware/light_board/host.
    folder : Path
        For its ports and its samples.

    """

    def __init__(self, program: Path, folder: Path) -> None:
        self._program, self._rows = program, folder / 'rows'
        self._near, self._far = Cable(folder / 'light_board'), Cable(folder / 'inner')
        self._inner = folder / 'inner'
        self.port = folder / 'light_board'
        self._running = threading.Event()
        self._relay = threading.Thread(target=self._carry, daemon=True)
        os.mkfifo(self._rows)

    def __enter__(self) -> Self:
        light = load_topic_table().light
        words = [self._inner, self._rows, 8, light.sample_rate.si, 0.0, 0.0]
        self._process = subprocess.Popen([self._program, *map(str, words)])
        # The board boots when its samples can begin
        self._samples = self._rows.open('wb', buffering=0)
        self._running.set()
        self._relay.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()
        self._running.clear()
        self._relay.join()
        self._samples.close()
        self._near.pull()
        self._far.pull()

    def sample_light(self, _begun: float, samples: NDArray[np.uint16]) -> None:
        """Give the board a block; shape (samples, diodes)."""
        self._samples.write(samples.astype('<u2').tobytes())

    def _carry(self) -> None:
        # Until the bridge has asked for the time nobody reads, and a full port would hold up the
        # board and with it the world
        is_open = False
        while self._running.is_set():
            sent, asked = self._far.read(0.002), self._near.read()
            is_open = is_open or bool(asked)
            self._far.write(asked)
            if is_open:
                self._near.write(sent)


@contextmanager
def serve(folder: Path, seed: int) -> Iterator[tuple[SimulatedBody, FirmwareBench, LightCore]]:
    """Serve both boards and their world."""
    programs = Path(os.environ[PROGRAMS])
    light = LightCore(programs / 'light_board', folder)
    body = build_simulated_body('gtmab', 'lamp_room', seed, light.sample_light)
    # The first step compiles the model for seconds, in which the board would count on
    body.advance(0.011, BodyCommand((0.0,) * 4))
    with (
        Process(programs / 'app' / 'crazyflie') as firmware,
        light,
        FirmwareBench(body, firmware.bench_port, firmware.port) as bench,
    ):
        yield body, bench, light


def fly(seed: int, folder: Path, peer: Peer) -> FlightRow:
    """Fly to the lamp, and ask for a landing."""
    facts: dict[str, str] = {}
    with serve(folder, seed) as (body, bench, light):
        lta, world = Lta(), body.world
        listen(peer, facts)
        graph = lta.start(
            'launch', 'fly', 'source:=crazyflie', f'uri:={bench.uri}', 'light_board:=true',
            f'light_port:={light.port}', 'light_patience:=60.0', 'record:=false',
        )  # fmt: skip
        try:
            peer.until(lambda: all(facts.get(name) == word for name, word in READY.items()))
            begun, missed = float(world.goal_distance), bench.missed
            peer.arm_until(lambda: any(body.duties))
            since, distances = time.monotonic(), [begun]

            def is_over() -> bool:
                distances.append(float(world.goal_distance))
                return bool(world.is_at_lamp) or time.monotonic() > since + LONGEST

            peer.until(is_over)
            reached = time.monotonic() - since if world.is_at_lamp else None
            peer.ask(SetBool, 'crazyflie_bridge/arm', data=False)
            asked = time.monotonic()
            peer.until(lambda: not any(body.duties) or time.monotonic() > asked + LANDS)
            took = None if any(body.duties) else time.monotonic() - asked
            graph.interrupt()
            graph.end()
        finally:
            lta.kill()
    wrong = '' if reached is not None and took is not None else 'the lamp was not reached'
    if reached is not None and took is None:
        wrong = 'the motors did not stop'
    return FlightRow(
        took=took, wrong=wrong, begun=begun, reached=reached, closest=min(distances),
        missed=bench.missed - missed,
    )  # fmt: skip


def listen(peer: Peer, facts: dict[str, str]) -> None:
    """Keep the newest message of each task in /diagnostics."""

    def hear(array: DiagnosticArray) -> None:
        facts.update((status.name, status.message) for status in array.status)

    peer.node.create_subscription(DiagnosticArray, '/diagnostics', hear, 100)


def write_page(rows: dict[Case, Row], commit: str) -> None:
    """Write the page."""
    late = max(row['late'] for row in rows.values())
    head = HEAD.format(
        commit=commit,
        count=len(rows),
        reached=sum(row['reached'] is not None for row in rows.values()),
        stopped=sum(row['took'] is not None for row in rows.values()),
        late=f'The machine was shared; it woke a sleeper {late:.2f} s too late at most.',
    )

    def cell(value: float | None) -> str:
        return '-' if value is None else f'{value:.1f}'

    lines = [
        f'| {case.number} | {row["begun"]:.1f} | {cell(row["reached"])} | {row["closest"]:.2f} | '
        f'{cell(row["took"])} | {row["missed"]} |'
        for case, row in rows.items()
    ]
    PAGE.write_text(head + '\n'.join(lines) + '\n', encoding='utf-8')


def main() -> int:
    """Build, fly all seeds and write the page; or fly one seed: `flight NUMBER`."""
    if sys.argv[1:2] == ['flight']:
        number = int(sys.argv[2])
        row = tried_here(lambda folder, peer: fly(number, folder, peer), FlightRow)
        sys.stdout.write(json.dumps(asdict(row)) + '\n')
        return 0
    parser = argparse.ArgumentParser(description='Fly through the real firmware.')
    parser.add_argument('firmware', type=Path, help='checkout of crazyflie-firmware')
    parser.add_argument('--seeds', type=int, default=20)
    parser.add_argument('--out', type=Path, default=Path('runs/end_to_end'))
    asked = parser.parse_args()
    programs = (asked.out / 'programs').resolve()
    build(asked.firmware, 'app', programs)
    words = [
        'make',
        '-s',
        '-C',
        ROOT / 'firmware/light_board',
        f'BUILD={programs}',
        f'PYTHON={sys.executable}',
    ]
    subprocess.run(words, check=True)
    os.environ[PROGRAMS] = str(programs)
    commit, here = commit_of(asked.firmware), Path(__file__)
    path = asked.out / f'{version([here])}.jsonl'
    cases = [Case('flight', seed) for seed in range(1, asked.seeds + 1)]
    rows = campaign(cases, path, 1, lambda case: tried(case, here, HUNG))
    write_page(rows, commit)
    return int(any(row['wrong'] for row in rows.values()))


if __name__ == '__main__':
    sys.exit(main())

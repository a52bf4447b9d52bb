"""
Faults on the link of the light board, and the time within which the bridge must report them.

No motor turns here: without light, the pilot or navigator lands the drone
(`test/integration/test_hardware_flight.py` unplugs the cable in flight). The bridge must not
publish wrong light, must report the loss, and must publish light again after the repair. An
emulated board (8 diodes at 10 kS/s) is at the end of a cable in this process, its bridge and a
recorder are processes; the number of a trial decides the moment.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from random import Random
import time
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticArray
from lta_config.topics import load_topic_table
from lta_data.bag.reader import read_bag
from lta_emulation.teensy.board_server import BoardServer
from lta_emulation.teensy.emulated_board import EmulatedBoard, FrameFaults
from lta_graph.ros.stamps import from_stamp
from lta_vlc.messages import to_block
import numpy as np
from numpy.typing import NDArray
from peer import Peer, start

from campaigns.fault_trial import closed_nodes
from campaigns.graph_trial import join_faults, Outcome, SLACK

TABLE: Final = load_topic_table()
PERIOD: Final = 1e-9 * TABLE['photodiodes'].period_ns  # s
LASTS: Final = 2.0  # s of a fault that light goes on through
NEAR: Final = 0.005  # s by which a stamp may be wrong, besides what the cable takes
TASK: Final = 'teensy_bridge: light board'
RATE: Final = TABLE.light.sample_rate.si  # Hz
COUNTS: Final = 1 << 12  # of the converter
EVERY: Final = 10  # one of so many light frames is disturbed
TOLD: Final = 1.5  # s: half a second of silence, and health is reported each second
AGAIN: Final = 3.0  # s: a second between two port scans, and the clock is synchronised again
SOUND: Final = FrameFaults()
DRIFT: Final = 200e-6  # relative error of its clock, fast


@dataclass(frozen=True, slots=True)
class LightKind:
    """One kind of fault."""

    about: str  # label in the table
    word: str = ''  # part of the bridge's message; empty if the light continues
    # Inject the fault into a `LightTrial`, and remove it
    strike: Callable[[Any], object] = lambda trial: None
    cure: Callable[[Any], object] = lambda trial: None
    spoilt: FrameFaults = SOUND  # disturbance of the frames meanwhile
    figure: str = ''  # the bridge's counter of exactly the disturbed frames; empty for none
    drift: float = 0.0  # relative error of the board's clock, fast


def hushed(silent: bool) -> Callable[[Any], None]:
    """Return a function that silences the board, or ends the silence."""
    return lambda trial: setattr(trial.server, 'silent', silent)


def another(**board: int) -> Callable[[Any], None]:
    """Return a function that connects another board, or the same after a restart."""

    def strike(trial: Any) -> None:
        trial.server.board = EmulatedBoard(trial.server.now_ns, **board)

    return strike


LIGHT_KINDS: Final = {
    'light unplugged': LightKind(
        'cable unplugged and plugged in again', 'plug the light board in',
        lambda trial: trial.server.toggle_cable(), lambda trial: trial.server.toggle_cable(),
    ),
    'light silent': LightKind('board sends nothing', 'no data from the light board',
                              hushed(True), hushed(False)),
    'light dialect': LightKind('board with another protocol dialect', 'uses version 2',
                               another(dialect=2), another()),
    'light restart': LightKind('board restarts, its clock at 0', strike=another()),
    'light drift': LightKind('clock of the board 200 ppm fast', drift=DRIFT),
    'light lost': LightKind('every tenth frame lost', spoilt=FrameFaults(drop=EVERY)),
    'light partial': LightKind('every tenth frame truncated to a third',
                               spoilt=FrameFaults(cut=EVERY)),
    'light CRC': LightKind('one bit of every tenth frame flipped',
                           spoilt=FrameFaults(corrupt=EVERY), figure='crc_errors'),
    'light foreign': LightKind('every tenth frame followed by an unknown message',
                               spoilt=FrameFaults(foreign=EVERY), figure='unknown'),
}  # fmt: skip


def numbered(block: int) -> NDArray[np.uint16]:
    """Return the samples of a block whose first two diodes tell the number of each row."""
    rows = TABLE.light.samples * block + np.arange(TABLE.light.samples)
    samples = np.zeros((TABLE.light.samples, 8), np.uint16)
    samples[:, 0], samples[:, 1] = rows % COUNTS, rows // COUNTS
    return samples


class LightTrial:
    """The parties of one trial."""

    def __init__(self, name: str, number: int, folder: Path, peer: Peer) -> None:
        kind = self._kind = LIGHT_KINDS[name]
        self._random, self._peer = Random(f'{name} {number}'), peer
        first = self._random.randrange(2**32)  # its rows may wrap
        board = EmulatedBoard(0, RATE, drift=kind.drift, first=first)
        self.server = BoardServer(board, folder / 'ttyACM0')
        self.bag = folder / 'bag'
        self.nodes = {
            'bridge': start('lta_bridge.nodes.teensy_bridge', '-p', f'port:={self.server.port}'),
            'recorder': start('lta_bridge.nodes.recorder', '-p', f'bag:={self.bag}'),
        }
        self._said, self._figures, self._words = '', {}, set()
        self._came, self._late, self._blocks = 0.0, 0.0, 0
        peer.node.create_subscription(DiagnosticArray, '/diagnostics', self._on_health, 10)
        peer.hear('photodiodes', self._on_block)

    def _on_health(self, told: DiagnosticArray) -> None:
        for status in told.status:
            if status.name.endswith(TASK):
                self._said = status.message
                self._words.add(status.message)
                self._figures = {item.key: item.value for item in status.values}

    def _on_block(self, block: Any) -> None:
        """Note when light came, and by how much its stamp is off its first row."""
        self._came, self._blocks = time.monotonic(), self._blocks + 1
        since = 1e-9 * (from_stamp(block.header.stamp) - self._began_ns)
        low, high = map(int, to_block(block)[0, :2])
        self._late = max(self._late, abs(since - (low + COUNTS * high) / RATE))

    def _until(self, condition: Any) -> None:
        """Let the board sample, until something holds."""

        def done() -> Any:
            while 1e-9 * self.server.now_ns >= PERIOD * (self._sampled + 1):
                self.server.sample_light(PERIOD * self._sampled, numbered(self._sampled))
                self._sampled += 1
            return condition()

        self._peer.until(done)

    def _for(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        self._until(lambda: time.monotonic() >= until)

    def watch(self) -> Outcome:
        """Let light come, let it strike, and watch until light comes again."""
        self._sampled = 0
        with self.server:
            self._began_ns = time.time_ns() - self.server.now_ns
            self._until(lambda: self._blocks > 3 and 'receiving light' in self._said)
            self._for(self._random.uniform(0.2, 1.5))
            struck = time.monotonic()
            wrong, took = self._spoilt() if not self._kind.word else self._told(struck)
            outcome = Outcome(took, not self._kind.word, 'light', wrong, bool(wrong))
            return self._judge(join_faults(outcome, closed_nodes(self.nodes)))

    def _told(self, struck: float) -> tuple[str, float]:
        """Strike; the bridge must say so, publish nothing, and go on once it is cured."""
        self._kind.strike(self)
        self._until(lambda: self._kind.word in self._said)
        took, blocks = time.monotonic() - struck, self._blocks
        self._for(0.5)
        if self._blocks > blocks + 1:
            return 'light was published meanwhile', took
        self._kind.cure(self)
        cured = time.monotonic()
        self._until(lambda: self._came > cured and 'receiving light' in self._said)
        back = self._came - cured
        if took > TOLD + SLACK:
            return f'told after {took:.2f} s, stated {TOLD:.1f} s', took
        if back > AGAIN + SLACK:
            return f'light again after {back:.2f} s, stated {AGAIN:.1f} s', took
        return '', took

    def _spoilt(self) -> tuple[str, float]:
        """Spoil frames for a while; light must go on, its stamps true, all of it counted."""
        self._kind.strike(self)
        board = self.server.board
        board.faults, sent = self._kind.spoilt, board.sent
        self._for(LASTS)
        board.faults, ended = SOUND, board.sent
        came = time.monotonic()
        self._until(lambda: self._came > came)
        self._for(1.2)  # health is told each second
        hits = ended // EVERY - sent // EVERY
        allowed = NEAR + 1e-3 * float(self._figures.get('round_trip_ms', '0'))
        if self._late > allowed:
            return f'a stamp is {1e3 * self._late:.1f} ms off', self._came - came
        figure = self._kind.figure
        if figure and abs(int(self._figures[figure]) - hits) > 1:  # one as the faults change
            return f'{figure} is {self._figures[figure]}, not {hits}', self._came - came
        lost = int(self._figures['rows_lost'])
        spoilt = self._kind.spoilt
        spoils = bool(spoilt.drop or spoilt.cut or spoilt.corrupt)
        if bool(lost) != spoils:
            return f'{lost} rows are counted as lost', self._came - came
        return '', self._came - came

    def _judge(self, outcome: Outcome) -> Outcome:
        """Look into the bag."""
        bag = read_bag(self.bag)
        words = {
            status.message
            for topic, _, data in bag.iterate_messages(['/diagnostics'])
            for status in bag.decode(topic, data).status
            if status.name.endswith(TASK)
        }
        expected = self._kind.word or 'receiving light'
        is_named = any(expected in word for word in words)
        return join_faults(
            outcome,
            '' if bag.is_complete else 'the bag is not whole',
            '' if is_named else f"the bag says nowhere '{expected}', but {sorted(words)}",
        )

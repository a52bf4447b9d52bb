"""
Measure the light board's bridge: an emulated board sends 8 diodes at 10 kS/s over a terminal.

The way of a block is from the frame with its last sample, handed to the terminal, to the message
of `photodiodes` in another process. `python test/benchmark/light_link.py SECONDS` prints all
figures of one long run: the way's median and 99 %, what was lost, the bridge's share of a core.
"""

from functools import cache
import os
from pathlib import Path
import signal
import subprocess
import sys
import tempfile
import threading
import time
from typing import NamedTuple

from bench import Figure
from lta_config.topics import load_topic_table
from lta_emulation.teensy.emulated_board import Cable, EmulatedBoard
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.qos import select_profile
from lta_vlc.messages import to_block
import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from record import cpu

TABLE = load_topic_table()
BRIDGE = 'from lta_bridge.nodes.teensy_bridge import main; main()'
FRAME = 15  # rows of 8 diodes
FULL = 4096  # readings of a converter
SHORT = 10.0  # s of a run of `make bench`
LEAD = 1.0  # s before what counts: discovery, and the board's clock


class Run(NamedTuple):
    """The ways of all blocks [s], blocks that never came, and the share of a core."""

    ways: 'np.ndarray[tuple[int], np.dtype[np.float64]]'
    lost: int
    share: float


class Board(threading.Thread):
    """An emulated board that keeps real time, frame by frame."""

    def __init__(self, folder: Path, seconds: float) -> None:
        super().__init__(daemon=True)
        self.cable = Cable(folder / 'tty')
        self._rate, self._frames = TABLE.light.sample_rate.si, int(seconds * 1e4 / FRAME)
        self.ended: list[float] = []  # when each frame was handed over
        self.live = threading.Event()

    def run(self) -> None:
        """Send until all is sent; count rows from when somebody listens."""
        board = EmulatedBoard(time.time_ns())
        while not self.live.is_set():
            self.cable.write(board.answer_timesync(self.cable.read(0.01), time.time_ns()))
        samples = np.random.default_rng(1).integers(0, 4096, (FRAME, 8)).astype(np.uint16)
        begun = time.monotonic()
        self.cable.write(board.encode_status())
        for turn in range(self._frames):
            left = begun + (turn + 1) * FRAME / self._rate - time.monotonic()
            asked = self.cable.read(max(0.0, left))
            if asked:
                self.cable.write(board.answer_timesync(asked, time.time_ns()))
                time.sleep(max(0.0, begun + (turn + 1) * FRAME / self._rate - time.monotonic()))
            samples[:, :2] = divmod(turn, FULL)  # which frame, for the other end
            self.ended.append(time.monotonic())
            self.cable.write(board.encode_light(samples))


def measure(seconds: float) -> Run:
    """Return what one run of the bridge gives."""
    os.environ.setdefault('ROS_DOMAIN_ID', '97')
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    with tempfile.TemporaryDirectory() as name:
        board = Board(Path(name), seconds)
        words = ['-p', f'port:={name}/tty', '-r', '__ns:=/lta1']
        bridge = subprocess.Popen([sys.executable, '-c', BRIDGE, '--ros-args', *words])
        node, came = rclpy.create_node('watch', namespace='/lta1'), []
        row = TABLE['photodiodes']
        node.create_subscription(
            find_message_type(row),
            'photodiodes',
            lambda image: came.append((frame_of(to_block(image)[-1]), time.monotonic())),
            select_profile(row, lockstep=False),
        )
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        board.start()
        while not node.count_publishers('/lta1/photodiodes'):
            executor.spin_once(0.1)
        until = time.monotonic() + LEAD
        while time.monotonic() < until:
            executor.spin_once(0.1)
        begun, before = time.monotonic(), cpu(bridge.pid)
        board.live.set()
        while board.is_alive():
            executor.spin_once(0.1)
        share = (cpu(bridge.pid) - before) / (time.monotonic() - begun)
        until = time.monotonic() + 0.5
        while time.monotonic() < until:
            executor.spin_once(0.1)
        bridge.send_signal(signal.SIGINT)
        bridge.wait()
        node.destroy_node()
        rclpy.shutdown()
    ways = [when - board.ended[frame] for frame, when in came]
    sent = len(board.ended) * FRAME // TABLE.light.samples
    return Run(np.array(ways), sent - len(ways), share)


def frame_of(row: 'np.ndarray[tuple[int], np.dtype[np.uint16]]') -> int:
    """Return the frame that brought a row: 24 bits in its first two readings."""
    return FULL * int(row[0]) + int(row[1])


@cache
def _short() -> Run:
    return measure(SHORT)


def figures() -> list[Figure]:
    """Return what `make bench` shows."""
    return [
        Figure('light_link.way', 'ms', lambda: 1e3 * float(np.median(_short().ways)), 1, min),
        Figure('light_link.core', '%', lambda: 100.0 * _short().share, 1, min),
    ]


if __name__ == '__main__':
    run = measure(float(sys.argv[1]))
    middle, late, worst = 1e3 * np.quantile(run.ways, (0.5, 0.99, 1.0))
    sys.stdout.write(
        f'{len(run.ways)} blocks, {run.lost} lost; {100 * run.share:.1f} % of a core; '
        f'way median {middle:.2f} ms, 99 % {late:.2f} ms, longest {worst:.2f} ms\n'
    )

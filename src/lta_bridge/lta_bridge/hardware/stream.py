"""What a stream of log packets comes to: rate, loss and jitter by the drone's own stamps."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_bridge.crazyflie.device_clock import WRAP
from lta_bridge.crazyflie.link import LogPacket
from lta_bridge.crazyflie.log_table import LogBlock
import numpy as np


@final
class StreamStatistics(NamedTuple):
    """
    One log block over a while.

    Attributes
    ----------
    name : str
        Of the block.
    wanted, rate : float
        Packets a second: as asked for, and between the first and the last that came. [Hz]
    packets : int
        That came.
    loss : float
        Part of those sent between the first and the last that never came.
    jitter : float
        95th percentile of how far the time between two arrivals was from that between their
        stamps. [s]

    """

    name: str
    wanted: float
    rate: float
    packets: int
    loss: float
    jitter: float


def measure_stream(block: LogBlock, packets: Sequence[LogPacket]) -> StreamStatistics:
    """
    Return what the packets of one block come to.

    Parameters
    ----------
    block : Block
        As it was asked for.
    packets : sequence of LogPacket
        In the order of arrival.

    """
    wanted = 1e3 / block.period_ms
    if len(packets) < 2:
        return StreamStatistics(block.name, wanted, 0.0, len(packets), float(not packets), 0.0)
    stamps = np.array([packet.stamp_ms for packet in packets])
    arrivals = np.array([packet.arrival_ns for packet in packets])
    gaps = (np.diff(stamps) + WRAP // 2) % WRAP - WRAP // 2  # 24 bits, that may have wrapped
    span = max(int(gaps.sum()), 1)
    sent = 1 + round(span / block.period_ms)
    uneven = np.abs(1e-9 * np.diff(arrivals) - 1e-3 * gaps)
    return StreamStatistics(
        block.name, wanted, 1e3 * (len(packets) - 1) / span, len(packets),
        max(0.0, 1.0 - len(packets) / sent), float(np.percentile(uneven, 95.0)),
    )  # fmt: skip

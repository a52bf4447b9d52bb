"""Compute rate, loss and jitter of a stream of log packets from the drone's stamps."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_bridge.crazyflie.device_clock import STAMP_WRAP
from lta_bridge.crazyflie.link import LogPacket
from lta_bridge.crazyflie.log_table import LogBlock
import numpy as np


@final
class StreamStatistics(NamedTuple):
    """Statistics of one log block."""

    name: str
    # Requested rate, and mean rate between the first and the last packet [Hz]
    requested_rate: float
    rate: float
    packets: int  # number of received packets
    loss: float  # lost fraction of the packets between the first and the last one
    # 95th percentile of the difference between arrival interval and stamp interval [s]
    jitter: float


def compute_stream_statistics(block: LogBlock, packets: Sequence[LogPacket]) -> StreamStatistics:
    """Return the statistics of one block; the packets must be in the order of arrival."""
    nominal = 1e3 / block.period_ms
    if len(packets) < 2:
        return StreamStatistics(block.name, nominal, 0.0, len(packets), float(not packets), 0.0)
    stamps = np.array([packet.stamp_ms for packet in packets])
    arrivals = np.array([packet.arrival_ns for packet in packets])
    gaps = (
        np.diff(stamps) + STAMP_WRAP // 2
    ) % STAMP_WRAP - STAMP_WRAP // 2  # the 24-bit stamps may wrap
    span = max(int(gaps.sum()), 1)
    sent = 1 + round(span / block.period_ms)
    uneven = np.abs(1e-9 * np.diff(arrivals) - 1e-3 * gaps)
    return StreamStatistics(
        block.name, nominal, 1e3 * (len(packets) - 1) / span, len(packets),
        max(0.0, 1.0 - len(packets) / sent), float(np.percentile(uneven, 95.0)),
    )  # fmt: skip

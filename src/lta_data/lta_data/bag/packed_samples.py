"""Decode messages with packed samples: ADC blocks, and the readings of the diodes (points)."""

from collections.abc import Iterable
from typing import Any, Final, Protocol

from lta_config.errors import BadInput
import numpy as np
from numpy.typing import NDArray

LIGHT_BLOCK: Final = 'lta_msgs/msg/LightBlock'
LAMP_PEAKS: Final = 'lta_msgs/msg/LampPeaks'


class LightBlockMessage(Protocol):
    """lta_msgs/LightBlock, decoded."""

    diodes: int
    counts: NDArray[np.uint16]


class Axis(Protocol):
    """geometry_msgs/Vector3, decoded."""

    x: float
    y: float
    z: float


class BeaconPeaks(Protocol):
    """lta_msgs/BeaconPeaks, decoded."""

    amplitude: NDArray[np.float32]
    snr: NDArray[np.float32]
    frequency: NDArray[np.float32]


class LampPeaks(Protocol):
    """lta_msgs/LampPeaks, decoded."""

    axis: list[Axis]
    beacon: list[BeaconPeaks]


def decode_light_block(block: LightBlockMessage) -> NDArray[Any]:
    """
    Return the samples of a lta_msgs/LightBlock.

    The result has shape (samples, diodes). Raise `BadInput` if the counts are no multiple of the
    diodes.
    """
    if not block.diodes or len(block.counts) % block.diodes:
        raise BadInput(
            f'A light block is inconsistent: {len(block.counts)} counts are no multiple of '
            f'{block.diodes} diodes; record it again.'
        )
    return block.counts.reshape(-1, block.diodes)


def stack_blocks(blocks: Iterable[Any]) -> NDArray[Any]:
    """
    Return the samples of light blocks of one shape.

    The result has shape (n, samples, diodes): (0, 0, 0) without messages.
    """
    arrays = [decode_light_block(block) for block in blocks]
    shapes = {array.shape for array in arrays}
    if len(shapes) > 1:
        raise BadInput(
            f'Light blocks of different shapes ({", ".join(map(str, sorted(shapes)))}) cannot be '
            'combined into one array; read them one by one.'
        )
    return np.stack(arrays) if arrays else np.empty((0, 0, 0), np.uint16)


def decode_lamp_peaks(peaks: LampPeaks) -> dict[str, NDArray[np.float64]]:
    """
    Return a lta_msgs/LampPeaks by field.

    Returns
    -------
    dict of str to ndarray, shape (beacons * diodes,)
        Axis x, y, z, amplitude, snr and frequency, beacon by beacon.

    Raises
    ------
    BadInput
        If a beacon has not one value for each diode.

    """
    count = len(peaks.axis)
    columns = {
        name: np.tile([getattr(axis, name) for axis in peaks.axis], len(peaks.beacon))
        for name in ('x', 'y', 'z')
    }
    for name in ('amplitude', 'snr', 'frequency'):
        rows: list[NDArray[np.float32]] = [getattr(beacon, name) for beacon in peaks.beacon]
        if any(len(row) != count for row in rows):
            raise BadInput(
                f'A message of lamp peaks is inconsistent: it has {count} diodes, but '
                f'{", ".join(str(len(row)) for row in rows)} values of {name}; record it again.'
            )
        columns[name] = np.concatenate([np.empty(0), *rows])
    return columns


def stack_points(messages: Iterable[Any]) -> dict[str, NDArray[np.float64]]:
    """
    Return the readings of several lamp peaks by field.

    Returns
    -------
    dict of str to ndarray, shape (n, points)
        NaN if a message has fewer points than the largest.

    """
    decoded = [decode_lamp_peaks(message) for message in messages]
    names = dict.fromkeys(name for fields in decoded for name in fields)
    most = max((len(column) for fields in decoded for column in fields.values()), default=0)
    result = {name: np.full((len(decoded), most), np.nan) for name in names}
    for row, fields in enumerate(decoded):
        for name, column in fields.items():
            result[name][row, : len(column)] = column
    return result

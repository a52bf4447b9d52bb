"""
Decode messages with packed samples: ADC blocks and the readings of the diodes (points).

Each is a message of lta_msgs or a standard one, as in older bags: `BLOCKS` and `POINTS`.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final, Protocol

from lta_config.errors import BadInput, unknown_name_error
import numpy as np
from numpy.typing import NDArray

# Image encoding -> numpy type.
PIXELS = {'8UC1': 'u1', '16UC1': 'u2', '16SC1': 'i2', '32SC1': 'i4', '32FC1': 'f4', '64FC1': 'f8'}
# PointField.datatype -> numpy type.
POINT_TYPES = {1: 'i1', 2: 'u1', 3: 'i2', 4: 'u2', 5: 'i4', 6: 'u4', 7: 'f4', 8: 'f8'}


class Image(Protocol):
    """sensor_msgs/Image, decoded."""

    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int
    data: NDArray[np.uint8]


class PointField(Protocol):
    """sensor_msgs/PointField, decoded."""

    name: str
    offset: int
    datatype: int
    count: int


class PointCloud(Protocol):
    """sensor_msgs/PointCloud2, decoded."""

    height: int
    width: int
    fields: list[PointField]
    is_bigendian: bool
    point_step: int
    row_step: int
    data: NDArray[np.uint8]


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


def decode_image(image: Image) -> NDArray[Any]:
    """
    Return the samples of a one-channel sensor_msgs/Image.

    The result has shape (rows, columns): of the type given by `encoding`. Raise `BadInput` if the
    encoding has several channels or the data are too short.
    """
    if image.encoding not in PIXELS:
        raise unknown_name_error('image encoding', image.encoding, list(PIXELS))
    kind = np.dtype(('>' if image.is_bigendian else '<') + PIXELS[image.encoding])
    shape = (image.height, image.width)
    strides = (image.step, kind.itemsize)
    if len(image.data) < image.height * image.step or image.step < image.width * kind.itemsize:
        raise BadInput(
            f'An image message is inconsistent: {image.height} x {image.width} pixels in rows of '
            f'{image.step} bytes do not match {len(image.data)} bytes of data; record it again.'
        )
    # Rows may be padded: step is the length of a row in bytes
    samples: NDArray[Any] = np.ndarray(shape, kind, image.data.tobytes(), strides=strides)
    return samples.astype(kind.newbyteorder('='))


def stack_blocks(type_name: str, messages: Iterable[Any]) -> NDArray[Any]:
    """
    Return the samples of messages of one shape; `type_name` is one of `BLOCKS`.

    The result has shape (n, rows, columns): (0, 0, 0) without messages.
    """
    decode = BLOCKS[type_name]
    blocks = [decode(message) for message in messages]
    shapes = {block.shape for block in blocks}
    if len(shapes) > 1:
        raise BadInput(
            f'Images of different shapes ({", ".join(map(str, sorted(shapes)))}) cannot be '
            'combined into one array; read them one by one.'
        )
    return np.stack(blocks) if blocks else np.empty((0, 0, 0), np.uint16)


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


def decode_point_cloud(cloud: PointCloud) -> dict[str, NDArray[np.float64]]:
    """
    Return the points of a sensor_msgs/PointCloud2 by field.

    Returns
    -------
    dict of str to ndarray, shape (points,)
        Fields with one value per point, row after row.

    Raises
    ------
    BadInput
        If a field has an unknown type, or layout and data do not match.

    """
    # Fields with several elements per point are not supported and left out
    single = [field for field in cloud.fields if field.count == 1]
    for field in single:
        if field.datatype not in POINT_TYPES:
            raise unknown_name_error(
                'point field type', str(field.datatype), list(map(str, POINT_TYPES))
            )
    if not has_valid_layout(cloud, single):
        raise BadInput(
            f'A point cloud message is inconsistent: {cloud.height} x {cloud.width} points of '
            f'{cloud.point_step} bytes ({len(cloud.fields)} fields) in rows of {cloud.row_step} '
            f'bytes do not match {len(cloud.data)} bytes of data; record it again.'
        )
    if not single:
        return {}
    order = '>' if cloud.is_bigendian else '<'
    kind = np.dtype(
        {
            'names': [field.name for field in single],
            'formats': [order + POINT_TYPES[field.datatype] for field in single],
            'offsets': [field.offset for field in single],
            'itemsize': cloud.point_step,
        }
    )
    # Rows and points may be padded, so cut each row to its points first
    rows = cloud.data[: cloud.height * cloud.row_step].reshape(cloud.height, cloud.row_step)
    used = np.ascontiguousarray(rows[:, : cloud.width * cloud.point_step])
    points = used.reshape(-1).view(kind)
    return {field.name: points[field.name].astype(np.float64) for field in single}


def has_valid_layout(cloud: PointCloud, fields: Sequence[PointField]) -> bool:
    """Return whether fields fit into points, points into rows, and rows into the data."""
    ends = [field.offset + np.dtype(POINT_TYPES[field.datatype]).itemsize for field in fields]
    return (
        max(ends, default=0) <= cloud.point_step
        and cloud.width * cloud.point_step <= cloud.row_step
        and cloud.height * cloud.row_step <= len(cloud.data)
        and len({field.name for field in fields}) == len(fields)
    )


def stack_points(type_name: str, messages: Iterable[Any]) -> dict[str, NDArray[np.float64]]:
    """
    Return the points of several messages by field; `type_name` is one of `POINTS`.

    Returns
    -------
    dict of str to ndarray, shape (n, points)
        NaN if a message has fewer points than the largest, or lacks the field.

    """
    decode = POINTS[type_name]
    decoded = [decode(message) for message in messages]
    names = dict.fromkeys(name for fields in decoded for name in fields)
    most = max((len(column) for fields in decoded for column in fields.values()), default=0)
    result = {name: np.full((len(decoded), most), np.nan) for name in names}
    for row, fields in enumerate(decoded):
        for name, column in fields.items():
            result[name][row, : len(column)] = column
    return result


BLOCKS: Final[Mapping[str, Callable[[Any], NDArray[Any]]]] = {
    'lta_msgs/msg/LightBlock': decode_light_block,
    'sensor_msgs/msg/Image': decode_image,
}
POINTS: Final[Mapping[str, Callable[[Any], dict[str, NDArray[np.float64]]]]] = {
    'lta_msgs/msg/LampPeaks': decode_lamp_peaks,
    'sensor_msgs/msg/PointCloud2': decode_point_cloud,
}

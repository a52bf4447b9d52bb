"""Convert between light data and ROS messages."""

import array
from collections.abc import Sequence
from typing import TYPE_CHECKING

from geometry_msgs.msg import PoseWithCovarianceStamped, Vector3, Vector3Stamped
from lta_config.covariances import UNKNOWN_VARIANCE
from lta_config.topics import load_topic_table
from lta_graph.blank_message import create_message
from lta_graph.ros.message_validation import find_message_type
from lta_vlc.bearing import Bearing
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import Axis
from lta_vlc.lamp import LampEstimate
import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import Image, PointCloud2, PointField
from std_msgs.msg import Header

if TYPE_CHECKING:  # not built on every machine; see the type of a topic in the table
    from lta_msgs.msg import LampPeaks, LightBlock

UPPER = np.triu_indices(3)
FIELDS = ('x', 'y', 'z', 'amplitude', 'snr', 'frequency')


def to_block(message: 'LightBlock | Image') -> NDArray[np.uint16]:
    """Return the ADC block, shape (samples, diodes); `ValueError` if inconsistent."""
    if isinstance(message, Image):
        return _read_image(message)
    counts, diodes = message.counts, message.diodes
    if not diodes or len(counts) % diodes:
        raise ValueError(
            f'the light message has {len(counts)} counts, which is no multiple of its '
            f'{diodes} diodes'
        )
    return np.frombuffer(counts, dtype=np.uint16).reshape(-1, diodes)


def _read_image(message: Image) -> NDArray[np.uint16]:
    """Return the ADC block of an image; `ValueError` if inconsistent."""
    # np.frombuffer below assumes this layout
    if message.encoding != '16UC1' or message.is_bigendian:
        raise ValueError(
            'the light message must have the encoding 16UC1 (little endian), not '
            f'{message.encoding}'
        )
    if len(message.data) != 2 * message.height * message.width:
        raise ValueError(
            f'the light message has {len(message.data)} bytes of data, but needs 2 bytes for '
            f'each of its {message.height} x {message.width} samples'
        )
    return np.frombuffer(message.data, dtype='<u2').reshape(message.height, message.width)


def from_peaks(
    header: Header, peaks: tuple[Peaks, ...], axes: Sequence[Axis]
) -> 'LampPeaks | PointCloud2':
    """Return amplitude, SNR and frequency of each beacon at each diode, with the diodes' axes."""
    message = find_message_type(load_topic_table()['light/peaks'])(header=header)
    if isinstance(message, PointCloud2):
        _fill_cloud(message, peaks, axes)
        return message
    # In the precision of a cloud's points, so that a drone flies alike with both messages
    message.axis = [
        Vector3(x=x, y=y, z=z) for x, y, z in np.asarray(axes, np.float32).astype(float).tolist()
    ]
    from lta_msgs.msg import BeaconPeaks

    message.beacon = [
        BeaconPeaks(
            amplitude=_to_floats(each.amplitude),
            snr=_to_floats(each.snr),
            frequency=_to_floats(each.frequency),
        )
        for each in peaks
    ]
    return message


def _to_floats(values: NDArray[np.float64]) -> 'array.array[float]':
    """Return numbers as rclpy accepts them without checking each item."""
    return array.array('f', np.asarray(values, np.float32).tobytes())


def _fill_cloud(message: PointCloud2, peaks: tuple[Peaks, ...], axes: Sequence[Axis]) -> None:
    """Fill in a row for each beacon, a point for each diode."""
    count = len(axes)
    message.height, message.width, message.is_dense = len(peaks), count, True
    message.fields = [
        PointField(name=name, offset=4 * index, datatype=PointField.FLOAT32, count=1)
        for index, name in enumerate(FIELDS)
    ]
    message.point_step = 4 * len(FIELDS)
    message.row_step = message.point_step * count
    # Little endian, as is_bigendian is false by default
    data = np.zeros((len(peaks), count, len(FIELDS)), dtype='<f4')
    for row, each in zip(data, peaks, strict=True):
        row[:, :3] = axes
        row[:, 3], row[:, 4], row[:, 5] = each.amplitude, each.snr, each.frequency
    # rclpy accepts a byte array without checking each item
    message.data = array.array('B', data.tobytes())


def from_bearing(header: Header, bearing: Bearing | None) -> Vector3Stamped:
    """Return the paper's vector; zero without a bearing."""
    message = Vector3Stamped(header=header)
    if bearing is not None:
        message.vector.x, message.vector.y = bearing.x, bearing.y
    return message


def from_lamp(header: Header, lamp: LampEstimate | None) -> PoseWithCovarianceStamped:
    """Return the lamp in the body frame; its variances are huge if none is detected."""
    message = create_message(PoseWithCovarianceStamped)
    message.header = header
    covariance = np.zeros((6, 6))
    if lamp is None:
        covariance[:3, :3] = UNKNOWN_VARIANCE * np.eye(3)
    else:
        position = message.pose.pose.position
        position.x, position.y, position.z = lamp[:3]
        # xx xy xz yy yz zz is the upper triangle, row by row
        covariance[UPPER] = covariance.T[UPPER] = lamp[3:]
    message.pose.covariance = covariance.ravel()
    return message

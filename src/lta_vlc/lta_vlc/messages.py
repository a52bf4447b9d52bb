"""Convert between light data and ROS messages."""

import array
from collections.abc import Sequence

from geometry_msgs.msg import PoseWithCovarianceStamped, Vector3Stamped
from lta_config.covariances import UNKNOWN_VARIANCE
from lta_vlc.bearing import Bearing
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import Axis
from lta_vlc.lamp import LampEstimate
import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import Image, PointCloud2, PointField
from std_msgs.msg import Header

FIELDS = ('x', 'y', 'z', 'amplitude', 'snr', 'frequency')


def to_block(message: Image) -> NDArray[np.uint16]:
    """Return the ADC block of an image, shape (samples, diodes); `ValueError` if inconsistent."""
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


def from_peaks(header: Header, peaks: tuple[Peaks, ...], axes: Sequence[Axis]) -> PointCloud2:
    """Return a row for each beacon, a point for each diode: axis, amplitude, SNR, frequency."""
    count = len(axes)
    message = PointCloud2(header=header, height=len(peaks), width=count, is_dense=True)
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
    return message


def from_bearing(header: Header, bearing: Bearing | None) -> Vector3Stamped:
    """Return the paper's vector; zero without a bearing."""
    message = Vector3Stamped(header=header)
    if bearing is not None:
        message.vector.x, message.vector.y = bearing.x, bearing.y
    return message


def from_lamp(header: Header, lamp: LampEstimate | None) -> PoseWithCovarianceStamped:
    """Return the lamp in the body frame; its variances are huge if none is detected."""
    message = PoseWithCovarianceStamped(header=header)
    covariance = np.zeros((6, 6))
    if lamp is None:
        covariance[:3, :3] = UNKNOWN_VARIANCE * np.eye(3)
    else:
        position = message.pose.pose.position
        position.x, position.y, position.z = lamp[:3]
        # xx xy xz yy yz zz is the upper triangle, row by row
        covariance[np.triu_indices(3)] = lamp[3:]
        covariance[np.tril_indices(3)] = covariance.T[np.tril_indices(3)]
    message.pose.covariance = covariance.ravel()
    return message

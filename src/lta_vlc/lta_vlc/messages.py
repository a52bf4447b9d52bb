# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert between light data and ROS messages, and say what the health of the light is."""

import array
from collections.abc import Iterator, Sequence
import math

from geometry_msgs.msg import PoseWithCovarianceStamped, Vector3, Vector3Stamped
from lta_config.covariances import UNKNOWN_VARIANCE
from lta_graph.health import HealthFact, HealthLevel
from lta_msgs.msg import BeaconPeaks, LampPeaks, LightBlock
from lta_vlc.demodulation import DemodulatedBlock, DiodeFault, Peaks
from lta_vlc.diodes import Axis
from lta_vlc.lamp import Bearing, LampEstimate
from lta_vlc.receiver import BeaconPresence
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header

UPPER = np.triu_indices(3)


def to_block(message: LightBlock) -> NDArray[np.uint16]:
    """Return the ADC block, shape (samples, diodes); `ValueError` if inconsistent."""
    counts, diodes = message.counts, message.diodes
    if not diodes or len(counts) % diodes:
        raise ValueError(
            f'the light message has {len(counts)} counts, which is no multiple of its '
            f'{diodes} diodes'
        )
    return np.frombuffer(counts, dtype=np.uint16).reshape(-1, diodes)


def from_peaks(header: Header, peaks: tuple[Peaks, ...], axes: Sequence[Axis]) -> LampPeaks:
    """Return amplitude, SNR and frequency of each beacon at each diode, with the diodes' axes."""
    return LampPeaks(
        header=header,
        # In single precision, as the other numbers
        axis=[
            Vector3(x=x, y=y, z=z)
            for x, y, z in np.asarray(axes, np.float32).astype(float).tolist()
        ],
        beacon=[
            BeaconPeaks(
                amplitude=_to_floats(each.amplitude),
                snr=_to_floats(each.snr),
                frequency=_to_floats(each.frequency),
            )
            for each in peaks
        ],
    )


def _to_floats(values: NDArray[np.float64]) -> 'array.array[float]':
    """Return numbers as rclpy accepts them without checking each item."""
    return array.array('f', np.asarray(values, np.float32).tobytes())


def from_bearing(header: Header, bearing: Bearing | None) -> Vector3Stamped:
    """Return the paper's vector; zero without a bearing."""
    message = Vector3Stamped(header=header)
    if bearing is not None:
        message.vector.x, message.vector.y = bearing.x, bearing.y
    return message


def from_lamp(header: Header, lamp: LampEstimate | None) -> PoseWithCovarianceStamped:
    """Return the lamp in the body frame; its variances are huge if none is detected."""
    message = PoseWithCovarianceStamped()
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


WANTED_TASK = 'light'  # diagnostics task of the wanted beacon


def describe_beacons(
    hearing: DemodulatedBlock,
    beacons: tuple[float, ...],
    presences: tuple[BeaconPresence, ...],
    missing: int,
    refused: int,
) -> Iterator[HealthFact]:
    """
    Yield a fact for each beacon; that of the wanted one, which is first, includes the diodes.

    `beacons` are nominal frequencies [Hz]; `missing` and `refused` count blocks since the start.
    """
    for one, beacon in enumerate(beacons):
        is_detected = presences[one].found
        best = float(hearing.peaks[one].snr.max())
        # A beacon that is not detected has no frequency error.
        error = hearing.frequencies[one] - beacon if is_detected and best > 0.0 else math.nan
        values = {
            'beacon_Hz': f'{beacon:g}',
            'best_snr': f'{best:.1f}',
            'frequency_error_Hz': f'{error:.3f}',
        }
        # Diode faults concern all beacons; they are reported once
        if one == 0:
            values |= {
                'saturated_diodes': _count_faulty_diodes(hearing, DiodeFault.SATURATED),
                'flat_diodes': _count_faulty_diodes(hearing, DiodeFault.FLAT),
                'wild_diodes': _count_faulty_diodes(hearing, DiodeFault.NOT_A_NUMBER),
                'aliased_diodes': _count_faulty_diodes(hearing, DiodeFault.ALIASED),
                'blocks_missing': str(missing),
                'blocks_refused': str(refused),
            }
        yield HealthFact(
            WANTED_TASK if one == 0 else f'beacon at {beacon:g} Hz',
            # Only the wanted beacon is needed for the flight
            HealthLevel.OK if is_detected or one > 0 else HealthLevel.WARN,
            'beacon found' if is_detected else 'no photodiode receives the beacon',
            values,
        )


def _count_faulty_diodes(hearing: DemodulatedBlock, fault: DiodeFault) -> str:
    """Return how many diodes have a fault."""
    return str(sum(fault in each for each in hearing.faults))

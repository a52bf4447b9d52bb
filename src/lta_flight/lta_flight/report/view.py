"""
A flight as the report looks at it: each part read once, everything in one frame.

Time runs in seconds from the first message, positions are in the map frame. The estimator's own
frame starts at zero; it is laid on the truth where both begin.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Final, final

from lta_config.topics import topic_table
from lta_data.bag.channels import UNKNOWN
from lta_data.bag.flight import Flight, Points
from lta_data.bag.series import Series
from lta_data.scene import scene_of
from lta_flight.report.goal import Goal
from lta_model.attitude import angles
from lta_report.curves import (
    Array,
    Arrow,
    Duties,
    Electricity,
    laid,
    Motion,
    moved,
    pointed,
    through_air,
    Track,
)
import numpy as np
from numpy.typing import NDArray

# What the page is made of besides point lists: read together, in one pass over the bag.
TOGETHER: Final = (
    'ground_truth/odom',
    'odom',
    'wind',
    'setpoint/pose',
    'setpoint/velocity',
    'range',
    'motors',
    'light/bearing',
    'light/estimate',
    'battery',
    'panel',
    'photodiodes',
)


def of_wanted(fields: dict[str, Array]) -> dict[str, Array]:
    """
    Return the points of the wanted beacon, which come first in each cloud.

    On a route a cloud has a row of diodes for each beacon that is listened for, so that its points
    begin again with the first diode's axis; clouds of fewer beacons end in NaN.
    """
    axes = np.stack([fields['x'], fields['y'], fields['z']], axis=-1)
    again = np.flatnonzero((axes[:, 1:] == axes[:, :1]).all(axis=-1).any(axis=0))
    diodes = int(again[0]) + 1 if len(again) else axes.shape[1]
    return {name: values[:, :diodes] for name, values in fields.items()}


def half_block() -> float:
    """Return the time from the first sample of a light block to its middle. [s]"""
    light = topic_table().light
    return light.samples / light.sample_rate.si / 2.0


@final
class View:
    """
    What the pictures and results are made of.

    Parameters
    ----------
    flight : Flight
        The recording of one robot.

    Raises
    ------
    BadInput
        If the bag carries a scenario or vehicle file that cannot be read.

    """

    def __init__(self, flight: Flight) -> None:
        self.flight = flight
        self.provenance = flight.provenance
        self.scene = scene_of(self.provenance)
        self._read: dict[str, Series] = {}
        self._blocks: dict[tuple[int, ...], NDArray[Any]] = {}

    def has(self, *topics: str) -> bool:
        """Tell whether the bag has messages of all these topics."""
        bag, robot = self.flight.bag, self.flight.robot
        names = [f'/{robot}/{topic}' if robot else f'/{topic}' for topic in topics]
        return all(name in bag.topics and bag.topics[name].count > 0 for name in names)

    def series(self, topic: str) -> Series:
        """Return a topic's fields, read once."""
        if topic not in self._read:
            here = [each for each in TOGETHER if self.has(each) and each not in self._read]
            self._read |= self.flight.read({topic, *here})
        return self._read[topic]

    @cached_property
    def span(self) -> tuple[float, float]:
        """First and last instant of the motion, or of the bag where there is none. [s]"""
        for topic in ('ground_truth/odom', 'odom'):
            if self.has(topic):
                time = self.series(topic).time
                return float(time[0]), float(time[-1])
        bag = self.flight.bag
        return 0.0, 0.0 if bag.start is None or bag.end is None else (bag.end - bag.start) * 1e-9

    @cached_property
    def goal(self) -> Goal:
        """The lamps to be reached, and when each was."""
        return Goal(self.scene.scenario, self.truth if self.has('ground_truth/odom') else None)

    @cached_property
    def truth(self) -> Motion:
        """The true motion; the wind is taken off the speed."""
        motion = self._motion('ground_truth/odom')
        if not self.has('wind'):
            return motion
        wind = self.series('wind')
        return through_air(motion, wind.time, wind.vector('vector'))

    @cached_property
    def estimate(self) -> Motion:
        """The drone's own idea of its motion, laid on the truth at the start."""
        motion = self._motion('odom')
        return laid(motion, self.truth) if self.has('ground_truth/odom') else motion

    @cached_property
    def turn(self) -> float:
        """Angle from the estimator's x to map's. [rad]"""
        return float(self.estimate.yaw[0] - self._motion('odom').yaw[0])

    @cached_property
    def heading_setpoint(self) -> Track:
        """Heading to hold, in map, without jumps. [rad]"""
        series = self.series('setpoint/pose')
        yaw = angles(series.vector('pose.orientation')).yaw
        return Track(series.time, np.unwrap(np.nan_to_num(yaw)) + self.turn)

    @cached_property
    def altitude_setpoint(self) -> Track:
        """Altitude to hold. [m]"""
        series = self.series('setpoint/pose')
        return Track(series.time, series['pose.position.z'])

    @cached_property
    def speed_setpoint(self) -> Track:
        """Forward airspeed to hold. [m/s]"""
        series = self.series('setpoint/velocity')
        return Track(series.time, series['twist.linear.x'])

    @cached_property
    def range(self) -> Track:
        """Measured range plus the sensor's distance below the hull centre. [m]"""
        series = self.series('range')
        vehicle = self.scene.vehicle
        below = 0.0 if vehicle is None else -vehicle.sensors.range_position.vector[2]
        return Track(
            series.time, np.where(np.isfinite(series['range']), series['range'], np.nan) + below
        )

    @cached_property
    def duties(self) -> Duties:
        """Commands to the rotors."""
        series = self.series('motors')
        names = [
            str(series.texts[f'name[{k}]'][-1])
            for k in range(len(series.texts))
            if f'name[{k}]' in series.texts
        ]
        efforts = [series[f'effort[{k}]'] for k in range(len(names))]
        return Duties(series.time, names, np.stack(efforts, axis=1))

    def blocks(self, chosen: Sequence[int]) -> NDArray[Any]:
        """Return some ADC blocks, shape (chosen, samples, diodes), read once."""
        which = tuple(chosen)
        if which not in self._blocks:
            order, places = np.unique(which, return_inverse=True)
            found = self.flight.blocks('photodiodes', order.tolist())
            self._blocks[which] = found.samples[places]
        return self._blocks[which]

    @cached_property
    def half_block(self) -> float:
        """From a light message's stamp, its block's first sample, to the block's middle. [s]"""
        return half_block()

    @cached_property
    def peaks(self) -> Points:
        """Amplitude [counts], SNR and frequency [Hz] of each diode, wanted lamp, mid-block."""
        points = self.flight.points('light/peaks')
        return Points(points.time + self.half_block, of_wanted(points.fields))

    @cached_property
    def sighting(self) -> Arrow:
        """Direction to the lamp that the drone steers by, body frame, mid-block."""
        series = self.series('light/estimate')
        place = series.vector('pose.pose.position')
        seen = series['pose.covariance[0]'] != UNKNOWN
        return Arrow(series.time + self.half_block, pointed(np.where(seen[:, None], place, 0.0)))

    @cached_property
    def bearing(self) -> Arrow:
        """The paper's direction to the lamp in the body frame, at the middle of its block."""
        series = self.series('light/bearing')
        return Arrow(series.time + self.half_block, pointed(series.vector('vector')))

    @cached_property
    def battery(self) -> Electricity:
        """The cell as measured."""
        return self._electricity('battery')

    @cached_property
    def panel(self) -> Electricity:
        """The harvesting branch as measured."""
        return self._electricity('panel')

    def _electricity(self, topic: str) -> Electricity:
        series = self.series(topic)
        return Electricity(series.time, series['voltage'], series['current'])

    def _motion(self, topic: str) -> Motion:
        """Return a topic of nav_msgs/Odometry as it is written."""
        series = self.series(topic)
        place, attitude = (
            series.vector('pose.pose.position'),
            series.vector('pose.pose.orientation'),
        )
        return moved(series.time, place, attitude, series['twist.twist.linear.x'])

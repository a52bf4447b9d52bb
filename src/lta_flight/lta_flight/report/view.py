# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The data of a recorded flight for results and figures, read once and in one frame.

Time is in seconds from the first message, positions are in the map frame. The estimator's frame
starts at zero and is aligned with the truth at the start.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Final, final

from lta_config.covariances import select_estimates
from lta_config.topics import load_topic_table
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.bag.table import get_column, group_points, stack_components, Table
from lta_data.even_grid import check_time_span, median_period
from lta_data.scene import read_scene
from lta_flight.report.goal import FlightGoal
from lta_report.curves import (
    align_start,
    Array,
    build_motion,
    DirectionCurve,
    DutyCurves,
    ElectricalCurve,
    MotionCurve,
    PeakCurves,
    subtract_wind,
    TimeCurve,
    vector_directions,
)
import numpy as np
from numpy.typing import NDArray

# Topics of the page that are read together, in one pass over the bag
TOPICS_READ_TOGETHER: Final = (
    'ground_truth/odom',
    'odom',
    'airspeed',
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


def select_primary_beacon(fields: dict[str, Array]) -> dict[str, Array]:
    """
    Return the points of the wanted beacon, which come first in each cloud.

    On a route a cloud has one row of diodes per tracked beacon, so the first diode's axis repeats.
    Clouds with fewer beacons are padded with NaN.
    """
    axes = np.stack([fields['x'], fields['y'], fields['z']], axis=-1)
    # Columns, after the first, whose axis equals that of the first diode in some cloud
    again = np.flatnonzero((axes[:, 1:] == axes[:, :1]).all(axis=-1).any(axis=0))
    diodes = int(again[0]) + 1 if len(again) else axes.shape[1]
    return {name: values[:, :diodes] for name, values in fields.items()}


def half_block_time() -> float:
    """Return the time from the first sample of a light block to its middle [s]."""
    light = load_topic_table().light
    return light.samples / light.sample_rate.si / 2.0


@final
class FlightView:
    """
    The data of a recorded flight.

    `flight`: the recording of one robot. Raise `BadInput` if the scenario or vehicle file in the
    bag cannot be read.
    """

    def __init__(self, flight: RecordedFlight) -> None:
        self.flight = flight
        self.provenance = flight.provenance
        self.scene = read_scene(self.provenance)
        self._read: dict[str, Table] = {}
        self._blocks: dict[tuple[int, ...], NDArray[Any]] = {}

    def has_topics(self, *topics: str) -> bool:
        """Return whether the bag has messages of all these topics."""
        bag, robot = self.flight.bag, self.flight.robot
        names = [f'/{robot}/{topic}' if robot else f'/{topic}' for topic in topics]
        return all(name in bag.topics and bag.topics[name].count > 0 for name in names)

    def read_table(self, topic: str) -> Table:
        """Return the fields of a topic; each is read once."""
        # Reading a bag is slow, so fetch all usual topics with the first one
        if topic not in self._read:
            here = [
                each
                for each in TOPICS_READ_TOGETHER
                if self.has_topics(each) and each not in self._read
            ]
            self._read |= self.flight.read_tables({topic, *here})
        return self._read[topic]

    def read_curve(self, topic: str, column: str) -> TimeCurve:
        """Return a column of a topic over time."""
        table = self.read_table(topic)
        return TimeCurve(table.index.to_numpy(), get_column(table, column))

    def read_vector(self, topic: str, path: str) -> tuple[Array, Array]:
        """Return time and components of a field of a topic, shape (n, 3) or (n, 4)."""
        table = self.read_table(topic)
        return table.index.to_numpy(), stack_components(table, path)

    @cached_property
    def span(self) -> tuple[float, float]:
        """First and last time of the motion, or of the bag if there is none [s]."""
        for topic in ('ground_truth/odom', 'odom'):
            if self.has_topics(topic):
                time = self._read_motion(topic).time
                return float(time[0]), float(time[-1])
        return 0.0, self.flight.bag.duration

    @cached_property
    def goal(self) -> FlightGoal:
        """Return the target lamps, and when each was reached."""
        return FlightGoal(
            self.scene.scenario,
            self.truth if self.has_topics('ground_truth/odom') else None,
            self.provenance.get('strategy', ''),
        )

    @cached_property
    def truth(self) -> MotionCurve:
        """Return the true motion, with the speed relative to the air."""
        motion = self._read_motion('ground_truth/odom')
        if not self.has_topics('wind'):
            return motion
        return subtract_wind(motion, *self.read_vector('wind', 'vector'))

    @cached_property
    def estimate(self) -> MotionCurve:
        """Return the estimated motion, aligned with the truth at the start, with the airspeed."""
        motion = self._read_motion('odom')
        if self.has_topics('airspeed'):
            airspeed = self.read_curve('airspeed', 'twist.twist.linear.x')
            motion = motion._replace(speed=np.interp(motion.time, *airspeed))
        return align_start(motion, self.truth) if self.has_topics('ground_truth/odom') else motion

    @cached_property
    def frame_rotation(self) -> float:
        """Angle from the estimator's x axis to that of map [rad]."""
        return float(self.estimate.yaw[0] - self._read_motion('odom').yaw[0])

    @cached_property
    def heading_setpoint(self) -> TimeCurve:
        """Heading setpoint in map, unwrapped [rad]."""
        time, yaw = self.read_curve('setpoint/pose', 'pose.orientation.yaw')
        return TimeCurve(time, np.unwrap(np.nan_to_num(yaw)) + self.frame_rotation)

    @cached_property
    def altitude_setpoint(self) -> TimeCurve:
        """Altitude setpoint [m]."""
        return self.read_curve('setpoint/pose', 'pose.position.z')

    @cached_property
    def speed_setpoint(self) -> TimeCurve:
        """Forward airspeed setpoint [m/s]."""
        return self.read_curve('setpoint/velocity', 'twist.linear.x')

    @cached_property
    def range_altitude(self) -> TimeCurve:
        """Altitude of the hull centre from the range finder [m]."""
        time, distance = self.read_curve('range', 'range')
        vehicle = self.scene.vehicle
        # Depth of the sensor below the hull centre; body z points up
        below = 0.0 if vehicle is None else -vehicle.sensors.range_position.vector[2]
        return TimeCurve(time, np.where(np.isfinite(distance), distance, np.nan) + below)

    @cached_property
    def duties(self) -> DutyCurves:
        """Commanded duties of the rotors."""
        table = self.read_table('motors')
        names = [name for name in table if name.startswith('effort.')]
        efforts = table[names].to_numpy(dtype=np.float64)
        return DutyCurves(
            table.index.to_numpy(), [name.removeprefix('effort.') for name in names], efforts
        )

    def read_blocks(self, chosen: Sequence[int]) -> NDArray[Any]:
        """Return some ADC blocks, shape (chosen, samples, diodes); each is read once."""
        which = tuple(chosen)
        if which not in self._blocks:
            # The bag is read in order; `places` restores the requested order
            order, places = np.unique(which, return_inverse=True)
            blocks = self.flight.read_blocks('photodiodes', order.tolist())
            self._blocks[which] = blocks.samples[places]
        return self._blocks[which]

    @cached_property
    def half_block_time(self) -> float:
        """Time from a block's stamp, that of its first sample, to its middle [s]."""
        return half_block_time()

    @cached_property
    def peaks(self) -> PeakCurves:
        """Amplitude [counts], SNR and frequency [Hz] of the wanted lamp per diode, mid-block."""
        table = self.read_table('light/peaks')
        return PeakCurves(
            table.index.to_numpy() + self.half_block_time,
            select_primary_beacon(group_points(table)),
        )

    @cached_property
    def sighting(self) -> DirectionCurve:
        """Direction to the lamp that the drone steers by, body frame, mid-block."""
        time, place = self.read_vector('light/estimate', 'pose.pose.position')
        # The variance marks a block without a lamp
        seen = select_estimates(self.read_curve('light/estimate', 'pose.covariance[0]').value)
        return DirectionCurve(
            time + self.half_block_time,
            vector_directions(np.where(seen[:, None], place, 0.0)),
        )

    @cached_property
    def bearing(self) -> DirectionCurve:
        """Return the paper's bearing of the lamp, body frame, mid-block."""
        time, vector = self.read_vector('light/bearing', 'vector')
        return DirectionCurve(time + self.half_block_time, vector_directions(vector))

    @cached_property
    def battery(self) -> ElectricalCurve:
        """Return the battery as measured."""
        return self._read_electricity('battery')

    @cached_property
    def panel(self) -> ElectricalCurve:
        """Voltage and current of the solar panel as measured."""
        return self._read_electricity('panel')

    def _read_electricity(self, topic: str) -> ElectricalCurve:
        table = self.read_table(topic)
        return ElectricalCurve(
            table.index.to_numpy(), get_column(table, 'voltage'), get_column(table, 'current')
        )

    def _read_motion(self, topic: str) -> MotionCurve:
        """Return a topic of nav_msgs/Odometry as a motion."""
        time, place = self.read_vector(topic, 'pose.pose.position')
        check_time_span(f"of '{topic}'", float(np.ptp(time)), median_period(time), len(time))
        _, attitude = self.read_vector(topic, 'pose.pose.orientation')
        speed = self.read_curve(topic, 'twist.twist.linear.x').value
        return build_motion(time, place, attitude, speed)

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
from lta_data.bag.channels import find_airspeed_topic
from lta_data.bag.columns import TopicSeries
from lta_data.bag.recorded_flight import PointSeries, RecordedFlight
from lta_data.even_grid import check_time_span, median_period
from lta_data.scene import read_scene
from lta_flight.report.goal import FlightGoal
from lta_model.attitude import to_euler_angles
from lta_report.curves import (
    align_start,
    Array,
    build_motion,
    DirectionCurve,
    DutyCurves,
    ElectricalCurve,
    MotionCurve,
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
    """Return the time from the first sample of a light block to its middle. [s]"""
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
        self._read: dict[str, TopicSeries] = {}
        self._blocks: dict[tuple[int, ...], NDArray[Any]] = {}

    def has_topics(self, *topics: str) -> bool:
        """Return whether the bag has messages of all these topics."""
        bag, robot = self.flight.bag, self.flight.robot
        names = [f'/{robot}/{topic}' if robot else f'/{topic}' for topic in topics]
        return all(name in bag.topics and bag.topics[name].count > 0 for name in names)

    def read_series(self, topic: str) -> TopicSeries:
        """Return the fields of a topic; each is read once."""
        # Reading a bag is slow, so fetch all usual topics with the first one
        if topic not in self._read:
            here = [
                each
                for each in TOPICS_READ_TOGETHER
                if self.has_topics(each) and each not in self._read
            ]
            self._read |= self.flight.read_topics({topic, *here})
        return self._read[topic]

    @cached_property
    def span(self) -> tuple[float, float]:
        """First and last time of the motion, or of the bag if there is none. [s]"""
        for topic in ('ground_truth/odom', 'odom'):
            if self.has_topics(topic):
                time = self._read_motion(topic).time
                return float(time[0]), float(time[-1])
        bag = self.flight.bag
        return 0.0, 0.0 if bag.start is None or bag.end is None else (bag.end - bag.start) * 1e-9

    @cached_property
    def goal(self) -> FlightGoal:
        """The target lamps, and when each was reached."""
        return FlightGoal(
            self.scene.scenario,
            self.truth if self.has_topics('ground_truth/odom') else None,
            self.provenance.get('strategy', ''),
        )

    @cached_property
    def truth(self) -> MotionCurve:
        """The true motion, with the speed relative to the air."""
        motion = self._read_motion('ground_truth/odom')
        if not self.has_topics('wind'):
            return motion
        wind = self.read_series('wind')
        return subtract_wind(motion, wind.time, wind.vector('vector'))

    @cached_property
    def estimate(self) -> MotionCurve:
        """The estimated motion, aligned with the truth at the start, with the airspeed."""
        motion = self._read_motion('odom')
        topic = find_airspeed_topic(self.flight.topics)
        if topic != 'odom':
            airspeed = self.read_series(topic)
            speed = np.interp(motion.time, airspeed.time, airspeed['twist.twist.linear.x'])
            motion = motion._replace(speed=speed)
        return align_start(motion, self.truth) if self.has_topics('ground_truth/odom') else motion

    @cached_property
    def frame_rotation(self) -> float:
        """Angle from the estimator's x axis to that of map. [rad]"""
        return float(self.estimate.yaw[0] - self._read_motion('odom').yaw[0])

    @cached_property
    def heading_setpoint(self) -> TimeCurve:
        """Heading setpoint in map, unwrapped. [rad]"""
        series = self.read_series('setpoint/pose')
        yaw = to_euler_angles(series.vector('pose.orientation')).yaw
        return TimeCurve(series.time, np.unwrap(np.nan_to_num(yaw)) + self.frame_rotation)

    @cached_property
    def altitude_setpoint(self) -> TimeCurve:
        """Altitude setpoint. [m]"""
        series = self.read_series('setpoint/pose')
        return TimeCurve(series.time, series['pose.position.z'])

    @cached_property
    def speed_setpoint(self) -> TimeCurve:
        """Forward airspeed setpoint. [m/s]"""
        series = self.read_series('setpoint/velocity')
        return TimeCurve(series.time, series['twist.linear.x'])

    @cached_property
    def range_altitude(self) -> TimeCurve:
        """Altitude of the hull centre from the range finder. [m]"""
        series = self.read_series('range')
        vehicle = self.scene.vehicle
        # Depth of the sensor below the hull centre; body z points up
        below = 0.0 if vehicle is None else -vehicle.sensors.range_position.vector[2]
        return TimeCurve(
            series.time, np.where(np.isfinite(series['range']), series['range'], np.nan) + below
        )

    @cached_property
    def duties(self) -> DutyCurves:
        """Commanded duties of the rotors."""
        series = self.read_series('motors')
        # Fields name[0], name[1], ... of ActuatorDuty
        names = [
            str(series.texts[f'name[{k}]'][-1])
            for k in range(len(series.texts))
            if f'name[{k}]' in series.texts
        ]
        efforts = [series[f'effort[{k}]'] for k in range(len(names))]
        return DutyCurves(series.time, names, np.stack(efforts, axis=1))

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
        """Time from a block's stamp, that of its first sample, to its middle. [s]"""
        return half_block_time()

    @cached_property
    def peaks(self) -> PointSeries:
        """Amplitude [counts], SNR and frequency [Hz] of the wanted lamp per diode, mid-block."""
        points = self.flight.read_points('light/peaks')
        return PointSeries(
            points.time + self.half_block_time, select_primary_beacon(points.fields)
        )

    @cached_property
    def sighting(self) -> DirectionCurve:
        """Direction to the lamp that the drone steers by, body frame, mid-block."""
        series = self.read_series('light/estimate')
        place = series.vector('pose.pose.position')
        # The variance marks a block without a lamp
        seen = select_estimates(series['pose.covariance[0]'])
        return DirectionCurve(
            series.time + self.half_block_time,
            vector_directions(np.where(seen[:, None], place, 0.0)),
        )

    @cached_property
    def bearing(self) -> DirectionCurve:
        """The paper's bearing of the lamp, body frame, mid-block."""
        series = self.read_series('light/bearing')
        return DirectionCurve(
            series.time + self.half_block_time, vector_directions(series.vector('vector'))
        )

    @cached_property
    def battery(self) -> ElectricalCurve:
        """The battery as measured."""
        return self._read_electricity('battery')

    @cached_property
    def panel(self) -> ElectricalCurve:
        """Voltage and current of the solar panel as measured."""
        return self._read_electricity('panel')

    def _read_electricity(self, topic: str) -> ElectricalCurve:
        series = self.read_series(topic)
        return ElectricalCurve(series.time, series['voltage'], series['current'])

    def _read_motion(self, topic: str) -> MotionCurve:
        """Return a topic of nav_msgs/Odometry as a motion."""
        series = self.read_series(topic)
        span, step = float(np.ptp(series.time)), median_period(series.time)
        check_time_span(f"of '{topic}'", span, step, len(series.time))
        place, attitude = (
            series.vector('pose.pose.position'),
            series.vector('pose.pose.orientation'),
        )
        return build_motion(series.time, place, attitude, series['twist.twist.linear.x'])

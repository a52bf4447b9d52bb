# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimator node: estimate the motion from the drone's own sensors and commands.

Each estimate is published twice: on `odom`, and as the transform odom -> base_link on /tf.
"""

from typing import Unpack

from lta_control.estimator import MotionEstimate
from lta_control.flight_report import describe_calibration
from lta_control.flight_step import estimate_motion
from lta_control.messages import to_tracked
from lta_control.motion import step_duration
from lta_control.odometry.ground_motion import (
    build_odom_motion,
    ground_step,
    read_modelled_motion,
)
from lta_control.odometry.ground_state import GroundMotion
from lta_control.odometry.messages import (
    from_airspeed,
    from_estimate,
    is_valid_command,
    to_duties,
    to_inputs,
    to_sighting,
)
from lta_control.odometry.tracked_motion import TrackedMotion, TrackedPath
from lta_control.parameters import EstimatorParameters
from lta_control.sighting import LampSighting
from lta_control.vehicle_parameters import build_estimator_model
from lta_graph.health import HealthLevel
from lta_graph.lockstep import InboxStep
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.stamps import from_stamp
from lta_graph.ros.transforms import from_odometry
from lta_model.vehicle import load_vehicle
from lta_msgs.msg import LampPeaks
from nav_msgs.msg import Odometry


class Estimator(GraphNode):
    """Publish an estimate for each IMU sample."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('estimator', **options)
        self._airspeed = self.create_output('airspeed')
        self._odom = self.create_output('odom')
        self._tf = self.create_output('/tf')
        self._settings = NodeParameters(self, EstimatorParameters)
        vehicle = load_vehicle(self._settings.value.vehicle)
        self._names = vehicle.rotor_names
        self._body = build_estimator_model(vehicle)
        self._estimate = MotionEstimate()
        self._ground = GroundMotion()
        self._path = TrackedPath()
        self._tracked: TrackedMotion | None = None  # newest pose that the filter has not used
        self._restarts = 0
        self._peaks: LampPeaks | None = None
        self._half_block_ns = self.table['photodiodes'].period_ns // 2
        self._commanded = self._estimate.duties
        self._last_ns: int | None = None
        self._refused = 0
        self.subscribe_inputs(
            ['imu', 'range', 'pressure', 'motors', 'light/peaks', 'light/estimate'],
            trigger='imu',
            on_step=self._on_step,
        )
        if not self.lockstep:  # in which no tracker works
            self.subscribe_topic('tracker/odom', self._on_tracked)

    def _on_step(self, step: InboxStep) -> None:
        learning = not self._estimate.ready
        motors = step.last_message('motors')
        self._commanded = to_duties(motors, self._names, self._commanded)
        if motors is not None and not is_valid_command(motors, self._names):
            self.soundness.unsound.add(
                'motors: rotor names or duties do not match the vehicle file'
            )
        inputs, settings = to_inputs(step, self._commanded), self._settings.value
        dt = step_duration(self._last_ns, step.stamp_ns, self.table.control_ns)
        before = self._estimate
        self._estimate = estimate_motion(settings, self._body, before, inputs, dt)
        if self._estimate is not before:
            self._last_ns = step.stamp_ns
            self._ground = ground_step(
                settings.ground,
                self._body.hull,
                self._ground,
                read_modelled_motion(self._estimate, self._body.standing_height),
                self._read_sighting(step),
                dt,
                self._read_tracked(step),
            )
            if self._ground.elapsed == 0.0:
                self._tracked = None
            if self._ground.restarts > self._restarts:
                self._restarts = self._ground.restarts
                text = 'the motion over ground could not be computed and began again'
                self.health.report('ground', HealthLevel.WARN, text, restarts=self._restarts)
        else:
            # The estimate is published unchanged, so that the graph does not stop
            self._refused += 1
            text = 'ignored an IMU sample with impossible values; check the IMU'
            self.health.report('imu', HealthLevel.ERROR, text, refused=self._refused)
        stamp = step.last_message('imu').header.stamp
        # First the airspeed: whoever acts on `odom` wants both
        self._airspeed.publish(from_airspeed(stamp, self._estimate, self._ground))
        odom = from_estimate(stamp, self._estimate, self._ground)
        self._odom.publish(odom)
        self._tf.publish(from_odometry(odom))
        if learning:
            self.health.set_fact(describe_calibration(self._estimate, self._body))

    def _on_tracked(self, message: Odometry) -> None:
        self._tracked = to_tracked(message)

    def _read_tracked(self, step: InboxStep) -> tuple[float, float] | None:
        """Return the position by the tracker at this step, if there is a new one [m, odom]."""
        if self._tracked is None:
            return None
        motion = build_odom_motion(step.stamp_ns, self._estimate, self._ground)
        return self._path.follow(self._tracked, motion, self._estimate.ready)

    def _read_sighting(self, step: InboxStep) -> LampSighting | None:
        """Return the lamp in the light block that has come, if any."""
        self._peaks = step.last_valid('light/peaks') or self._peaks
        lamp = step.last_valid('light/estimate')
        if lamp is None or self._peaks is None or self._peaks.header.stamp != lamp.header.stamp:
            return None
        middle_ns = from_stamp(lamp.header.stamp) + self._half_block_ns
        return to_sighting(lamp, self._peaks, (step.stamp_ns - middle_ns) * 1e-9)


def main(args: list[str] | None = None) -> None:
    """Run the node until it is shut down."""
    run_node(Estimator, args)

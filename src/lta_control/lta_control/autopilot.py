# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly one drone in one process: `flight_step` of its control law, compiled.

The state is kept in one array, which each step overwrites. Properties read parts of it on demand.
A law with tracker feedback gets pose and velocity from the tracker, in a frame that begins at the
vehicle's first tracked position, and its rates from the onboard gyroscope.
"""

import math
import struct
from typing import final

from lta_config.compilation.flat import Array, compile_core, TupleLayout
from lta_config.settings import Settings
from lta_control.allocation import DUTY_SCRATCH
from lta_control.estimator import EstimatorSettings, MotionEstimate
from lta_control.flight_step import (
    DroneConstants,
    DroneMemory,
    flight_step,
    FlightRules,
    is_flying,
    is_stopped,
    PilotMemory,
    SensorInputs,
    TILT_LIMIT,
)
from lta_control.laws import cascade
from lta_control.laws.protocol import ControlLaw
from lta_control.motion import (
    CascadeMeasurement,
    ControlMotion,
    DeadReckonedMotion,
    measure_motion,
    Quaternion,
    rotate_level_to_world,
    Setpoint,
    Vector,
    yaw_from_quaternion,
)
from lta_control.odometry.ground_motion import is_on_ground, is_still, ModelledMotion
from lta_control.vehicle_parameters import build_estimator_model
from lta_model.vehicle import Vehicle
import numpy as np

MEMORY_LAYOUT = TupleLayout(DroneMemory())  # with the cascade
ESTIMATE_LAYOUT = TupleLayout(MotionEstimate())
SENSED_LAYOUT = TupleLayout(SensorInputs((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
READING_NUMBERS = 8  # numbers before the tracked motion: rates, force, range and pressure
TRACKED_NUMBERS = 13  # numbers of a tracked motion: position, quaternion, velocity, rates


def build_drone_constants(
    vehicle: Vehicle,
    estimator: EstimatorSettings,
    gains: Settings,
    dt: float,
    tilt_limit: float = TILT_LIMIT,
    law: ControlLaw = cascade.CASCADE_LAW,
) -> DroneConstants:
    """
    Return the values that stay constant during a flight.

    `gains` are those of the law, `dt` the control period. [s] The motors stop beyond
    `tilt_limit`. [rad]
    """
    return DroneConstants(
        estimator,
        build_estimator_model(vehicle),
        law.build_constants(gains, vehicle),
        FlightRules(math.cos(tilt_limit), vehicle.hull_height_on_floor),
        dt,
    )


def motion_from_tracker(
    truth: tuple[float, ...], start: tuple[float, ...], rates: Vector
) -> ControlMotion:
    """
    Return the tracker's measurement as input of a control law.

    Parameters
    ----------
    truth, start : tuple of 13 floats
        Position, quaternion, velocity and rates, now and when first tracked; map frame.
    rates : tuple
        Measured by the onboard gyroscope. [rad/s]

    """
    yaw = yaw_from_quaternion(_motion_quaternion(start))
    # Relative to the start, in axes along its heading, like the estimator's odom frame
    x, y = rotate_level_to_world(-yaw, truth[0] - start[0], truth[1] - start[1])
    a, b, c, d = truth[3:7]
    # Remove the start's yaw: multiply the attitude by a rotation of -yaw about z.
    sin, cos = math.sin(-0.5 * yaw), math.cos(0.5 * yaw)
    attitude = (cos * a - sin * b, cos * b + sin * a, cos * c + sin * d, cos * d - sin * c)
    return ControlMotion((x, y, truth[2]), attitude, (truth[7], truth[8], truth[9]), rates)


def _motion_quaternion(motion: tuple[float, ...]) -> Quaternion:
    x, y, z, w = motion[3:7]
    return x, y, z, w


@final
class Autopilot:
    """
    Estimate and control step by step.

    Parameters
    ----------
    drone : DroneConstants
        From `build_drone_constants` with the same law.
    law : ControlLaw
        The control law.
    mass_rest : tuple
        Position of the moving mass while the law does not command it. [m, body]

    """

    def __init__(
        self,
        drone: DroneConstants,
        law: ControlLaw = cascade.CASCADE_LAW,
        mass_rest: Vector = (0.0, 0.0, 0.0),
    ) -> None:
        self.law, self._mass_rest = law, mass_rest
        constants, self._layout = TupleLayout(drone), TupleLayout(begin_memory(law))
        self._constants = constants.write(drone)
        self._memory = self._layout.write(begin_memory(law))
        self._sensed, self._scratch = np.zeros(SENSED_LAYOUT.size), np.zeros(DUTY_SCRATCH)
        # Views of the two arrays
        self._inputs, self._record = (
            SENSED_LAYOUT.view(self._sensed),
            self._layout.view(self._memory),
        )
        self._estimated, self._measured = self._record['estimate'], self._record['measured']
        self._command = self._record['pilot']['law']['command']
        self._count, self._standing = drone.body.number, drone.rules.standing_height
        self._step = compile_core(flight_step, constants, self._layout, SENSED_LAYOUT, law=law)
        # Packing into the buffer is faster than assigning array elements
        self._pack = struct.Struct(f'{READING_NUMBERS}d').pack_into
        self._tracked: ControlMotion | None = None
        self._start: tuple[float, ...] = ()

    def receive_tracking(self, truth: tuple[float, ...]) -> None:
        """Take the tracker's measurement, position to rates, for the next step."""
        # The first tracked motion defines the frame
        self._start = self._start or truth[:TRACKED_NUMBERS]
        # The rates are the gyroscope's
        motion = motion_from_tracker(truth[:TRACKED_NUMBERS], self._start, (0.0, 0.0, 0.0))
        self._tracked = motion
        self._inputs['tracked'] = tuple(motion)
        self._inputs['is_tracked'] = 1.0

    def step(
        self, rates: Vector, force: Vector, distance: float = math.nan, pressure: float = math.nan
    ) -> tuple[float, ...]:
        """
        Return the duties by rotor after one more control period.

        `rates` [rad/s] and specific force `force` [m/s2] are measured in the body frame; range
        `distance` [m] and `pressure` [Pa] are NaN where there is no new measurement.
        """
        self._pack(self._sensed.data, 0, *rates, *force, distance, pressure)
        self._step(self._constants, self._memory, self._sensed, self._scratch)
        return self.duties

    def set_setpoint(self, setpoint: Setpoint) -> None:
        """Set the setpoint for the next step."""
        self._record['setpoint'] = tuple(setpoint)
        # The memory is one float array: 1.0 is True
        self._record['guided'] = 1.0

    def record_applied_duties(self, duties: tuple[float, ...]) -> None:
        """Record the duties that the rotors really received instead of the computed ones."""
        self._command['duties'][: self._count] = duties

    @property
    def duties(self) -> tuple[float, ...]:
        """Duties by rotor."""
        return tuple(self._command['duties'].tolist()[: self._count])

    @property
    def mass_place(self) -> Vector | None:
        """Commanded position of the moving mass; None if the law does not move it [m, body]."""
        if not self.law.moves_mass:
            return None
        if not is_flying(self._flight_state):
            return self._mass_rest
        x, y, z = self._command['mass_place'].tolist()
        return x, y, z

    @property
    def stopped(self) -> bool:
        """Whether the motors have stopped for good."""
        return is_stopped(self._flight_state)

    @property
    def _flight_state(self) -> int:
        return int(self._record['pilot']['watch']['state'])

    @property
    def heading(self) -> float:
        """Estimated yaw. [rad]."""
        return float(self._measured['heading'])

    @property
    def modelled_motion(self) -> ModelledMotion:
        """Return what the filter of the motion over ground takes from the estimator."""
        estimate, measured = self._estimated, self._measured
        altitude, airspeed = estimate['altitude'], estimate['airspeed']
        on_ground = is_on_ground(float(altitude['height']), self._standing)
        stands = on_ground and is_still(
            estimate['rates'].tolist(), float(altitude['climb']), estimate['duties'].tolist()
        )
        return ModelledMotion(
            bool(estimate['ready']),
            float(measured['heading']),
            float(measured['yaw_rate']),
            float(airspeed['model_surge']),
            float(airspeed['model_sway']),
            on_ground,
            stands,
        )

    @property
    def dead_reckoning(self) -> DeadReckonedMotion:
        """Heading, dead-reckoned position and airspeed, as a message would carry them."""
        measured = self._measured
        x, y = self._estimated['position'].tolist()
        return DeadReckonedMotion(
            float(measured['heading']), x, y, float(measured['speed']), float(measured['sway'])
        )

    @property
    def measurement(self) -> CascadeMeasurement | None:
        """Return the motion that the law is given; None while it is unknown."""
        if not self._estimated['ready']:
            return None
        if not self.law.is_tracked:
            return CascadeMeasurement(*self._measured.item())
        if self._tracked is None:
            return None
        p, q, r = self._estimated['rates'].tolist()
        return measure_motion(self._tracked._replace(rates=(p, q, r)))

    @property
    def estimate(self) -> MotionEstimate:
        """Return the estimator's full state."""
        return ESTIMATE_LAYOUT.read(self._memory[: ESTIMATE_LAYOUT.size])

    def copy_estimate(self) -> Array:
        """Return a copy of the estimate as numbers, in the order of `ESTIMATE_LAYOUT`."""
        return self._memory[: ESTIMATE_LAYOUT.size].copy()

    @property
    def memory(self) -> DroneMemory:
        """Return the full state of estimator, rules and law."""
        return self._layout.read(self._memory)


def begin_memory(law: ControlLaw) -> DroneMemory:
    """Return the state of a drone before its first step."""
    return DroneMemory(pilot=PilotMemory(law=law.start))

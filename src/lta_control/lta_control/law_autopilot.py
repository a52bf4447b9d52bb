"""
Run the estimator and any control law of one drone, compiled, in one process.

`lta_control.autopilot` does the same for the cascade alone, in one function. A law with tracker
feedback gets pose and velocity from the tracker, in a frame that begins at the vehicle's first
tracked position, and its rates from the onboard gyroscope.
"""

from collections.abc import Callable
import math
import struct
from typing import Any, final, NamedTuple

from lta_config.compilation.flat import Array, compile_core, TupleLayout
from lta_control.allocation import SCRATCH, Scratch
from lta_control.altitude import is_stuck, SensorWatch, watch_sensor
from lta_control.attitude import Quaternion, Vector, yaw_from_quaternion
from lta_control.autopilot import ESTIMATE
from lta_control.cascade import CascadeMeasurement, Setpoint
from lta_control.control import (
    has_landed,
    has_overturned,
    LandingWatch,
    STANDSTILL,
    TILT_LIMIT,
    watch_landing,
)
from lta_control.estimator import (
    estimator_step,
    EstimatorInputs,
    EstimatorModel,
    EstimatorSettings,
    has_height,
    is_any_motor_turning,
    is_plausible_imu_sample,
    MotionEstimate,
)
from lta_control.laws.frames import rotate_level_to_world
from lta_control.laws.protocol import ControlLaw, ControlMotion, Feedback, LawCommand, LawInputs
from lta_control.message_rounding import air_relative_velocity, build_measurement
from lta_control.odometry.ground_motion import ModelledMotion, read_modelled_motion
from lta_control.per_rotor import NONE, pad_to_slots
from lta_control.sighting import DeadReckonedMotion
from lta_control.vehicle_parameters import build_estimator_model
from lta_model.vehicle import Vehicle
import numpy as np

INPUTS = TupleLayout(EstimatorInputs((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0, NONE))
HEARD = TupleLayout(LawInputs())
COMMAND = TupleLayout(LawCommand())
READY, RATES = ESTIMATE.part_slice('ready').start, ESTIMATE.part_slice('rates')
TRUTH = 13  # position, quaternion, velocity, rates


class EstimatorConstants(NamedTuple):
    """Constants of the estimator: filters, vehicle and control period [s]."""

    estimator: EstimatorSettings
    body: EstimatorModel
    dt: float


def step_estimator(
    constants: EstimatorConstants,
    memory: MotionEstimate,
    inputs: EstimatorInputs,
    scratch: Scratch,
) -> MotionEstimate:
    """Return the estimate one step later, or the old one if the IMU sample is impossible."""
    if is_plausible_imu_sample(inputs.rates, inputs.force):
        return estimator_step(constants.estimator, constants.body, memory, inputs, constants.dt)
    return memory


def motion_from_estimate(estimate: MotionEstimate) -> ControlMotion:
    """Return an estimate as input of a control law."""
    x, y = estimate.position
    return ControlMotion(
        (x, y, estimate.altitude.height),
        estimate.attitude,
        air_relative_velocity(estimate),
        estimate.rates,
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
class LawAutopilot:
    """
    Estimate and control step by step with any law; same interface as `Autopilot`.

    Parameters
    ----------
    dt : float
        Control period. [s]
    tilt_limit : float
        Tilt beyond which the motors stop. [rad]

    Attributes
    ----------
    command : LawCommand
        The latest command.
    stopped : bool
        Stopped for good: the drone has overturned, a value is not finite, or the height unknown.

    """

    def __init__(
        self,
        law: ControlLaw,
        gains: object,
        vehicle: Vehicle,
        estimator: EstimatorSettings,
        dt: float,
        tilt_limit: float = TILT_LIMIT,
    ) -> None:
        self.law, self._dt = law, dt
        self._upright, self._count = math.cos(tilt_limit), len(vehicle.allocation)
        self._rest = LawCommand(NONE, _rest_mass_position(vehicle))
        self._standing = vehicle.hull_height_on_floor
        self._watch, self._watch_step = _compile_core(
            step_estimator,
            EstimatorConstants(estimator, build_estimator_model(vehicle), dt),
            ESTIMATE,
            INPUTS,
        )
        self._memory_layout = TupleLayout(law.start)
        self._law_constants, self._law_step = _compile_core(
            law.step, law.build_constants(gains, vehicle), self._memory_layout, HEARD
        )
        self._commanded = self._memory_layout.part_slice('command')
        self._estimate = ESTIMATE.write(MotionEstimate())
        self._fresh = self._memory_layout.write(law.start)
        self._memory = self._fresh.copy()
        self._scratch = np.zeros(SCRATCH)
        self._inputs, self._sensor_inputs = np.empty(INPUTS.size), np.empty(HEARD.size)
        self._pack_inputs = struct.Struct(f'{INPUTS.size}d').pack_into
        self._pack_heard = struct.Struct(f'{HEARD.size}d').pack_into
        self._setpoint: Setpoint | None = None
        self._landing, self._height = LandingWatch(), SensorWatch()
        self._truth: tuple[float, ...] = ()
        self._start: tuple[float, ...] = ()
        self.command, self.stopped = self._rest, False

    def receive_tracking(self, truth: tuple[float, ...]) -> None:
        """Take the tracker's measurement, position to rates, for the next step."""
        self._truth = truth[:TRUTH]
        # The first tracked motion defines the frame
        self._start = self._start or self._truth

    def set_setpoint(self, setpoint: Setpoint) -> None:
        """Set the setpoint for the next step."""
        self._setpoint = setpoint

    def step(
        self, rates: Vector, force: Vector, distance: float = math.nan, pressure: float = math.nan
    ) -> tuple[float, ...]:
        """Return the duties by rotor after one more period; arguments as in `Autopilot.step`."""
        duties = self.command.duties
        self._pack_inputs(self._inputs.data, 0, *rates, *force, distance, pressure, *duties)
        self._watch_step(self._watch, self._estimate, self._inputs, self._scratch)
        self.command = self._compute_command()
        return self.duties

    def record_applied_duties(self, duties: tuple[float, ...]) -> None:
        """Record the duties that the rotors really received instead of the computed ones."""
        self.command = self.command._replace(duties=pad_to_slots(duties))

    def _compute_command(self) -> LawCommand:
        """Return the latest command; the rest command before there is a setpoint and a motion."""
        motion = self.motion
        if motion is None or self._setpoint is None:
            return self._rest
        setpoint = self._setpoint
        # In the order of `LawInputs`
        numbers = (*motion.position, *motion.attitude, *motion.velocity, *motion.rates, *setpoint)
        if not math.isfinite(sum(numbers)) or has_overturned(motion.attitude, self._upright):
            self.stopped = True
        turning = is_any_motor_turning(self.command.duties)
        self._height = watch_sensor(self._height, motion.position[2], turning, self._dt)
        # A tracker measures the height too
        blind = self.law.feedback is Feedback.ESTIMATOR and not has_height(self.estimate)
        if blind or is_stuck(self._height):
            self.stopped = True
        if self.stopped or self._is_landed(_motion_to_measurement(motion), setpoint):
            # Reset the integrals, so that nothing winds up on the ground.
            self._memory = self._fresh.copy()
            return self._rest
        self._pack_heard(self._sensor_inputs.data, 0, *numbers, self._dt)
        self._law_step(self._law_constants, self._memory, self._sensor_inputs, self._scratch)
        return COMMAND.read(self._memory[self._commanded])

    def _is_landed(self, measured: CascadeMeasurement, setpoint: Setpoint) -> bool:
        down = setpoint.altitude <= self._standing
        self._landing = watch_landing(self._landing, measured.altitude, down, self._dt)
        return self._landing.still > STANDSTILL or has_landed(measured, setpoint, self._standing)

    @property
    def motion(self) -> ControlMotion | None:
        """Input of the control law; None while it is unknown."""
        if not self._estimate[READY]:
            return None
        if self.law.feedback is Feedback.ESTIMATOR:
            return motion_from_estimate(self.estimate)
        p, q, r = self._estimate[RATES].tolist()
        return motion_from_tracker(self._truth, self._start, (p, q, r)) if self._truth else None

    @property
    def duties(self) -> tuple[float, ...]:
        """Duties by rotor."""
        return self.command.duties[: self._count]

    @property
    def measurement(self) -> CascadeMeasurement | None:
        """The motion as input of the cascade; None while it is unknown."""
        motion = self.motion
        return None if motion is None else _motion_to_measurement(motion)

    @property
    def heading(self) -> float:
        """Estimated yaw. [rad]."""
        return yaw_from_quaternion(self.estimate.attitude)

    @property
    def modelled_motion(self) -> ModelledMotion:
        """What the filter of the motion over ground takes from the estimator."""
        return read_modelled_motion(self.estimate, self._standing)

    @property
    def dead_reckoning(self) -> DeadReckonedMotion:
        """Heading, dead-reckoned position and airspeed, as in `Autopilot`."""
        own = self.estimate
        surge, sway, _ = air_relative_velocity(own)
        return DeadReckonedMotion(yaw_from_quaternion(own.attitude), *own.position, surge, sway)

    @property
    def estimate(self) -> MotionEstimate:
        """The estimator's full state."""
        return ESTIMATE.read(self._estimate)

    def copy_estimate(self) -> Array:
        """Return a copy of the estimate as numbers, in the order of `ESTIMATE`."""
        return self._estimate.copy()


def _motion_to_measurement(motion: ControlMotion) -> CascadeMeasurement:
    return build_measurement(motion.attitude, motion.position[2], motion.velocity, motion.rates)


def _rest_mass_position(vehicle: Vehicle) -> Vector:
    moving = vehicle.file.moving_mass
    if moving is None:
        return 0.0, 0.0, 0.0
    x, y, z = moving.position.vector
    return x, y, z


def _compile_core(
    core: Callable[..., Any],
    constants: tuple[Any, ...],
    memory: TupleLayout[Any],
    inputs: TupleLayout[Any],
) -> tuple[Array, Callable[[Array, Array, Array, Array], None]]:
    """Return the constants as an array, and the compiled core."""
    layout = TupleLayout(constants)
    return layout.write(constants), compile_core(core, layout, memory, inputs)

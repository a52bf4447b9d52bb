"""
Run the estimator and the cascade controller of one drone, compiled, in one process.

The state is kept in one array, which each step overwrites. Properties read parts of it on demand.
"""

import math
import struct
from typing import final

from lta_config.compilation.flat import Array, compile_core, TupleLayout
from lta_control.allocation import SCRATCH
from lta_control.attitude import Vector
from lta_control.cascade import CascadeGains, CascadeMeasurement, Setpoint
from lta_control.control import TILT_LIMIT
from lta_control.estimator import EstimatorSettings, MotionEstimate
from lta_control.odometry.ground_motion import is_on_ground, ModelledMotion
from lta_control.onboard import DroneConstants, onboard_step, OnboardMemory, SensorInputs
from lta_control.sighting import DeadReckonedMotion
from lta_control.vehicle_parameters import (
    build_estimator_model,
    build_rotors,
    surge_drag_coefficients,
)
from lta_model.vehicle import Vehicle
import numpy as np

MEMORY = TupleLayout(OnboardMemory())
HEARD = TupleLayout(SensorInputs((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
ESTIMATE = TupleLayout(MotionEstimate())

ESTIMATED, DUTIES = MEMORY.part_slice('estimate'), MEMORY.part_slice('duties')
MEASURED, SETPOINT = MEMORY.part_slice('measured'), MEMORY.part_slice('setpoint')
HEADING, READY = (
    MEMORY.part_slice('measured.heading').start,
    MEMORY.part_slice('estimate.ready').start,
)
PLACE, SPEED = (
    MEMORY.part_slice('estimate.position').start,
    MEMORY.part_slice('measured.speed').start,
)
YAW_RATE, MODELLED = (
    MEMORY.part_slice('measured.yaw_rate').start,
    MEMORY.part_slice('estimate.airspeed.model_surge').start,
)
HEIGHT = MEMORY.part_slice('estimate.altitude.height').start
GUIDED, STOPPED = MEMORY.part_slice('guided').start, MEMORY.part_slice('stopped').start


def build_drone_constants(
    vehicle: Vehicle,
    estimator: EstimatorSettings,
    gains: CascadeGains,
    dt: float,
    tilt_limit: float = TILT_LIMIT,
) -> DroneConstants:
    """
    Return the values that stay constant during a flight.

    `dt` is the control period. [s] The motors stop beyond `tilt_limit`. [rad]
    """
    return DroneConstants(
        estimator,
        build_estimator_model(vehicle),
        gains,
        build_rotors(vehicle),
        surge_drag_coefficients(vehicle),
        math.cos(tilt_limit),
        dt,
    )


@final
class Autopilot:
    """Estimate and control step by step."""

    def __init__(self, drone: DroneConstants) -> None:
        layout = TupleLayout(drone)
        self._constants = layout.write(drone)
        self._memory = MEMORY.write(OnboardMemory())
        self._sensor_inputs = np.empty(HEARD.size)
        self._scratch = np.zeros(SCRATCH)
        self._count, self._standing = drone.rotors.number, drone.body.standing_height
        self._step = compile_core(onboard_step, layout, MEMORY, HEARD)
        # Packing into the buffer is faster than assigning array elements
        self._pack = struct.Struct(f'{HEARD.size}d').pack_into

    def step(
        self, rates: Vector, force: Vector, distance: float = math.nan, pressure: float = math.nan
    ) -> tuple[float, ...]:
        """
        Return the duties by rotor after one more control period.

        `rates` [rad/s] and specific force `force` [m/s2] are measured in the body frame; range
        `distance` [m] and `pressure` [Pa] are NaN where there is no new measurement.
        """
        self._pack(self._sensor_inputs.data, 0, *rates, *force, distance, pressure)
        self._step(self._constants, self._memory, self._sensor_inputs, self._scratch)
        return self.duties

    def set_setpoint(self, setpoint: Setpoint) -> None:
        """Set the setpoint for the next step."""
        self._memory[SETPOINT] = setpoint
        # The memory is one float array: 1.0 is True
        self._memory[GUIDED] = 1.0

    def record_applied_duties(self, duties: tuple[float, ...]) -> None:
        """Record the duties that the rotors really received instead of the computed ones."""
        self._memory[DUTIES.start : DUTIES.start + self._count] = duties

    @property
    def duties(self) -> tuple[float, ...]:
        """Duties by rotor."""
        return tuple(self._memory[DUTIES].tolist()[: self._count])

    @property
    def stopped(self) -> bool:
        """Whether the motors have stopped for good."""
        return bool(self._memory[STOPPED])

    @property
    def heading(self) -> float:
        """Estimated yaw. [rad]."""
        return self._memory.item(HEADING)

    @property
    def modelled_motion(self) -> ModelledMotion:
        """What the filter of the motion over ground takes from the estimator."""
        item = self._memory.item
        ready, heading, yaw_rate = bool(item(READY)), item(HEADING), item(YAW_RATE)
        grounded = is_on_ground(item(HEIGHT), self._standing)
        return ModelledMotion(
            ready, heading, yaw_rate, item(MODELLED), item(MODELLED + 1), grounded
        )

    @property
    def dead_reckoning(self) -> DeadReckonedMotion:
        """Heading, dead-reckoned position and airspeed, as a message would carry them."""
        item = self._memory.item
        return DeadReckonedMotion(
            item(HEADING), item(PLACE), item(PLACE + 1), item(SPEED), item(SPEED + 1)
        )

    @property
    def measurement(self) -> CascadeMeasurement | None:
        """The controller's input; None while the estimator calibrates."""
        if not self._memory[READY]:
            return None
        return CascadeMeasurement(*self._memory[MEASURED].tolist())

    @property
    def estimate(self) -> MotionEstimate:
        """The estimator's full state."""
        return ESTIMATE.read(self._memory[ESTIMATED])

    def copy_estimate(self) -> Array:
        """Return a copy of the estimate as numbers, in the order of `ESTIMATE`."""
        return self._memory[ESTIMATED].copy()

    @property
    def memory(self) -> OnboardMemory:
        """The full state of estimator and controller."""
        return MEMORY.read(self._memory)

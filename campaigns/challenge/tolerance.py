# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draw small errors of a vehicle, and of its sensors for each flight."""

from dataclasses import replace
import math
from typing import Final

import numpy as np

from campaigns.challenge.rotors import rotate_column
from campaigns.challenge.truth import to_triple, Triple, VehicleTruth

Draw = np.random.Generator

# Standard deviations, relative.
MASS: Final = 0.01
INERTIA: Final = 0.04
DRAG: Final = 0.05
ADDED: Final = 0.05
DAMPING: Final = 0.05
THRUST: Final = 0.03
ROTOR: Final = 0.02
GYRO_SCALE: Final = 0.006
# Standard deviations.
CG_HEIGHT: Final = 3e-3  # m
CG_ASIDE: Final = 5e-4  # m
LAG: Final = 6e-3  # s
DELAY: Final = 5e-3  # s
TOE: Final = math.radians(0.5)
LIFT: Final = 6e-4  # N
GYRO: Final = 0.01  # rad/s
IMU: Final = 0.1  # m/s2
RANGE: Final = 0.012  # m
PRESSURE: Final = 3.0  # Pa; a quarter of a metre


def scale_randomly(values: Triple, size: float, draw: Draw) -> Triple:
    """Return three numbers, each off by a relative error."""
    return to_triple(each * (1.0 + size * draw.standard_normal()) for each in values)


def shift_randomly(values: Triple, size: float, draw: Draw) -> Triple:
    """Return three numbers, each off by an error."""
    return to_triple(each + size * draw.standard_normal() for each in values)


def perturb_vehicle(truth: VehicleTruth, draw: Draw) -> VehicleTruth:
    """
    Return a vehicle as it was built from its file.

    It is trimmed: what it weighs more, it displaces more.
    """
    heavier = truth.mass * MASS * float(draw.standard_normal())
    x, y, z = truth.cg
    x, y = (each + CG_ASIDE * float(draw.standard_normal()) for each in (x, y))
    return replace(
        truth,
        mass=truth.mass + heavier,
        displaced=truth.displaced + heavier,
        cg=(x, y, z + CG_HEIGHT * float(draw.standard_normal())),
        inertia=scale_randomly(truth.inertia, INERTIA, draw),
        added_mass=scale_randomly(truth.added_mass, ADDED, draw),
        added_inertia=scale_randomly(truth.added_inertia, ADDED, draw),
        drag=scale_randomly(truth.drag, DRAG, draw),
        turn_linear=scale_randomly(truth.turn_linear, DAMPING, draw),
        turn_square=scale_randomly(truth.turn_square, DAMPING, draw),
        thrust=1.0 + THRUST * float(draw.standard_normal()),
        gains=tuple(1.0 + ROTOR * float(draw.standard_normal()) for _ in truth.gains),
        columns=tuple(
            rotate_column(column, place, to_triple(TOE * draw.standard_normal(3)))
            for column, place in zip(truth.columns, truth.places, strict=True)
        ),
        # Limited to three standard deviations, so that the lag stays positive
        lag=truth.lag + LAG * float(np.clip(draw.standard_normal(), -3.0, 3.0)),
        delay=abs(DELAY * float(draw.standard_normal())),
    )


def apply_flight_errors(truth: VehicleTruth, draw: Draw) -> VehicleTruth:
    """Return a vehicle with what differs from flight to flight."""
    return replace(
        truth,
        lift=truth.lift + LIFT * float(draw.standard_normal()),
        gyro_bias=shift_randomly(truth.gyro_bias, GYRO, draw),
        gyro_scale=shift_randomly(truth.gyro_scale, GYRO_SCALE, draw),
        imu_bias=shift_randomly(truth.imu_bias, IMU, draw),
        range_offset=truth.range_offset + RANGE * float(draw.standard_normal()),
        pressure_offset=truth.pressure_offset + PRESSURE * float(draw.standard_normal()),
    )

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A motion to look at single effects with: at rest, level, in calm and dark, unless told else."""

from lta_model.effects.protocol import VehicleMotion
from lta_model.state import BODY, COMMAND, DISPLACED, IRRADIANCE, MASS_PLACE, SURROUNDINGS
import numpy as np
from scipy.spatial.transform import Rotation

NO = (0.0, 0.0, 0.0)
LEVEL = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def turned(angles):
    """Return the rotation body -> map of yaw, pitch and roll in rad."""
    return tuple(Rotation.from_euler('ZYX', angles).as_matrix().ravel().tolist())


def up(rotation):
    """Return the vertical of the map, seen from the body."""
    return np.reshape(rotation, (3, 3)).T @ (0.0, 0.0, 1.0)


def motion(
    rotation=LEVEL, velocity=NO, rates=NO, airspeed=None, displaced=0.0, irradiance=0.0, place=NO
):
    """Return a motion; `place` is where the moving mass should be."""
    body, command, surroundings = [0.0] * BODY, [0.0] * COMMAND, [0.0] * SURROUNDINGS
    body[DISPLACED] = displaced
    command[MASS_PLACE : MASS_PLACE + 3] = place
    surroundings[IRRADIANCE] = irradiance
    return VehicleMotion(
        NO,
        rotation,
        velocity,
        rates,
        velocity if airspeed is None else airspeed,
        tuple(body),
        tuple(command),
        tuple(surroundings),
    )

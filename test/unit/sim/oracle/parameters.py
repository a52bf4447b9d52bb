# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the functions of the oracle are given: parameters by name, and what is seen."""

from dataclasses import dataclass

import numpy as np

G = 9.80665  # m/s2 (CGPM 1901)
T_AIR = 293.15  # K
P_AIR = 101325.0  # Pa
HELIUM = 0.1664 / 1.2041  # density of helium by that of air at 20 C
AXES = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
NONE = np.zeros(0)


class Given:
    """Parameters of one effect, zero where nothing else is said."""

    def __init__(self, values):
        self._values = values

    def __call__(self, name, null=0.0):
        return float(self._values.get(name, null))

    def vector(self, *names):
        return np.array([self(name) for name in names])


@dataclass
class Body:
    """Mass, CG, inertia about the CG, displaced air, added mass and inertia, rotors."""

    mass: float
    cg: np.ndarray
    inertia: np.ndarray
    displaced: float
    added: np.ndarray
    places: np.ndarray
    axes: np.ndarray


@dataclass
class Scene:
    """Where the vehicle is, how it moves, what it is told and what surrounds it."""

    position: np.ndarray
    turn: np.ndarray  # body -> map, 3 x 3
    velocity: np.ndarray  # body frame
    rates: np.ndarray
    body: Body
    duties: np.ndarray
    mass_place: np.ndarray
    wind: np.ndarray  # in map; what the air effects make of it
    noise: np.ndarray
    irradiance: float
    voltage: float

    @property
    def up(self):
        """The vertical of the map, seen from the body."""
        return self.turn.T @ np.array([0.0, 0.0, 1.0])

    @property
    def airspeed(self):
        """Velocity through the air, body frame."""
        return self.velocity - self.turn.T @ self.wind


def at_centre(force):
    """Return the wrench of a force at the hull centre."""
    return np.concatenate([force, np.zeros(3)])


def at(place, force):
    """Return the wrench of a force at a place of the body."""
    return np.concatenate([force, np.cross(place, force)])

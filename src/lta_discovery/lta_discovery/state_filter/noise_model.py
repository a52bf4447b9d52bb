# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Describe what a flight does that the model does not explain: sensor errors and forces."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final, Self

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.model.nominal import NominalVehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# First guesses, from which a fit learns the values: a tracker's white error of 0.3 mm and 0.6
# mrad, the slow wander of its solution of 1 mm and 2 mrad, and air that moves by some cm/s, which
# is a force of a thousandth of the weight and the same at a lever arm of 10 cm
WHITE: Final = np.array([3e-4] * 3 + [6e-4] * 3)  # m, rad
CORRELATED_NOISE: Final = np.array([1e-3] * 3 + [2e-3] * 3)  # m, rad
CORRELATION: Final = 0.3  # s
FORCE: Final = 1e-3  # of the weight
MOMENT_ARM: Final = 0.1  # m
WRENCH_MEMORY: Final = 3.0  # s
# Smallest relevant deviation of an unexplained force [N] and moment [N m], for a blimp of this
# mass [kg] and inertia [kg m2]; it grows with them (`wrench_floor`)
WRENCH_FLOOR: Final = np.array([4e-4, 4e-4, 4e-4, 8e-5, 8e-5, 4e-5])
FLOOR_MASS: Final = 0.415
FLOOR_INERTIA: Final = np.array([0.0351, 0.0348, 0.0202])
GUESS_LOGARITHMS: Final = np.log(
    np.concatenate([WHITE[[0, 3]], CORRELATED_NOISE[[0, 3]], [CORRELATION], np.ones(8)])
)


@final
@dataclass(frozen=True, slots=True)
class NoiseModel:
    """Standard deviations and times of what is not explained."""

    white: Array  # of a single reading, by channel, shape (6,) or (14,)
    correlated: Array  # of the slow part of the tracker's error, shape (6,) [m, rad]
    correlation: float  # time in which it changes [s]
    wrench: Array  # unexplained force and moment on each axis, shape (6,) [N, N m]
    memory: Array  # time in which each changes, shape (6,) [s]
    # Factors on both in forecasts: what is most probable from one reading to the next need not
    # forecast best (`forecast_noise`)
    wrench_ahead: float = 1.0
    memory_ahead: float = 1.0

    @classmethod
    def guess(cls, nominal: NominalVehicle, flight: MeasuredFlight) -> Self:
        """Return a first guess for a vehicle; other sensors have the noise of their readings."""
        white = WHITE
        if not flight.has_only_pose:
            white = np.concatenate([WHITE, flight.noise[6:]])
        guess = np.exp(cls.guess_wrench(nominal))
        return cls(white, CORRELATED_NOISE, CORRELATION, guess[:6], np.repeat(guess[6:], 3))

    @staticmethod
    def guess_wrench(nominal: NominalVehicle) -> Array:
        """Return the logarithms of the six wrenches and their memories, before any reading."""
        force = FORCE * STANDARD_GRAVITY * nominal.mass
        sizes = np.array([force] * 3 + [MOMENT_ARM * force] * 3 + [WRENCH_MEMORY] * 2)
        logarithms: Array = np.log(sizes)
        return logarithms

    @property
    def ahead(self) -> 'NoiseModel':
        """Return the noise of forecasts."""
        return replace(
            self,
            wrench=self.wrench_ahead * self.wrench,
            memory=self.memory_ahead * self.memory,
            wrench_ahead=1.0,
            memory_ahead=1.0,
        )

    @property
    def logarithms(self) -> Array:
        """
        Return the learned numbers as logarithms, shape (13,), those of the sensors first.

        White and correlated error of position and of attitude, correlation time; six wrenches, and
        the memory of forces and of moments.
        """
        pose = self.white[[0, 3]], self.correlated[[0, 3]], [self.correlation]
        logarithms: Array = np.log(np.concatenate([*pose, self.wrench, self.memory[[0, 3]]]))
        return logarithms

    def with_logarithms(self, values: Array) -> 'NoiseModel':
        """Return the model with other learned numbers (`logarithms`)."""
        own = np.exp(values)
        return replace(
            self,
            white=np.concatenate([np.repeat(own[:2], 3), self.white[6:]]),
            correlated=np.repeat(own[2:4], 3),
            correlation=float(own[4]),
            wrench=own[5:11],
            memory=np.repeat(own[11:13], 3),
        )

    def learn_from(self, other: 'NoiseModel') -> 'NoiseModel':
        """Return the model with all that another one has learned."""
        return replace(
            self.with_logarithms(other.logarithms),
            wrench_ahead=other.wrench_ahead,
            memory_ahead=other.memory_ahead,
        )


def average_noise(models: Sequence[NoiseModel]) -> NoiseModel:
    """Return the noise of flights of which nothing else is known: the geometric mean."""
    return models[0].with_logarithms(np.mean([one.logarithms for one in models], axis=0))


def wrench_floor(nominal: NominalVehicle) -> Array:
    """Return the noise floor of the unexplained wrench of a vehicle, shape (6,) [N, N m]."""
    inertia = np.diag(nominal.inertia) / FLOOR_INERTIA
    floor: Array = WRENCH_FLOOR * np.concatenate([np.full(3, nominal.mass / FLOOR_MASS), inertia])
    return floor

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compute wind, noise, light and voltage around a vehicle for each control period."""

from collections.abc import Mapping
import math
from typing import final, NamedTuple

from lta_model.effects import initial_memory
from lta_model.effects.air import stationary_memory, TURBULENCE
from lta_model.light.view import LightView, Pose
from lta_model.scenario import Scenario
from lta_model.state import IRRADIANCE, NOISE, RIGID, SURROUNDINGS, VOLTAGE, WIND, WIND_RATE
from lta_sim.scene_model import load_wind_record
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Vector = tuple[float, float, float]


def draw_initial_memory(
    parameters: Mapping[str, Mapping[str, float]], chance: Generator
) -> list[float]:
    """Return the initial memory of all effects, with turbulence in its stationary state."""
    memory = list(initial_memory())
    if 'turbulence' in parameters:
        # The layout counts from the start of the state, the memory begins after the rigid body
        first = SIM_LAYOUT.remembers['turbulence'] - RIGID
        normals = chance.standard_normal(len(TURBULENCE.memory))
        memory[first : first + len(normals)] = stationary_memory(tuple(normals.tolist()))
    return memory


class SteadyWind(NamedTuple):
    """Steady wind of a scene [m/s, map]; it changes by `step` in the door, at x = `wall` [m]."""

    inside: Vector
    step: Vector  # zero in a scene without a door
    wall: float
    radius: float  # half length of the hull [m]


def build_steady_wind(scenario: Scenario, radius: float) -> SteadyWind:
    """Return the steady wind of a scene on a hull of some half length [m]."""
    x, y, z = scenario.air.wind.vector
    outside = scenario.outside
    beyond = (x, y, z) if outside is None else outside.wind.vector
    return SteadyWind(
        (x, y, z),
        (beyond[0] - x, beyond[1] - y, beyond[2] - z),
        scenario.room.size.vector[0] / 2,
        radius,
    )


def steady_wind_at(wind: SteadyWind, x: float) -> Vector:
    """Return the wind on a hull whose centre is at some map x: in the door a share of each."""
    # Share of the hull that is beyond the wall
    share = min(max(0.5 + 0.5 * (x - wind.wall) / wind.radius, 0.0), 1.0)
    inside, step = wind.inside, wind.step
    return (inside[0] + share * step[0], inside[1] + share * step[1], inside[2] + share * step[2])


@final
class FlightEnvironment:
    """
    The surroundings of one flight; only values that an active effect needs are updated.

    Turbulence noise is drawn once per control period from its own stream while the effect is on.
    Light and voltage are those at the beginning of the period. Recorded wind is that of the middle
    of the period with its mean rate of change: a neutral hull without drag ends each period with
    the speed of the air, and drag sees an airspeed that is wrong by at most the change in half a
    period.
    """

    def __init__(
        self,
        effect_parameters: Mapping[str, Mapping[str, float]],
        scenario: Scenario,
        light: LightView,
        chance: Generator,
        period: float,
        radius: float,
    ) -> None:
        self.numbers: NDArray[np.float64] = np.zeros(SURROUNDINGS)
        self._steady = build_steady_wind(scenario, radius)
        self._record = load_wind_record(scenario)
        # Elsewhere the steady wind is the same in all places
        self._varies = scenario.outside is not None or self._record is not None
        self.numbers[WIND : WIND + 3] = steady_wind_at(self._steady, 0.0)
        self._period = period
        self._turbulent = 'turbulence' in effect_parameters
        self._warmed = 'superheat' in effect_parameters
        self._light, self._chance = light, chance
        # Variance 1 / period gives the piecewise constant noise unit intensity
        self._deviation = 1.0 / math.sqrt(period)

    def refresh(self, pose: Pose, voltage: float, elapsed: float) -> None:
        """Update the surroundings for the next control period."""
        self.numbers[VOLTAGE] = voltage
        if self._varies:
            self.numbers[WIND : WIND + 3] = steady_wind_at(self._steady, pose[0])
        if self._record is not None:
            wind, rate = self._record.average_wind_over_span(elapsed, elapsed + self._period)
            self.numbers[WIND : WIND + 3] += wind
            self.numbers[WIND_RATE : WIND_RATE + 3] = rate
        if self._turbulent:
            noise = self._chance.standard_normal(3)
            self.numbers[NOISE : NOISE + 3] = noise * self._deviation
        if self._warmed:
            self.numbers[IRRADIANCE] = self._light.hull_irradiance(pose)

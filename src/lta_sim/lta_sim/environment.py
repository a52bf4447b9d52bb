"""Compute wind, noise, light and voltage around a vehicle for each control period."""

from collections.abc import Mapping
import math
from typing import final

from lta_model.effects import initial_memory
from lta_model.effects.air import turbulence
from lta_model.light.view import LightView, Pose
from lta_model.scenario import Scenario
from lta_model.state import IRRADIANCE, NOISE, RIGID, SURROUNDINGS, VOLTAGE, WIND, WIND_RATE
from lta_sim.kernels.kernel import LAYOUT
from lta_sim.scene_model import load_wind_record
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray


def draw_initial_memory(
    parameters: Mapping[str, Mapping[str, float]], chance: Generator
) -> list[float]:
    """Return the initial memory of all effects, with turbulence in its stationary state."""
    memory = list(initial_memory())
    if 'turbulence' in parameters:
        # The layout counts from the start of the state, the memory begins after the rigid body
        first = LAYOUT.remembers['turbulence'] - RIGID
        drawn = chance.standard_normal(len(turbulence.MEMORY))
        memory[first : first + len(drawn)] = turbulence.stationary_memory(tuple(drawn.tolist()))
    return memory


@final
class _DoorWind:
    """Steady wind in a room and outside its door; a hull in the door gets a share of each."""

    def __init__(self, scenario: Scenario, radius: float) -> None:
        self._inside = np.array(scenario.air.wind.vector)
        beyond = self._inside if scenario.outside is None else scenario.outside.wind.vector
        self._step = np.array(beyond) - self._inside
        self._wall, self._radius = scenario.room.size.vector[0] / 2, radius

    def wind_at(self, x: float) -> NDArray[np.float64]:
        """Return the wind on a hull whose centre is at map x [m]. [m/s]"""
        # Share of the hull's diameter that is beyond the wall
        out = 0.5 + 0.5 * (x - self._wall) / self._radius
        wind: NDArray[np.float64] = self._inside + min(max(out, 0.0), 1.0) * self._step
        return wind


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
        self._steady = np.array(scenario.air.wind.vector)
        self.numbers[WIND : WIND + 3] = self._steady
        self._door = None if scenario.outside is None else _DoorWind(scenario, radius)
        self._record = load_wind_record(scenario)
        self._period = period
        self._turbulent = 'turbulence' in effect_parameters
        self._warmed = 'superheat' in effect_parameters
        self._light, self._chance = light, chance
        # Variance 1 / period gives the piecewise constant noise unit intensity
        self._deviation = 1.0 / math.sqrt(period)

    def refresh(self, pose: Pose, voltage: float, elapsed: float) -> None:
        """Update the surroundings for the next control period."""
        self.numbers[VOLTAGE] = voltage
        steady = self._steady if self._door is None else self._door.wind_at(pose[0])
        self.numbers[WIND : WIND + 3] = steady
        if self._record is not None:
            wind, rate = self._record.sample_span(elapsed, elapsed + self._period)
            self.numbers[WIND : WIND + 3] += wind
            self.numbers[WIND_RATE : WIND_RATE + 3] = rate
        if self._turbulent:
            noise = self._chance.standard_normal(3)
            self.numbers[NOISE : NOISE + 3] = noise * self._deviation
        if self._warmed:
            self.numbers[IRRADIANCE] = self._light.hull_irradiance(pose)

"""What surrounds a vehicle during a control period, as the numbers that the kernel takes."""

from collections.abc import Mapping
import math
from typing import final

from lta_sim.light_view import LightView, Pose
from lta_sim.scenario import Scenario
from lta_sim.state import IRRADIANCE, NOISE, SURROUNDINGS, VOLTAGE, WIND
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray


@final
class Around:
    """
    The surroundings of one flight; only what an effect looks at is kept up.

    The noise of turbulence is drawn for a control period at a time, from a stream of its own and
    only while the effect is on: of variance 1 / period, so that it has unit intensity. Light and
    voltage are those of the period's beginning.

    Parameters
    ----------
    given : mapping
        The effects that are on, `Model.given`.
    scenario : Scenario
        The wind.
    light : LightView
        The light on the hull.
    chance : Generator
        Of turbulence.
    period : float
        Control period. [s]

    Attributes
    ----------
    numbers : ndarray of float64, shape (SURROUNDINGS,)
        In the layout of `lta_sim.state`.

    """

    def __init__(
        self,
        given: Mapping[str, Mapping[str, float]],
        scenario: Scenario,
        light: LightView,
        chance: Generator,
        period: float,
    ) -> None:
        self.numbers: NDArray[np.float64] = np.zeros(SURROUNDINGS)
        self.numbers[WIND : WIND + 3] = scenario.air.wind.vector
        self._turbulent, self._warmed = 'turbulence' in given, 'superheat' in given
        self._light, self._chance = light, chance
        self._deviation = 1.0 / math.sqrt(period)

    def refresh(self, pose: Pose, voltage: float) -> None:
        """Set what a control period finds that begins at a pose, with so many volts of battery."""
        self.numbers[VOLTAGE] = voltage
        if self._turbulent:
            noise = self._chance.standard_normal(3)
            self.numbers[NOISE : NOISE + 3] = noise * self._deviation
        if self._warmed:
            self.numbers[IRRADIANCE] = self._light.on_hull(pose)

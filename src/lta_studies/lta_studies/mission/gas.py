"""
Estimate how the gas of a drone changes its lift over a day, and what its rotors can counter.

The missions fly with gas at the temperature of the air of the vehicle file. A slack envelope lets
gas that light warms expand, and lifts more by `slack m_d g theta / T`; a taut one keeps its
volume, and lifts less in warmer, thinner air. Both by the equations of the effects `superheat` and
`air_state`, with gas at its steady temperature. The priors of `superheat` are unverified.

While the additional lift of a slack envelope exceeds what weight and rotors counter, the drone
rises whatever it does: its flights at these times are counted, though they were simulated.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_config.constants import AIR_TEMPERATURE, STANDARD_GRAVITY
from lta_config.schema.mission_file import DAY
from lta_energy.irradiance import IrradianceSeries, MINUTE, MINUTES
from lta_model.effects.gas import IN_SUN
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.wrench_limit import solve_wrench_limit
import numpy as np

SWING: Final = 10.0  # K, a change of the air over a day


@final
@dataclass(frozen=True, slots=True)
class GasOverDay:
    """Change of lift over a day, and what the drone can hold."""

    irradiance: float  # strongest light on level ground [W/m2]
    warmer: float  # temperature of the gas above that of the air there [K]
    slack_gain: float  # lift that a slack envelope gains there, as mass [kg]
    # Lift that a taut envelope loses in air that is warmer by `SWING`, as mass [kg]
    taut_loss: float
    held: float  # additional lift that weight and rotors can counter, as mass [kg]
    # First and last time of day at which a slack envelope lifts more than that [s]; None if never
    too_light: tuple[float, float] | None

    @property
    def ballast(self) -> float:
        """Mass with which a slack drone could hold its height in the strongest light. [kg]"""
        return max(self.slack_gain - self.held, 0.0)

    def count_too_light(self, starts: Iterable[float]) -> int:
        """Return how many flights start, in s since the first midnight, when it is too light."""
        if self.too_light is None:
            return 0
        begin, end = self.too_light
        return sum(begin <= start % DAY <= end for start in starts)

    @property
    def is_held(self) -> bool:
        """Whether the drone can hold its height in the strongest light, slack or taut."""
        return max(self.slack_gain, self.taut_loss) <= self.held


def estimate_gas_over_day(vehicle: Vehicle, light: IrradianceSeries) -> GasOverDay:
    """Return the change of lift over a day with some light."""
    irradiance = light.sun + light.lamps
    displaced = vehicle.air_density * vehicle.volume
    gain = displaced * IN_SUN['warming'] * irradiance / AIR_TEMPERATURE
    down = solve_wrench_limit(vehicle, 'down')
    held = vehicle.heaviness + (0.0 if down is None else down.most / STANDARD_GRAVITY)
    minutes = np.flatnonzero(gain > held) % MINUTES
    return GasOverDay(
        float(irradiance.max()),
        IN_SUN['warming'] * float(irradiance.max()),
        float(gain.max()),
        displaced * SWING / (AIR_TEMPERATURE + SWING),
        held,
        (MINUTE * int(minutes.min()), MINUTE * int(minutes.max())) if minutes.size else None,
    )


def describe_gas(gas: GasOverDay) -> str:
    """Return the effect of the day on the lift of the gas, in words."""
    grams = 1e3
    verdict = 'it can hold its height' if gas.is_held else 'it rises, or sinks in warm air'
    return (
        'The missions fly with gas at the temperature of the air. In the strongest light of this '
        f'day, {gas.irradiance:.0f} W/m², the gas would be {gas.warmer:.1f} K warmer (heat '
        f'balance of the effect superheat, unverified): a slack envelope lifts '
        f'{grams * gas.slack_gain:.1f} g more. In air that is {SWING:.0f} K warmer, a taut one '
        f'lifts {grams * gas.taut_loss:.1f} g less, and in colder air more. Weight and rotors '
        f'can counter {grams * gas.held:.1f} g of lift: {verdict}.'
    )  # fmt: skip


def describe_too_light(gas: GasOverDay, starts: Sequence[float]) -> str:
    """Return when a slack envelope lifts too much to fly, and the flights then; '' if never."""
    if gas.too_light is None:
        return ''
    begin, end = (f'{int(at // 3600)}:{int(at % 3600 // 60):02d}' for at in gas.too_light)
    return (
        f'With a slack envelope the sun makes it too light to fly between {begin} and {end}, by '
        f'up to {1e3 * gas.ballast:.1f} g: {gas.count_too_light(starts)} of {len(starts)} flights '
        'started then. It needs that much more ballast at noon, or a taut envelope.'
    )

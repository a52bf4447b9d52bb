"""
Estimate how the gas of a drone changes its lift over a day, and what its rotors can counter.

The missions fly with gas at the temperature of the air of the vehicle file. A slack envelope lets
gas that light warms expand, and lifts more by `slack m_d g theta / T`; a taut one keeps its
volume, and lifts less in warmer, thinner air. Both by the equations of the effects `superheat` and
`air_state`. The priors of `superheat` are unverified.
"""

from dataclasses import dataclass
from typing import Final, final

from lta_config.constants import AIR_TEMPERATURE, STANDARD_GRAVITY
from lta_energy.irradiance import IrradianceSeries
from lta_model.effects.weight.superheat import IN_SUN
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.wrench_limit import solve_wrench_limit

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

    @property
    def is_held(self) -> bool:
        """Whether the drone can hold its height in the strongest light, slack or taut."""
        return max(self.slack_gain, self.taut_loss) <= self.held


def estimate_gas_over_day(vehicle: Vehicle, light: IrradianceSeries) -> GasOverDay:
    """Return the change of lift over a day with some light."""
    brightest = float((light.sun + light.lamps).max())
    warmer = IN_SUN['warming'] * brightest
    displaced = vehicle.air_density * vehicle.volume
    down = solve_wrench_limit(vehicle, 'down')
    return GasOverDay(
        brightest,
        warmer,
        displaced * warmer / AIR_TEMPERATURE,
        displaced * SWING / (AIR_TEMPERATURE + SWING),
        vehicle.heaviness + (0.0 if down is None else down.most / STANDARD_GRAVITY),
    )


def describe_gas(gas: GasOverDay) -> str:
    """Return the effect of the day on the lift of the gas, in words."""
    grams = 1e3
    verdict = (
        'it can hold its height' if gas.is_held
        else 'it has to be trimmed again before it flies, or rises'
    )  # fmt: skip
    return (
        'The missions fly with gas at the temperature of the air. In the strongest light of this '
        f'day, {gas.irradiance:.0f} W/m², the gas would be {gas.warmer:.1f} K warmer (heat '
        f'balance of the effect superheat, unverified): a slack envelope lifts '
        f'{grams * gas.slack_gain:.1f} g more. In air that is {SWING:.0f} K warmer, a taut one '
        f'lifts {grams * gas.taut_loss:.1f} g less, and in colder air more. Weight and rotors '
        f'can counter {grams * gas.held:.1f} g of lift: {verdict}.'
    )  # fmt: skip

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find in which light a drone is too light to fly, as the sun warms its gas.

A slack envelope lets warm gas expand, and lifts more by `slack m_d g theta / T`; a taut one keeps
its volume, and lifts less in warmer, thinner air. Both by the equations of the effects `superheat`
and `air_state`, with gas at its steady temperature. The priors of `superheat` are unverified, and
how slack a foil balloon is, is not known: each seed draws it from taut (0) to slack (1).

While the additional lift exceeds what weight and rotors counter, the drone would rise whatever it
does: it stays on its perch, and the flight counts as not flown. The flights that are flown have
gas at the temperature of the air.
"""

from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.constants import AIR_TEMPERATURE, STANDARD_GRAVITY
from lta_energy.irradiance import IrradianceSeries
from lta_model.effects.gas import IN_SUN
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.wrench_limit import solve_wrench_limit
import numpy as np

DAILY_AIR_SWING: Final = 10.0  # K, a change of the air over a day
SLACK_STREAM: Final = 0x51AC  # tag of the random stream, apart from others of the same seed


def draw_slack(seed: int) -> float:
    """Return how slack the envelope of a seed is, 0 (taut) to 1."""
    return float(np.random.default_rng(np.random.SeedSequence([seed, SLACK_STREAM])).random())


def countered_lift(vehicle: Vehicle) -> float:
    """Return the additional lift that weight and rotors can counter, as mass [kg]."""
    down = solve_wrench_limit(vehicle, 'down')
    return vehicle.heaviness + (0.0 if down is None else down.most / STANDARD_GRAVITY)


def slack_gain(vehicle: Vehicle, irradiance: float) -> float:
    """Return the lift that a slack envelope gains in light [W/m2], as mass [kg]."""
    displaced = vehicle.air_density * vehicle.volume
    return displaced * IN_SUN['warming'] * irradiance / AIR_TEMPERATURE


def find_brightest_light(vehicle: Vehicle, slack: float) -> float:
    """Return the light above which the drone is too light to fly; infinite if taut [W/m2]."""
    gain = slack * slack_gain(vehicle, 1.0)
    return countered_lift(vehicle) / gain if gain > 0.0 else math.inf


@final
@dataclass(frozen=True, slots=True)
class GasOverDay:
    """Change of lift over a day, and what the drone can hold."""

    irradiance: float  # strongest light on level ground [W/m2]
    warmer: float  # temperature of the gas above that of the air there [K]
    slack_gain: float  # lift that a slack envelope gains there, as mass [kg]
    # Lift that a taut envelope loses in air that is warmer by `DAILY_AIR_SWING`, as mass [kg]
    taut_loss: float
    held: float  # additional lift that weight and rotors can counter, as mass [kg]

    @property
    def ballast(self) -> float:
        """Mass with which a slack drone could hold its height in the strongest light [kg]."""
        return max(self.slack_gain - self.held, 0.0)


def estimate_gas_over_day(vehicle: Vehicle, light: IrradianceSeries) -> GasOverDay:
    """Return the change of lift over a day with some light."""
    irradiance = float((light.sun + light.lamps).max())
    return GasOverDay(
        irradiance,
        IN_SUN['warming'] * irradiance,
        slack_gain(vehicle, irradiance),
        vehicle.air_density
        * vehicle.volume
        * DAILY_AIR_SWING
        / (AIR_TEMPERATURE + DAILY_AIR_SWING),
        countered_lift(vehicle),
    )


def describe_gas(gas: GasOverDay) -> str:
    """Return the effect of the day on the lift of the gas, in words."""
    grams = 1e3
    return (
        f'In the strongest light of this day, {gas.irradiance:.0f} W/m², the gas is '
        f'{gas.warmer:.1f} K warmer than the air (heat balance of the effect superheat, '
        f'unverified): a slack envelope lifts {grams * gas.slack_gain:.1f} g more. In air that is '
        f'{DAILY_AIR_SWING:.0f} K warmer, a taut one lifts {grams * gas.taut_loss:.1f} g '
        f'less, and in '
        f'colder air more. Weight and rotors can counter {grams * gas.held:.1f} g of lift. Each '
        'seed draws how slack the envelope is, from 0 (taut) to 1; while it lifts too much, the '
        'drone stays on its perch. A fully slack one would need '
        f'{grams * gas.ballast:.1f} g more ballast.'
    )

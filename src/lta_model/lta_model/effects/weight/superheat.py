"""
Lift of gas warmed by light, where the envelope lets it expand.

    F = slack m_d g (theta / T) e_z,    d/dt theta = (warming E - theta) / lag

at the hull centre; theta (memory) is the temperature of the gas above that of the air [K], E the
irradiance on the hull, m_d the mass of the displaced air, T = 293.15 K that of the air, e_z the
vertical. With `lag` 0 the gas is at its steady temperature.

Gas in a slack envelope stays at air pressure, so its volume grows as theta / T (ideal gas law) at
constant mass, and the lift grows by the newly displaced air (Archimedes). A taut foil balloon
keeps its volume: its pressure grows by 346 Pa/K and its lift does not. `slack` is the share of the
free expansion: 0 taut, 1 slack.

Heat balance of an aluminised 1 m balloon, for the priors: it absorbs 0.14 E (solar absorptance of
aluminised film, aluminium outside: Fortescue, Swinerd and Stark 2011, table 11.3) on 0.785 m2 and
loses h = 2.6 W/(m2 K) by free convection on 2.47 m2 (unverified, from memory; radiation is small,
emittance 0.05), so warming = 0.017 K m2/W; gas 296 J/K and film 152 J/K (116.8 g at
1.3 kJ/(kg K), unverified, from memory) over 6.4 W/K, so lag = 70 s. In `sunny_field` (daylight of
105 lm/W) E is 1020 W/m2: 17 K and, slack, 24 g of lift when steady; 10 K and 14 g after a minute.
`IN_SUN` has these values, for scenes with a sun; a vehicle file that has the effect has its own.

Not modelled: forced convection by wind, stirring of the gas, one-sided sun, a change of T.
"""

from collections.abc import Mapping
from typing import Final

from lta_config.constants import AIR_TEMPERATURE, STANDARD_GRAVITY
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect
from lta_model.state import DISPLACED, IRRADIANCE

PARAMETERS = (
    EffectParameter(
        'warming', 'K m2/W', 0.0, 0.0, 1.0, 0.01,
        'spread: from the heat balance; limit: ten times a black film with little convection',
    ),
    EffectParameter(
        'lag', 's', 0.0, 1.0, 1e4, 40.0,
        'spread: from the heat balance; limits: a thin film alone, a stratospheric '
        'balloon (assumed)',
        beside=40.0,
    ),
    EffectParameter(
        'slack', '1', 0.0, 0.0, 1.0, 0.3,
        'by definition from taut (0) to slack (1); spread: not known for a foil balloon '
        '(assumed)',
        beside=0.3,
    ),
)  # fmt: skip

# Heat balance above, and the envelope that lets all of the lift out
IN_SUN: Final[Mapping[str, float]] = {'warming': 0.017, 'lag': 70.0, 'slack': 1.0}


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the lift of the expanded gas."""
    warming, lag, slack = p
    steady = warming * motion.surroundings[IRRADIANCE]
    # Without a lag the gas is at its steady temperature
    warmer = memory[0] if lag > 0.0 else steady
    weight = motion.body[DISPLACED] * STANDARD_GRAVITY
    # Volume grows with theta / T, and with it the displaced air
    lift = slack * weight * warmer / AIR_TEMPERATURE
    r = motion.rotation
    return (lift * r[6], lift * r[7], lift * r[8], 0.0, 0.0, 0.0)


def compute_memory_rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return d/dt of the temperature of the gas above that of the air."""
    warming, lag, slack = p  # noqa: RUF059 (the kernel knows parameters by their order)
    steady = warming * motion.surroundings[IRRADIANCE]
    return ((steady - memory[0]) / lag if lag > 0.0 else 0.0,)


EFFECT = WrenchEffect(
    'superheat',
    PARAMETERS,
    compute_wrench,
    ('slack',),
    memory=(('warmer', 0.0),),
    rate=compute_memory_rate,
)

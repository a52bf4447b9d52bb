"""
Gas that was filled warmer than the air, or under overpressure.

    m' = m + m_gas ((1 + overpressure / p_0) / (1 + dT / T_0) - 1)

m_gas is the mass of the gas at p_0 = 101325 Pa and T_0 = 293.15 K, with which the model was built;
the rest is the ideal gas law at the hull's volume. The mass is a separate parameter because it
includes purity: pure helium weighs 0.14 of the displaced air, helium of 93 % 0.20. The vehicle
sets it.

The hull was *filled* to this state: warmer gas of the same pressure is less gas. `superheat` is
for gas that warms in flight. For 80 g of gas 5 K are 1.3 g and 1 kPa is 0.8 g. The mass acts at
the hull centre. Not modelled: its inertia, r^2 / 5 for each axis if solid; a gas turns only
partly.
"""

from lta_config.constants import AIR_PRESSURE, AIR_TEMPERATURE
from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values

PARAMETERS = (
    EffectParameter(
        'gas', 'kg', 0.0, 0.0, 100.0, 0.01,
        'follows from hull and purity; spread: 3 % of purity for 0.4 kg of displaced air',
    ),
    EffectParameter(
        'temperature', 'K', 0.0, -80.0, 80.0, 3.0,
        'spread: gas fresh from the bottle, or warmed by lamps (assumed)',
    ),
    EffectParameter(
        'overpressure', 'Pa', 0.0, -100.0, 1e4, 300.0,
        'spread: a foil balloon filled until taut (assumed); a limp film cannot hold a '
        'negative pressure',
    ),
)  # fmt: skip


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the body with that gas."""
    gas, temperature, overpressure = p
    # Ideal gas at constant volume: mass goes with p / T
    colder = AIR_TEMPERATURE / (AIR_TEMPERATURE + temperature)
    more = (AIR_PRESSURE + overpressure) / AIR_PRESSURE * colder - 1.0
    return RigidBody(rigid.mass + gas * more, rigid.moment, rigid.inertia, rigid.displaced)


EFFECT = BodyEffect('gas_state', PARAMETERS, change_body)

"""
Air pressure and temperature that differ from those the model was built with.

    ratio = (1 + dp / p_0) / (1 + dT / T_0),    m_d' = m_d (1 + (1 - slack) (ratio - 1))

m_d is the mass of the displaced air, p_0 = 101325 Pa and T_0 = 293.15 K; ratio is that of the
densities (ideal gas law). A taut envelope (`slack` 0) keeps its volume and displaces air of the
new density. A slack one (1) follows the pressure and temperature of the air, its volume goes with
1 / ratio, and it displaces the same mass. The mass of the gas stays. For a taut 1 m balloon 1 K is
1.4 g of lift and 1 hPa is 0.4 g. Not modelled: added mass and drag, which also go with the density
(1.7 % at 5 K), and humidity.
"""

from lta_config.constants import AIR_PRESSURE, AIR_TEMPERATURE
from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values

PARAMETERS = (
    EffectParameter(
        'pressure', 'Pa', 0.0, -8e4, 2e4, 1e3,
        'spread: 10 hPa, from the weather (unverified, from memory); limits: 10 km '
        'altitude, a deep mine',
    ),
    EffectParameter(
        'temperature', 'K', 0.0, -80.0, 60.0, 5.0,
        'spread: rooms between 15 and 25 C (assumed); limits: temperatures in which '
        'people fly',
    ),
    EffectParameter(
        'slack', '1', 0.0, 0.0, 1.0, 0.3,
        'by definition from taut (0) to slack (1); spread: not known for a foil balloon '
        '(assumed)',
    ),
)  # fmt: skip


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the body in that air."""
    pressure, temperature, slack = p
    # Density ratio by temperature at constant pressure (ideal gas)
    colder = AIR_TEMPERATURE / (AIR_TEMPERATURE + temperature)
    denser = (AIR_PRESSURE + pressure) / AIR_PRESSURE * colder - 1.0
    displaced = rigid.displaced * (1.0 + (1.0 - slack) * denser)
    return RigidBody(rigid.mass, rigid.moment, rigid.inertia, displaced)


EFFECT = BodyEffect('air_state', PARAMETERS, change_body)

"""
Helium purity that differs from the vehicle file.

    m' = m - purity (1 - rho_he / rho_air) m_d

`purity` is the deviation of the volume fraction of helium, the rest being air; m_d is the mass of
the displaced air, so 1 % of a 1 m balloon is 3.6 g. Densities are at one temperature and pressure,
the volume is constant, and the air is at the hull centre. Not modelled: the inertia of that air;
as a solid it would be r^2 / 5 for each axis, but a gas turns only partly with its hull.
"""

from lta_config.constants import HELIUM_TO_AIR
from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values

PARAMETERS = (
    EffectParameter(
        'purity', '1', 0.0, -1.0, 1.0, 0.03,
        'spread: lift of 329 to 332 g instead of 356 g stated for the 1 m balloon, 112 '
        'instead of 163 g measured on a GT-MAB; 3 % around a given purity (assumed)',
    ),
)  # fmt: skip


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the body with that gas."""
    (purity,) = p
    # Purer gas is lighter at the same volume
    mass = rigid.mass - purity * (1.0 - HELIUM_TO_AIR) * rigid.displaced
    return RigidBody(mass, rigid.moment, rigid.inertia, rigid.displaced)


EFFECT = BodyEffect('gas_purity', PARAMETERS, change_body)

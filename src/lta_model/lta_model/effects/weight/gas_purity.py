"""
Helium purer or less pure than the vehicle file says.

    m' = m - purity (1 - rho_he / rho_air) m_d

`purity` is the deviation of the share of helium by volume, the rest being air; m_d the mass of the
displaced air, so that 1 % of a 1 m balloon is 3.6 g. The densities are taken at one temperature
and pressure. The volume stays: air stands where helium was meant to be, at the hull centre. Left
out is the inertia of that air: as a solid it would be r^2 / 5 for each axis, but a gas turns with
its hull in part only.
"""

from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values
from lta_model.gas import HELIUM_TO_AIR

PARAMETERS = (
    EffectParameter(
        'purity', '1', 0.0, -1.0, 1.0, 0.03,
        'prior: 329 to 332 g of 356 g stated for the 1 m balloon, 112 of 163 g measured on a '
        'GT-MAB; assumed 3 % around a declared purity',
    ),
)  # fmt: skip


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the vehicle with that gas."""
    (purity,) = p
    mass = rigid.mass - purity * (1.0 - HELIUM_TO_AIR) * rigid.displaced
    return RigidBody(mass, rigid.moment, rigid.inertia, rigid.displaced)


EFFECT = BodyEffect('gas_purity', PARAMETERS, change_body)

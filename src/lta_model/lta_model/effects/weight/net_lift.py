"""
Constant vertical force at the hull centre.

    F = force e_z

e_z is the map's vertical. The error of weighing and filling, without place, mass or cause, unlike
`payload`, `gas_purity` and `helium_leak`. A flight cannot distinguish it from a payload near the
hull centre; weigh the vehicle.
"""

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS = (
    EffectParameter(
        'force', 'N', 0.0, -50.0, 50.0, 0.02,
        'spread: 2 g for a weighed and trimmed balloon (assumed)',
    ),
)  # fmt: skip


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the extra force."""
    (force,) = p
    r = motion.rotation
    # Third row of R is the map's vertical in the body frame
    return (force * r[6], force * r[7], force * r[8], 0.0, 0.0, 0.0)


EFFECT = WrenchEffect('net_lift', PARAMETERS, compute_wrench, ('force',))

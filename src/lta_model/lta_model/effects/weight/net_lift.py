"""
A constant extra force up, at the hull centre.

    F = force e_z

e_z is the map's vertical. The lift that weighing and filling left unknown: it has no place, no
mass and no cause, which is what tells it from `payload`, `gas_purity` and `helium_leak`. In flight
it cannot be told from a payload near the hull centre; weigh the vehicle.
"""

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS = (
    EffectParameter(
        'force', 'N', 0.0, -50.0, 50.0, 0.02,
        'prior: 2 g on a weighed and trimmed balloon (assumed)',
    ),
)  # fmt: skip


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the extra lift."""
    (force,) = p
    r = motion.rotation
    return (force * r[6], force * r[7], force * r[8], 0.0, 0.0, 0.0)


EFFECT = WrenchEffect('net_lift', PARAMETERS, compute_wrench, ('force',))

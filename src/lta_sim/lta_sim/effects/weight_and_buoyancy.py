"""
Weight at the centre of gravity, buoyancy at the hull centre.

With e_z the map's vertical seen from the body and r the centre of gravity:

    F = (buoyancy - weight) e_z,    N = r x (-weight e_z)

A CG below the hull centre rights the vehicle. The weight is that of the solid parts and of the
gas, the buoyancy that of the displaced air (Archimedes); both act through the air's own weight
only, so the wind does not enter. Left out: the change of either with height, temperature and
leakage.
"""

from lta_sim.effects.protocol import Duty, Motion, Parameter, Values, Wrench, WrenchEffect

_SPREAD = 'prior: 2 g on a weighed and trimmed balloon'
_LEVER = 'prior: 5 mm on a balanced CG, within a hull of 3 m'

PARAMETERS = (
    Parameter('buoyancy', 'N', 0.0, 0.0, 500.0, 0.02, _SPREAD),
    Parameter('weight', 'N', 0.0, 0.0, 500.0, 0.02, _SPREAD),
    Parameter('cg_x', 'm', 0.0, -3.0, 3.0, 0.005, _LEVER),
    Parameter('cg_y', 'm', 0.0, -3.0, 3.0, 0.005, _LEVER),
    Parameter('cg_z', 'm', 0.0, -3.0, 3.0, 0.005, _LEVER),
)


def wrench(p: Values, motion: Motion, duty: Duty) -> Wrench:
    """Return net lift and righting moment."""
    buoyancy, weight, cg_x, cg_y, cg_z = p
    up = motion.rotation
    net = buoyancy - weight
    return (
        net * up[6],
        net * up[7],
        net * up[8],
        -weight * (cg_y * up[8] - cg_z * up[7]),
        -weight * (cg_z * up[6] - cg_x * up[8]),
        -weight * (cg_x * up[7] - cg_y * up[6]),
    )


EFFECT = WrenchEffect('weight_and_buoyancy', PARAMETERS, wrench, ('buoyancy', 'weight'))

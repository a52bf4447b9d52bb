"""
A rotor that blows onto the floor thrusts more.

    f = gain x / (1 - x) |n_z| T,   x = (radius / 4 z)^2,   z >= radius / 2

along the rotor's axis; T is its thrust, z its height above the floor z = 0 of the map, n_z the
upward part of its axis. f acts only where the thrust lifts (n_z T > 0), since another jet misses
the floor. `gain` 1 is Cheeseman and Bennett 1955 (ARC R&M 3021), a source in the disk and its
image below the floor at equal power; below z = radius / 2 the force stays what it is there, a
third of T. Several rotors close together gain more (Sanchez-Cuevas et al. 2017, doi
10.1155/2017/1823056). Left out: the fountain between rotors, the cushion under the hull, loss by
forward flight.
"""

from collections.abc import Mapping

from lta_sim.effects.protocol import Motion, Parameter, Values, Wrench, WrenchEffect
from lta_sim.rotor_sum import added, rotor_height, rotor_upright

_GAIN = '1 is Cheeseman and Bennett 1955; small rotors scatter around it; prior: 0.5, assumed'
_RADIUS = 'of the propeller, 23.5 mm for 47 mm ones; prior: 1 mm'

PARAMETERS = (
    Parameter('gain', '1', 0.0, 0.0, 5.0, 0.5, _GAIN),
    Parameter('radius', 'm', 0.0, 0.005, 1.0, 0.001, _RADIUS),
)


def extra(gain: float, radius: float, motion: Motion, thrust: float, i: int) -> float:
    """Return what rotor i thrusts more. [N]"""
    up = rotor_upright(motion, i)
    if thrust * up <= 0.0 or radius <= 0.0:
        return 0.0
    share = radius / (4.0 * max(rotor_height(motion, i), 0.5 * radius))
    return gain * share * share / (1.0 - share * share) * abs(up) * thrust


def wrench(p: Values, memory: Values, motion: Motion, thrust: Values) -> Wrench:
    """Return what the floor adds to the thrust of all rotors."""
    gain, radius = p
    forces = (
        extra(gain, radius, motion, thrust[0], 0),
        extra(gain, radius, motion, thrust[1], 1),
        extra(gain, radius, motion, thrust[2], 2),
        extra(gain, radius, motion, thrust[3], 3),
        extra(gain, radius, motion, thrust[4], 4),
        extra(gain, radius, motion, thrust[5], 5),
        extra(gain, radius, motion, thrust[6], 6),
        extra(gain, radius, motion, thrust[7], 7),
    )
    return added(motion.body, forces)


def check(values: Mapping[str, float]) -> str:
    """Return why a ground effect without the size of the rotors is none."""
    if values['gain'] > 0.0 and values['radius'] <= 0.0:
        return 'the ground effect needs the size of the rotors; give radius in metres'
    return ''


EFFECT = WrenchEffect(
    'ground_effect', PARAMETERS, wrench, linear_in=('gain',), placed=True, check=check
)

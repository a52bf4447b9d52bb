"""
Additional thrust of a rotor close to the floor.

    f = gain x / (1 - x) |n_z| T,   x = (radius / 4 z)^2,   z >= radius / 2

along the rotor's axis; T is its thrust, z its height above the floor z = 0 of the map, n_z the
upward part of its axis. f acts only where the thrust lifts (n_z T > 0), since other jets miss the
floor. `gain` 1 is Cheeseman and Bennett 1955 (ARC R&M 3021), a source in the disk and its image
below the floor at equal power; below z = radius / 2 the force stays constant, T / 3. Several
rotors close together gain more (Sanchez-Cuevas et al. 2017, doi 10.1155/2017/1823056). Not
modelled: the fountain between rotors, the cushion under the hull, loss by forward flight.
"""

from collections.abc import Mapping

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect
from lta_model.rotor_forces import rotor_height, rotor_upright, sum_rotor_forces
from lta_model.state import ROTOR_PLACE

_GAIN = (
    '1: the model of Cheeseman and Bennett 1955, around which small rotors scatter; spread: '
    '0.5 (assumed)'
)
_RADIUS = 'radius of the propeller, 23.5 mm for propellers of 47 mm; spread: 1 mm'

PARAMETERS = (
    EffectParameter('gain', '1', 0.0, 0.0, 5.0, 0.5, _GAIN),
    EffectParameter('radius', 'm', 0.0, 0.005, 1.0, 0.001, _RADIUS, beside=0.0225),
)


def extra_thrust(
    gain: float, radius: float, motion: VehicleMotion, rotor: Values, thrust: float
) -> float:
    """Return the additional thrust of a rotor. [N]"""
    # Rotors that do not exist have neither thrust nor axis
    if thrust == 0.0 or radius <= 0.0:
        return 0.0
    # z component of the thrust axis in the map
    up = rotor_upright(motion, rotor)
    if thrust * up <= 0.0:
        return 0.0
    # Below half a radius the force stays at its value there, T / 3
    z = max(rotor_height(motion, rotor), 0.5 * radius)
    # (radius / 4)^2, so that x / (1 - x) = square / (z^2 - square)
    square = 0.0625 * radius * radius
    return gain * square / (z * z - square) * abs(up) * thrust


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the wrench that the floor adds to all rotors."""
    gain, radius = p
    # Six numbers for each rotor: place and axis
    rotors = motion.body[ROTOR_PLACE:]
    forces = (
        extra_thrust(gain, radius, motion, rotors[0:6], thrust[0]),
        extra_thrust(gain, radius, motion, rotors[6:12], thrust[1]),
        extra_thrust(gain, radius, motion, rotors[12:18], thrust[2]),
        extra_thrust(gain, radius, motion, rotors[18:24], thrust[3]),
        extra_thrust(gain, radius, motion, rotors[24:30], thrust[4]),
        extra_thrust(gain, radius, motion, rotors[30:36], thrust[5]),
        extra_thrust(gain, radius, motion, rotors[36:42], thrust[6]),
        extra_thrust(gain, radius, motion, rotors[42:48], thrust[7]),
    )
    return sum_rotor_forces(rotors, forces)


def find_conflict(values: Mapping[str, float]) -> str:
    """Return an objection to a ground effect without rotor size."""
    if values['gain'] > 0.0 and values['radius'] <= 0.0:
        return 'the ground effect needs the size of the rotors; set radius, in metres'
    return ''


EFFECT = WrenchEffect(
    'ground_effect',
    PARAMETERS,
    compute_wrench,
    linear_in=('gain',),
    placed=True,
    check=find_conflict,
)

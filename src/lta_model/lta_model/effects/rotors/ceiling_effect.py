"""
Additional thrust of a rotor below a ceiling.

    f = gain (sqrt(1 + radius^2 / (8 d^2)) - 1) / 2 |n_z| T,   d = height - z >= radius / 4

along the rotor's axis; T is its thrust, d its distance to the ceiling at `height` in the map, n_z
the upward part of its axis. f acts only where the thrust lifts (n_z T > 0). `gain` 1 is the
momentum theory of Hsiao and Chirarattananon 2019 (arXiv:1905.04632; formula as in public flight
code for a rotor of 23 mm, the paper itself not read), validated with rotors of 23 and 50 mm. Below
a quarter of the radius f stays constant, 0.37 T. For rotors with free air above them: use no gain
for rotors under a hull.
"""

from collections.abc import Mapping
import math

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect
from lta_model.rotor_forces import rotor_height, rotor_upright, sum_rotor_forces
from lta_model.state import ROTOR_PLACE

_GAIN = '1: the model of Hsiao and Chirarattananon 2019; spread: 0.5 (assumed)'
_RADIUS = 'radius of the propeller, 23.5 mm for propellers of 47 mm; spread: 1 mm'
_HEIGHT = 'height of the room; spread: 5 cm'

PARAMETERS = (
    EffectParameter('gain', '1', 0.0, 0.0, 5.0, 0.5, _GAIN),
    EffectParameter('radius', 'm', 0.0, 0.005, 1.0, 0.001, _RADIUS),
    EffectParameter('height', 'm', 0.0, 0.1, 100.0, 0.05, _HEIGHT),
)


def extra_thrust(
    gain: float, radius: float, ceiling: float, motion: VehicleMotion, rotor: Values, thrust: float
) -> float:
    """Return the additional thrust of a rotor. [N]"""
    # Rotors that do not exist have neither thrust nor axis
    if thrust == 0.0 or radius <= 0.0:
        return 0.0
    # z component of the thrust axis in the map
    up = rotor_upright(motion, rotor)
    if thrust * up <= 0.0:
        return 0.0
    # Closer than a quarter of the radius the theory is not valid: held there
    share = radius / max(ceiling - rotor_height(motion, rotor), 0.25 * radius)
    # x / (sqrt(1 + x) + 1) equals sqrt(1 + x) - 1 without cancellation for small x.
    x = 0.125 * share * share
    return 0.5 * gain * x / (math.sqrt(1.0 + x) + 1.0) * abs(up) * thrust


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the wrench that the ceiling adds to all rotors."""
    gain, radius, height = p
    # Six numbers for each rotor: place and axis
    rotors = motion.body[ROTOR_PLACE:]
    forces = (
        extra_thrust(gain, radius, height, motion, rotors[0:6], thrust[0]),
        extra_thrust(gain, radius, height, motion, rotors[6:12], thrust[1]),
        extra_thrust(gain, radius, height, motion, rotors[12:18], thrust[2]),
        extra_thrust(gain, radius, height, motion, rotors[18:24], thrust[3]),
        extra_thrust(gain, radius, height, motion, rotors[24:30], thrust[4]),
        extra_thrust(gain, radius, height, motion, rotors[30:36], thrust[5]),
        extra_thrust(gain, radius, height, motion, rotors[36:42], thrust[6]),
        extra_thrust(gain, radius, height, motion, rotors[42:48], thrust[7]),
    )
    return sum_rotor_forces(rotors, forces)


def find_conflict(values: Mapping[str, float]) -> str:
    """Return an objection to a ceiling effect without rotor size or ceiling."""
    if values['gain'] > 0.0 and values['radius'] <= 0.0:
        return 'the ceiling effect needs the size of the rotors; set radius, in metres'
    if values['gain'] > 0.0 and values['height'] <= 0.0:
        return 'the ceiling effect needs the height of the ceiling; set height, in metres'
    return ''


EFFECT = WrenchEffect(
    'ceiling_effect',
    PARAMETERS,
    compute_wrench,
    linear_in=('gain',),
    placed=True,
    check=find_conflict,
)

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Floor, walls and ceiling: contact, and their effect on rotors."""

from collections.abc import Mapping
import math

from lta_model.effects.protocol import (
    declare_each,
    EffectParameter,
    Values,
    Vector,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_model.state import ROTOR_PLACE

# m/s; below it friction grows linearly with the speed
SLIP_SPEED = 0.05


def floor_contact(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Soft floor under the landing point, for standing and take-off.

    The landing point (x, y, z) is fixed in the body; d is its depth below the floor z = 0 of the
    map and v its velocity over the ground:

        normal    P = stiffness max(0, d + relaxation d/dt d)   while d > 0, else 0
        friction  Q = -friction P v_h / sqrt(|v_h|^2 + v_s^2),   v_s = 0.05 m/s

    A one-sided Kelvin-Voigt spring with Coulomb friction smoothed below v_s for an explicit
    integrator: under a side force a standing vehicle creeps instead of sticking. The normal force
    never pulls. Not modelled: rolling and spinning friction, edges, more than one contact point.
    """
    stiffness, relaxation, friction, x, y, z = p
    r, v, w = motion.rotation, motion.velocity, motion.rates
    # Third row of R gives the height of the landing point
    depth = -(motion.position[2] + r[6] * x + r[7] * y + r[8] * z)
    # Velocity of the landing point, v + w x r, in the body frame
    u = v[0] + w[1] * z - w[2] * y
    s = v[1] + w[2] * x - w[0] * z
    h = v[2] + w[0] * y - w[1] * x
    # The same velocity in map axes
    east = r[0] * u + r[1] * s + r[2] * h
    north = r[3] * u + r[4] * s + r[5] * h
    up = r[6] * u + r[7] * s + r[8] * h
    # d/dt depth = -up; the max keeps the floor from pulling
    normal = stiffness * max(0.0, depth - relaxation * up) if depth > 0.0 else 0.0
    grip = -friction * normal / math.sqrt(east * east + north * north + SLIP_SPEED * SLIP_SPEED)
    # Back to the body frame (transpose of R), where wrenches are summed
    f_x = r[0] * grip * east + r[3] * grip * north + r[6] * normal
    f_y = r[1] * grip * east + r[4] * grip * north + r[7] * normal
    f_z = r[2] * grip * east + r[5] * grip * north + r[8] * normal
    return (f_x, f_y, f_z, y * f_z - z * f_y, z * f_x - x * f_z, x * f_y - y * f_x)


_FLOOR_CONTACT_SOURCE = (
    'spread: a foam foot that yields by millimetres under a load of grams; not measured'
)
_FOOT_PLACE = 'spread: 5 mm for the position of the foot; limits: a hull of 5 m'

FLOOR_CONTACT = WrenchEffect(
    'floor_contact',
    (
        EffectParameter('stiffness', 'N/m', 0.0, 0.0, 1e4, 50.0, _FLOOR_CONTACT_SOURCE),
        EffectParameter('relaxation', 's', 0.0, 0.0, 10.0, 0.05, _FLOOR_CONTACT_SOURCE),
        EffectParameter('friction', '1', 0.0, 0.0, 3.0, 0.2, _FLOOR_CONTACT_SOURCE),
        *declare_each(('x', 'y', 'z'), 'm', 0.0, -5.0, 5.0, 0.005, _FOOT_PLACE),
    ),
    floor_contact,
    ('stiffness',),
)


NO_FLOOR = -1e6  # lower face of the vertical pair: the floor belongs to `floor_contact`


def walls(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Soft walls and ceiling of a room.

    The hull is a spheroid about the hull centre, half axes `radius` (twice) and `half_height`.
    Towards a face with the outward normal n (n_b in the body frame) it extends by

        s = sqrt(radius^2 (n_bx^2 + n_by^2) + half_height^2 n_bz^2)   at   c = diag n_b / s

    and with v the velocity of that point over the ground

        normal    P = stiffness max(0, d + relaxation d/dt d)   while d > 0, else 0;   force -n P
        friction  Q = -friction P v_t / sqrt(|v_t|^2 + v_s^2),   v_s = 0.05 m/s

    as in `floor_contact`, which is the lower face. The normal force never pulls, and a contact
    returns at most the energy stored in the spring. A soft wall yields by force / stiffness. Not
    modelled: parts below the hull, corners, rolling friction.
    """
    (
        x_low,
        x_high,
        y_low,
        y_high,
        ceiling,
        radius,
        half_height,
        stiffness,
        relaxation,
        friction,
    ) = p
    r, place = motion.rotation, motion.position
    hull = (radius * radius, radius * radius, half_height * half_height)
    soft = (stiffness, relaxation, friction)
    # Row i of R is the map axis i in the body frame, the normal of that pair of faces
    a = contact_wrench(x_low, x_high, place[0], (r[0], r[1], r[2]), hull, soft, motion)
    b = contact_wrench(y_low, y_high, place[1], (r[3], r[4], r[5]), hull, soft, motion)
    c = contact_wrench(NO_FLOOR, ceiling, place[2], (r[6], r[7], r[8]), hull, soft, motion)
    return (
        a[0] + b[0] + c[0],
        a[1] + b[1] + c[1],
        a[2] + b[2] + c[2],
        a[3] + b[3] + c[3],
        a[4] + b[4] + c[4],
        a[5] + b[5] + c[5],
    )


def contact_wrench(
    low: float,
    high: float,
    place: float,
    n: Vector,
    hull: Vector,
    soft: Vector,
    motion: VehicleMotion,
) -> Wrench:
    """Return the wrench of two opposite faces, of which the hull can touch one."""
    x, y, z = hull[0] * n[0], hull[1] * n[1], hull[2] * n[2]
    # Support function of the spheroid: how far it extends along n
    reach = math.sqrt(x * n[0] + y * n[1] + z * n[2])
    # Only the nearer face can touch, since the room is wider than the hull
    side = 1.0 if place - low > high - place else -1.0
    depth = reach - min(place - low, high - place)
    if depth <= 0.0 or reach <= 0.0:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    # Contact point of the spheroid, from the hull centre
    scale = side / reach
    x, y, z = x * scale, y * scale, z * scale
    v, w = motion.velocity, motion.rates
    # Velocity of the contact point, v + w x c
    u = v[0] + w[1] * z - w[2] * y
    s = v[1] + w[2] * x - w[0] * z
    h = v[2] + w[0] * y - w[1] * x
    into = u * n[0] + s * n[1] + h * n[2]
    # Kelvin-Voigt: spring plus damper, never pulling
    normal = soft[0] * max(0.0, depth + soft[1] * side * into)
    # Tangential part, for friction
    u, s, h = u - into * n[0], s - into * n[1], h - into * n[2]
    grip = -soft[2] * normal / math.sqrt(u * u + s * s + h * h + SLIP_SPEED * SLIP_SPEED)
    push = -side * normal
    f_x, f_y, f_z = push * n[0] + grip * u, push * n[1] + grip * s, push * n[2] + grip * h
    return (f_x, f_y, f_z, y * f_z - z * f_y, z * f_x - x * f_z, x * f_y - y * f_x)


def check_walls(values: Mapping[str, float]) -> str:
    """Return an objection to a hull that does not fit into the room."""
    # Without stiffness the effect is off, whatever the sizes
    if values['stiffness'] <= 0.0:
        return ''
    if values['radius'] <= 0.0 or values['half_height'] <= 0.0:
        return 'walls need the size of the hull; set radius and half_height, in metres'
    widest = 2.0 * max(values['radius'], values['half_height'])
    for axis in ('x', 'y'):
        if values[f'{axis}_high'] - values[f'{axis}_low'] <= widest:
            return (
                f'the hull does not fit into the room: {axis}_high minus {axis}_low must be '
                'larger than the hull'
            )
    if values['ceiling'] <= widest:
        return 'the hull does not fit into the room: ceiling must be higher than the hull'
    return ''


_ROOM = (
    'from the size of the room, which contains the origin of the map; spread: 5 cm; limit: a '
    'large hall'
)
_HULL_SIZE = (
    'from the shape of the hull; spread: 1 cm; limit: twice the 2.7 m of Skye (Burri 2013)'
)
_WALLS_SOURCE = (
    'spread: a foil envelope that yields by centimetres under a load of newtons; not measured'
)

WALLS = WrenchEffect(
    'walls',
    (
        EffectParameter('x_low', 'm', 0.0, -1e3, 0.0, 0.05, _ROOM),
        EffectParameter('x_high', 'm', 0.0, 0.0, 1e3, 0.05, _ROOM),
        EffectParameter('y_low', 'm', 0.0, -1e3, 0.0, 0.05, _ROOM),
        EffectParameter('y_high', 'm', 0.0, 0.0, 1e3, 0.05, _ROOM),
        EffectParameter('ceiling', 'm', 0.0, 0.1, 1e3, 0.05, _ROOM),
        *declare_each(('radius', 'half_height'), 'm', 0.0, 0.01, 2.7, 0.01, _HULL_SIZE),
        EffectParameter('stiffness', 'N/m', 0.0, 0.0, 1e4, 50.0, _WALLS_SOURCE),
        EffectParameter('relaxation', 's', 0.0, 0.0, 10.0, 0.05, _WALLS_SOURCE),
        EffectParameter('friction', '1', 0.0, 0.0, 3.0, 0.2, _WALLS_SOURCE),
    ),
    walls,
    linear_in=('stiffness',),
    placed=True,
    check=check_walls,
)


def ground_effect(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Additional thrust of a rotor close to the floor.

        f = gain x / (1 - x) |n_z| T,   x = (radius / 4 z)^2,   z >= radius / 2

    along the rotor's axis; T is its thrust, z its height above the floor z = 0 of the map, n_z the
    upward part of its axis. f acts only where the thrust lifts (n_z T > 0), since other jets miss
    the floor. `gain` 1 is Cheeseman and Bennett 1955 (ARC R&M 3021), a source in the disk and its
    image below the floor at equal power; below z = radius / 2 the force stays constant, T / 3.
    Several rotors close together gain more (Sanchez-Cuevas et al. 2017, doi 10.1155/2017/1823056).
    Not modelled: the fountain between rotors, the cushion under the hull, loss by forward flight.
    """
    gain, radius = p
    # Six numbers for each rotor: place and axis
    rotors = motion.body[ROTOR_PLACE:]
    forces = (
        ground_effect_extra_thrust(gain, radius, motion, rotors[0:6], thrust[0]),
        ground_effect_extra_thrust(gain, radius, motion, rotors[6:12], thrust[1]),
        ground_effect_extra_thrust(gain, radius, motion, rotors[12:18], thrust[2]),
        ground_effect_extra_thrust(gain, radius, motion, rotors[18:24], thrust[3]),
        ground_effect_extra_thrust(gain, radius, motion, rotors[24:30], thrust[4]),
        ground_effect_extra_thrust(gain, radius, motion, rotors[30:36], thrust[5]),
        ground_effect_extra_thrust(gain, radius, motion, rotors[36:42], thrust[6]),
        ground_effect_extra_thrust(gain, radius, motion, rotors[42:48], thrust[7]),
    )
    return sum_rotor_forces(rotors, forces)


def ground_effect_extra_thrust(
    gain: float, radius: float, motion: VehicleMotion, rotor: Values, thrust: float
) -> float:
    """Return the additional thrust of a rotor [N]."""
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


def rotor_height(motion: VehicleMotion, rotor: Values) -> float:
    """Return how high above the floor of the map a rotor is [m]."""
    r = motion.rotation
    return motion.position[2] + r[6] * rotor[0] + r[7] * rotor[1] + r[8] * rotor[2]


def rotor_upright(motion: VehicleMotion, rotor: Values) -> float:
    """Return the upward part of the axis of a rotor, 1 for one that lifts."""
    r = motion.rotation
    return r[6] * rotor[3] + r[7] * rotor[4] + r[8] * rotor[5]


def add_rotor_force(total: Wrench, rotor: Values, force: float) -> Wrench:
    """Return the sum with a force along the axis of a rotor added."""
    if force == 0.0:
        return total
    # rotor[3:6] is the unit axis, rotor[0:3] the place
    x, y, z = force * rotor[3], force * rotor[4], force * rotor[5]
    return (
        total[0] + x,
        total[1] + y,
        total[2] + z,
        total[3] + rotor[1] * z - rotor[2] * y,
        total[4] + rotor[2] * x - rotor[0] * z,
        total[5] + rotor[0] * y - rotor[1] * x,
    )


def sum_rotor_forces(rotors: Values, forces: Values) -> Wrench:
    """
    Return the wrench of eight forces along the axes of the rotors.

        (F, N) = sum of (f_i n_i, r_i x f_i n_i),   r_i the places, n_i the axes
    """
    total = add_rotor_force((0.0, 0.0, 0.0, 0.0, 0.0, 0.0), rotors[0:6], forces[0])
    total = add_rotor_force(total, rotors[6:12], forces[1])
    total = add_rotor_force(total, rotors[12:18], forces[2])
    total = add_rotor_force(total, rotors[18:24], forces[3])
    total = add_rotor_force(total, rotors[24:30], forces[4])
    total = add_rotor_force(total, rotors[30:36], forces[5])
    total = add_rotor_force(total, rotors[36:42], forces[6])
    return add_rotor_force(total, rotors[42:48], forces[7])


def check_ground_effect(values: Mapping[str, float]) -> str:
    """Return an objection to a ground effect without rotor size."""
    if values['gain'] > 0.0 and values['radius'] <= 0.0:
        return 'the ground effect needs the size of the rotors; set radius, in metres'
    return ''


_GROUND_EFFECT_GAIN = (
    '1: the model of Cheeseman and Bennett 1955, around which small rotors scatter; spread: '
    '0.5 (assumed)'
)
_RADIUS = 'radius of the propeller, 23.5 mm for propellers of 47 mm; spread: 1 mm'

GROUND_EFFECT = WrenchEffect(
    'ground_effect',
    (
        EffectParameter('gain', '1', 0.0, 0.0, 5.0, 0.5, _GROUND_EFFECT_GAIN),
        EffectParameter('radius', 'm', 0.0, 0.005, 1.0, 0.001, _RADIUS, beside=0.0225),
    ),
    ground_effect,
    linear_in=('gain',),
    placed=True,
    check=check_ground_effect,
)


def ceiling_effect(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Additional thrust of a rotor below a ceiling.

        f = gain (sqrt(1 + radius^2 / (8 d^2)) - 1) / 2 |n_z| T,   d = height - z >= radius / 4

    along the rotor's axis; T is its thrust, d its distance to the ceiling at `height` in the map,
    n_z the upward part of its axis. f acts only where the thrust lifts (n_z T > 0). `gain` 1 is
    the momentum theory of Hsiao and Chirarattananon 2019 (arXiv:1905.04632; formula as in public
    flight code for a rotor of 23 mm, the paper itself not read), validated with rotors of 23 and
    50 mm. Below a quarter of the radius f stays constant, 0.37 T. For rotors with free air above
    them: use no gain for rotors under a hull.
    """
    gain, radius, height = p
    # Six numbers for each rotor: place and axis
    rotors = motion.body[ROTOR_PLACE:]
    forces = (
        ceiling_effect_extra_thrust(gain, radius, height, motion, rotors[0:6], thrust[0]),
        ceiling_effect_extra_thrust(gain, radius, height, motion, rotors[6:12], thrust[1]),
        ceiling_effect_extra_thrust(gain, radius, height, motion, rotors[12:18], thrust[2]),
        ceiling_effect_extra_thrust(gain, radius, height, motion, rotors[18:24], thrust[3]),
        ceiling_effect_extra_thrust(gain, radius, height, motion, rotors[24:30], thrust[4]),
        ceiling_effect_extra_thrust(gain, radius, height, motion, rotors[30:36], thrust[5]),
        ceiling_effect_extra_thrust(gain, radius, height, motion, rotors[36:42], thrust[6]),
        ceiling_effect_extra_thrust(gain, radius, height, motion, rotors[42:48], thrust[7]),
    )
    return sum_rotor_forces(rotors, forces)


def ceiling_effect_extra_thrust(
    gain: float, radius: float, ceiling: float, motion: VehicleMotion, rotor: Values, thrust: float
) -> float:
    """Return the additional thrust of a rotor [N]."""
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


def check_ceiling_effect(values: Mapping[str, float]) -> str:
    """Return an objection to a ceiling effect without rotor size or ceiling."""
    if values['gain'] > 0.0 and values['radius'] <= 0.0:
        return 'the ceiling effect needs the size of the rotors; set radius, in metres'
    if values['gain'] > 0.0 and values['height'] <= 0.0:
        return 'the ceiling effect needs the height of the ceiling; set height, in metres'
    return ''


_CEILING_EFFECT_GAIN = '1: the model of Hsiao and Chirarattananon 2019; spread: 0.5 (assumed)'
_ROOM_HEIGHT = 'height of the room; spread: 5 cm'

CEILING_EFFECT = WrenchEffect(
    'ceiling_effect',
    (
        EffectParameter('gain', '1', 0.0, 0.0, 5.0, 0.5, _CEILING_EFFECT_GAIN),
        EffectParameter('radius', 'm', 0.0, 0.005, 1.0, 0.001, _RADIUS),
        EffectParameter('height', 'm', 0.0, 0.1, 100.0, 0.05, _ROOM_HEIGHT),
    ),
    ceiling_effect,
    linear_in=('gain',),
    placed=True,
    check=check_ceiling_effect,
)

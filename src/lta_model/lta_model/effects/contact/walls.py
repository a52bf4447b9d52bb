"""
Soft walls and ceiling of a room.

The hull is a spheroid about the hull centre, half axes `radius` (twice) and `half_height`. Towards
a face with the outward normal n (n_b in the body frame) it extends by

    s = sqrt(radius^2 (n_bx^2 + n_by^2) + half_height^2 n_bz^2)   at   c = diag n_b / s

and with v the velocity of that point over the ground

    normal    P = stiffness max(0, d + relaxation d/dt d)   while d > 0, else 0;   force -n P
    friction  Q = -friction P v_t / sqrt(|v_t|^2 + v_s^2),   v_s = 0.05 m/s

as in `floor_contact`, which is the lower face. The normal force never pulls, and a contact returns
at most the energy stored in the spring. A soft wall yields by force / stiffness. Not modelled:
parts below the hull, corners, rolling friction.
"""

from collections.abc import Mapping
import math

from lta_model.effects.protocol import (
    EffectParameter,
    Values,
    Vector,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)

_ROOM = (
    'from the size of the room, which contains the origin of the map; spread: 5 cm; limit: a '
    'large hall'
)
_HULL = 'from the shape of the hull; spread: 1 cm; limit: twice the 2.7 m of Skye (Burri 2013)'
_SOURCE = (
    'spread: a foil envelope that yields by centimetres under a load of newtons; not measured'
)

PARAMETERS = (
    EffectParameter('x_low', 'm', 0.0, -1e3, 0.0, 0.05, _ROOM),
    EffectParameter('x_high', 'm', 0.0, 0.0, 1e3, 0.05, _ROOM),
    EffectParameter('y_low', 'm', 0.0, -1e3, 0.0, 0.05, _ROOM),
    EffectParameter('y_high', 'm', 0.0, 0.0, 1e3, 0.05, _ROOM),
    EffectParameter('ceiling', 'm', 0.0, 0.1, 1e3, 0.05, _ROOM),
    EffectParameter('radius', 'm', 0.0, 0.01, 2.7, 0.01, _HULL),
    EffectParameter('half_height', 'm', 0.0, 0.01, 2.7, 0.01, _HULL),
    EffectParameter('stiffness', 'N/m', 0.0, 0.0, 1e4, 50.0, _SOURCE),
    EffectParameter('relaxation', 's', 0.0, 0.0, 10.0, 0.05, _SOURCE),
    EffectParameter('friction', '1', 0.0, 0.0, 3.0, 0.2, _SOURCE),
)

# m/s; below it friction grows linearly with the speed
SLIP_SPEED = 0.05
BELOW = -1e6  # lower face of the vertical pair: the floor belongs to `floor_contact`


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


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the wrench of the room on the hull."""
    (
        x_low, x_high, y_low, y_high, ceiling,
        radius, half_height, stiffness, relaxation, friction,
    ) = p  # fmt: skip
    r, place = motion.rotation, motion.position
    hull = (radius * radius, radius * radius, half_height * half_height)
    soft = (stiffness, relaxation, friction)
    # Row i of R is the map axis i in the body frame, the normal of that pair of faces
    a = contact_wrench(x_low, x_high, place[0], (r[0], r[1], r[2]), hull, soft, motion)
    b = contact_wrench(y_low, y_high, place[1], (r[3], r[4], r[5]), hull, soft, motion)
    c = contact_wrench(BELOW, ceiling, place[2], (r[6], r[7], r[8]), hull, soft, motion)
    return (
        a[0] + b[0] + c[0],
        a[1] + b[1] + c[1],
        a[2] + b[2] + c[2],
        a[3] + b[3] + c[3],
        a[4] + b[4] + c[4],
        a[5] + b[5] + c[5],
    )


def find_conflict(values: Mapping[str, float]) -> str:
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


EFFECT = WrenchEffect(
    'walls', PARAMETERS, compute_wrench, linear_in=('stiffness',), placed=True, check=find_conflict
)

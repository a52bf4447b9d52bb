"""
Where the rotors are and what a thrust along each axis adds up to, for effects on single rotors.

    (F, N) = sum of (f_i n_i, r_i x f_i n_i)

r_i is the place of rotor i in the body frame and n_i the direction of its thrust, as in the layout
of `lta_sim.state`.
"""

from lta_sim.effects.protocol import Motion, Values, Wrench
from lta_sim.state import ROTOR, ROTOR_AXIS, ROTOR_PLACE


def rotor_height(motion: Motion, i: int) -> float:
    """Return how high above the floor of the map rotor i is. [m]"""
    k, r, body = ROTOR_PLACE + ROTOR * i, motion.rotation, motion.body
    return motion.position[2] + r[6] * body[k] + r[7] * body[k + 1] + r[8] * body[k + 2]


def rotor_upright(motion: Motion, i: int) -> float:
    """Return the upward part of the axis of rotor i, 1 for a rotor that lifts."""
    k, r, body = ROTOR_AXIS + ROTOR * i, motion.rotation, motion.body
    return r[6] * body[k] + r[7] * body[k + 1] + r[8] * body[k + 2]


def plus(total: Wrench, body: Values, i: int, force: float) -> Wrench:
    """Return the sum with a force along the axis of rotor i added."""
    k, n = ROTOR_PLACE + ROTOR * i, ROTOR_AXIS + ROTOR * i
    x, y, z = force * body[n], force * body[n + 1], force * body[n + 2]
    return (
        total[0] + x,
        total[1] + y,
        total[2] + z,
        total[3] + body[k + 1] * z - body[k + 2] * y,
        total[4] + body[k + 2] * x - body[k] * z,
        total[5] + body[k] * y - body[k + 1] * x,
    )


def added(body: Values, extra: Values) -> Wrench:
    """Return the wrench of eight forces along the axes of the rotors."""
    total = plus((0.0, 0.0, 0.0, 0.0, 0.0, 0.0), body, 0, extra[0])
    total = plus(total, body, 1, extra[1])
    total = plus(total, body, 2, extra[2])
    total = plus(total, body, 3, extra[3])
    total = plus(total, body, 4, extra[4])
    total = plus(total, body, 5, extra[5])
    total = plus(total, body, 6, extra[6])
    return plus(total, body, 7, extra[7])

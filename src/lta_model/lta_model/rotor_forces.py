"""
Compute rotor heights and the sum of forces along rotor axes, for effects on rotors.

    (F, N) = sum of (f_i n_i, r_i x f_i n_i)

r_i is the place of rotor i in the body frame and n_i the direction of its thrust; `rotor` holds
both, and `rotors` those of all, as in the layout of `lta_model.state`.
"""

from lta_model.effects.protocol import Values, VehicleMotion, Wrench


def rotor_height(motion: VehicleMotion, rotor: Values) -> float:
    """Return how high above the floor of the map a rotor is. [m]"""
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
    """Return the wrench of eight forces along the axes of the rotors."""
    total = add_rotor_force((0.0, 0.0, 0.0, 0.0, 0.0, 0.0), rotors[0:6], forces[0])
    total = add_rotor_force(total, rotors[6:12], forces[1])
    total = add_rotor_force(total, rotors[12:18], forces[2])
    total = add_rotor_force(total, rotors[18:24], forces[3])
    total = add_rotor_force(total, rotors[24:30], forces[4])
    total = add_rotor_force(total, rotors[30:36], forces[5])
    total = add_rotor_force(total, rotors[36:42], forces[6])
    return add_rotor_force(total, rotors[42:48], forces[7])

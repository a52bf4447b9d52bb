"""Compute the duty at which the rotors carry the weight that the gas does not."""

from lta_config.errors import BadInput
from lta_config.schema.vehicle_aero import RotorCoupling
from lta_model.propulsion import RotorModel

HEAVE = 2
LIFTS = 0.5  # newtons upwards per newton of thrust that make a rotor one that lifts


def select_lifting_rotors(
    rotors: tuple[RotorModel, ...], coupling: RotorCoupling | None
) -> tuple[list[RotorModel], float]:
    """
    Return the lifting rotors, run alike, and their lift per newton of each.

    Rotors whose own column points up (or, reversed, does); if there are none, those that lift
    together by colliding jets.
    """
    own = []
    total = 0.0
    for rotor in rotors:
        # A reversible rotor may lift with either direction
        up = max(rotor.column[HEAVE], -rotor.reverse[HEAVE] if rotor.reversible else 0.0)
        if up > LIFTS:
            own.append(rotor)
            total += up
    if own or coupling is None:
        return own, total
    together = [rotor for rotor in rotors if rotor.name in coupling.rotors]
    for rotor in together:
        # The column for reversed thrust is per newton of negative thrust
        total += -rotor.reverse[HEAVE] if coupling.reversed else rotor.column[HEAVE]
    return together, total + coupling.force.vector[HEAVE]


def hover_duty(
    name: str,
    rotors: tuple[RotorModel, ...],
    coupling: RotorCoupling | None,
    weight: float,
    gravity: float,
) -> float:
    """
    Return the largest duty among the rotors that carry a weight, all with the same thrust. [1]

    `weight` is less buoyancy [N], nothing to carry if not positive; `gravity` [m/s2] is for the
    message.

    Raise `BadInput` if nothing lifts, or not enough.
    """
    if weight <= 0.0:
        return 0.0
    own, per_newton = select_lifting_rotors(rotors, coupling)
    if not own or per_newton <= 0.0:
        raise BadInput(
            f'{name} has no rotor that pushes upwards, so it cannot hover; in the '
            'vehicle file, change the axis of a rotor.'
        )
    # The weakest rotor limits, since all run alike
    thrust, full = weight / per_newton, min(rotor.full_thrust for rotor in own)
    if thrust > full:
        raise BadInput(
            f'{name} needs {thrust:.3f} N from each lifting rotor to hover, but a rotor '
            f'has at most {full:.3f} N; make the vehicle at least '
            f'{1e3 * (thrust - full) * per_newton / gravity:.1f} g lighter.'
        )
    return max(rotor.duty_for_thrust(thrust) for rotor in own)

"""Which rotor of the vehicle each motor of the Crazyflie turns."""

from collections.abc import Mapping, Sequence

from lta_config.errors import BadInput


def find_rotor_indices(motors: Mapping[str, str], names: Sequence[str]) -> tuple[int, ...]:
    """
    Return for M1 to M4 the place of its rotor among the vehicle's.

    Raises
    ------
    BadInput
        If a motor is wired to a rotor that the vehicle does not have.

    """
    for motor, rotor in motors.items():
        if rotor not in names:
            raise BadInput(
                f'Motor {motor} is wired to {rotor}, which the vehicle lacks; it has '
                f'{", ".join(names)}.'
            )
    return tuple(names.index(rotor) for rotor in motors.values())

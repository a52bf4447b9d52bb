"""Map the motors of the Crazyflie to the rotors of the vehicle."""

from collections.abc import Mapping, Sequence

from lta_config.errors import BadInput


def find_rotor_indices(motors: Mapping[str, str], names: Sequence[str]) -> tuple[int, ...]:
    """
    Return the index of the rotor of each motor, M1 to M4.

    Raises
    ------
    BadInput
        If a motor is wired to a rotor that the vehicle does not have.

    """
    for motor, rotor in motors.items():
        if rotor not in names:
            raise BadInput(
                f'The Crazyflie file assigns motor {motor} to the rotor {rotor}, which the '
                f'vehicle does not have; choose one of {", ".join(names)}.'
            )
    return tuple(names.index(rotor) for rotor in motors.values())

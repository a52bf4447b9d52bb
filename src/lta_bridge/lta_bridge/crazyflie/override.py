"""
Checks for the motor override, `motorPowerSet`, which bypasses the firmware's safety functions.

Only the override can turn single motors of stock firmware. It is for a tethered drone only: the
bridge's own state machine still applies, but the firmware's watchdog, lock and disarming do not.
"""

from collections.abc import Mapping

from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import CrazyflieFile, ExpectedParameter
from lta_model.vehicle import Vehicle

OVERRIDE = 'override'
# Parameters of firmware/crazyflie, unused by the override
APP_PARAMETERS = ('lta.', 'stabilizer.controller')


def check_tether(command: str, tethered: bool) -> None:
    """
    Check that the override is used on a tethered drone only.

    Raises
    ------
    BadInput
        If it is used on another drone.

    """
    if command == OVERRIDE and not tethered:
        raise BadInput(
            "command:=override bypasses the firmware's watchdog, lock and disarming, and so needs "
            'a tethered drone; tether the drone to a bench and add tethered:=true, or fly with '
            'command:=motors.'
        )


def select_expected_parameters(
    file: CrazyflieFile, command: str
) -> Mapping[str, ExpectedParameter]:
    """Return the expected parameters for a command mode."""
    if command != OVERRIDE:
        return file.expected
    return {
        name: want for name, want in file.expected.items() if not name.startswith(APP_PARAMETERS)
    }


def required_compensation(vehicle: Vehicle, command: str) -> bool | None:
    """Return whether the firmware must compensate the battery voltage; None for the override."""
    return None if command == OVERRIDE else vehicle.battery_compensated

"""
The bench's way past the firmware: `motorPowerSet`, which no watchdog, lock or disarming ends.

It turns the motors of stock firmware, one by one, which nothing else does. It is for a tethered
drone alone: our state machine decides as ever, but what only the drone can do, it then does not.
"""

from collections.abc import Mapping

from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import CrazyflieFile, ExpectedParameter
from lta_model.vehicle import Vehicle

OVERRIDE = 'override'
APP = ('lta.', 'stabilizer.controller')  # of firmware/crazyflie, which the override does without


def check_tether(command: str, tethered: bool) -> None:
    """
    Refuse to turn motors past the firmware where nobody has said that the drone is tethered.

    Raises
    ------
    BadInput
        With what it takes.

    """
    if command == OVERRIDE and not tethered:
        raise BadInput(
            "command:=override turns motors past the firmware's watchdog, lock and disarming; "
            'tether the drone to a bench and add tethered:=true, or fly with command:=motors.'
        )


def select_parameters(file: CrazyflieFile, command: str) -> Mapping[str, ExpectedParameter]:
    """Return the parameters that a way to command it needs."""
    if command != OVERRIDE:
        return file.expected
    return {name: want for name, want in file.expected.items() if not name.startswith(APP)}


def required_compensation(vehicle: Vehicle, command: str) -> bool | None:
    """Return whether duties must be corrected aboard; None by a way that goes past that."""
    return None if command == OVERRIDE else vehicle.battery_compensated

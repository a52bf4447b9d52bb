"""Run the vehicle's control law instead of the firmware's controller, on the true state."""

from typing import Any, final

from lta_config.errors import BadInput
from lta_control.allocation import create_working_array
from lta_control.cascade import Setpoint
from lta_control.gains_file import load_law_gains
from lta_control.laws import find_control_law
from lta_control.laws.protocol import ControlMotion, LawInputs
from lta_model.vehicle import Vehicle


@final
class VehicleLaw:
    """
    A control law with its state.

    Parameters
    ----------
    vehicle : Vehicle
        Its file defines law and gains.

    Raises
    ------
    BadInput
        If it defines none.

    """

    def __init__(self, vehicle: Vehicle) -> None:
        control = vehicle.file.control
        if control is None or control.gains is None:
            raise BadInput(
                f'The vehicle {vehicle.file.name} has no control law with gains; add a "control" '
                'block to its file, or use command:=motors.'
            )
        self._law = find_control_law(control.law)
        self._constants = self._law.build_constants(
            load_law_gains(self._law.gains, control.gains), vehicle
        )
        self._memory: Any = self._law.start
        # Work arrays of the allocation, created once
        self._scratch = create_working_array()

    def step(self, motion: ControlMotion, setpoint: Setpoint, dt: float) -> tuple[float, ...]:
        """Return the duties by slot after one more period. [s]"""
        inputs = LawInputs(motion, setpoint, dt)
        self._memory = self._law.step(self._constants, self._memory, inputs, self._scratch)
        duties: tuple[float, ...] = self._memory.command.duties
        return duties

    def reset(self) -> None:
        """Reset the integrators."""
        self._memory = self._law.start

"""Run a control law on board, as the controller node calls it, on the drone's own sensors."""

from typing import Any, final

from lta_config.errors import BadInput
from lta_control.allocation import create_working_array
from lta_control.cascade import Setpoint
from lta_control.gains_file import load_law_gains
from lta_control.laws import find_control_law
from lta_control.laws.protocol import ControlMotion, Feedback, LawCommand, LawInputs
from lta_model.vehicle import Vehicle

CASCADE = 'cascade'


def vehicle_law_name(vehicle: Vehicle) -> str:
    """Return the law in the vehicle's file; the cascade if there is none."""
    return vehicle.file.control.law if vehicle.file.control else CASCADE


def check_onboard_law(vehicle: Vehicle) -> None:
    """Raise `BadInput` if a vehicle's law cannot run on onboard sensors; see `OnboardLaw`."""
    if (name := vehicle_law_name(vehicle)) != CASCADE:
        OnboardLaw(name, vehicle)


@final
class OnboardLaw:
    """
    Step a control law and keep its memory.

    The gains are those of the vehicle's file.

    Raise `BadInput` if there is no such law, it needs a tracker, or it cannot fly the vehicle.
    """

    def __init__(self, name: str, vehicle: Vehicle) -> None:
        self._law = find_control_law(name)
        if self._law.feedback is Feedback.TRACKER:
            raise BadInput(
                f'{vehicle.file.name} uses the control law {name}, which needs a position '
                'tracker, but the controller has only onboard sensors; fly the vehicle '
                'with "lta platforms", or choose another control law.'
            )
        control = vehicle.file.control
        if control is None or control.gains is None:
            raise BadInput(
                f'{vehicle.file.name} names no gains for the control law {name}; add '
                '"gains: NAME" to the control block of the vehicle file.'
            )
        gains = load_law_gains(self._law.gains, control.gains)
        self._constants = self._law.build_constants(gains, vehicle)
        self._memory: Any = self._law.start
        self._scratch = create_working_array()

    def step(self, motion: ControlMotion, setpoint: Setpoint, dt: float) -> LawCommand:
        """Return the command after one more period of `dt`. [s]"""
        inputs = LawInputs(motion, setpoint, dt)
        self._memory = self._law.step(self._constants, self._memory, inputs, self._scratch)
        command: LawCommand = self._memory.command
        return command

    def reset(self) -> None:
        """Reset the integrals."""
        self._memory = self._law.start

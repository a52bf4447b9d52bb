"""A control law aboard a vehicle, as the controller node calls it: by the drone's own sensors."""

from typing import Any, final

from lta_config.errors import BadInput
from lta_control.allocation import new_scratch
from lta_control.cascade import Setpoint
from lta_control.gains_file import load_gains_of
from lta_control.laws import law
from lta_control.laws.protocol import Command, Feedback, Heard, Motion
from lta_model.vehicle import Vehicle

CASCADE = 'cascade'


def law_named(vehicle: Vehicle) -> str:
    """Return the law that a vehicle's file names; the cascade where it names none."""
    return vehicle.file.control.law if vehicle.file.control else CASCADE


def check_aboard(vehicle: Vehicle) -> None:
    """Refuse a vehicle whose own law cannot fly it by the drone's own sensors; see `Aboard`."""
    if (name := law_named(vehicle)) != CASCADE:
        Aboard(name, vehicle)


@final
class Aboard:
    """
    Step a law, memory kept.

    Parameters
    ----------
    name : str
        Of the law.
    vehicle : Vehicle
        Its gains are those that the vehicle's file names.

    Raises
    ------
    BadInput
        If there is no such law, it needs a tracker, or it cannot fly the vehicle.

    """

    def __init__(self, name: str, vehicle: Vehicle) -> None:
        self._law = law(name)
        if self._law.feedback is Feedback.TRACKER:
            raise BadInput(
                f'{vehicle.file.name} flies by the law {name}, which needs a tracker, and the '
                'controller has the drone\'s own sensors alone; compare it with "lta platforms", '
                'or name another law.'
            )
        control = vehicle.file.control
        if control is None or control.gains is None:
            raise BadInput(
                f'{vehicle.file.name} names no gains for the law {name}; add "gains: ..." to its '
                'control block.'
            )
        gains = load_gains_of(self._law.gains, control.gains)
        self._known = self._law.known(gains, vehicle)
        self._memory: Any = self._law.start
        self._scratch = new_scratch()

    def step(self, motion: Motion, setpoint: Setpoint, dt: float) -> Command:
        """Return the command after one more period. [s]"""
        heard = Heard(motion, setpoint, dt)
        self._memory = self._law.step(self._known, self._memory, heard, self._scratch)
        command: Command = self._memory.command
        return command

    def forget(self) -> None:
        """Forget what the loops had wound up."""
        self._memory = self._law.start

"""
Keep a link up from a thread of its own: connect, check, wait for the loss, and again.

Opening and closing block, so they never happen in a callback of the node. Each failure is told
once and followed by a pause that doubles.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
import threading
from typing import Final, final

from lta_bridge.crazyflie.link import CrazyflieLink, LinkFailed
from lta_bridge.crazyflie.remedies import suggest_remedy
from lta_config.schema.crazyflie_file import ExpectedParameter

DEADLINE: Final = 8.0  # s for one attempt; a TOC of 700 entries over the radio takes about five
CONFIRM: Final = 2.0  # s for one parameter
TURNING: Final = ('motorPowerSet.enable', 'powerDist.idleThrust')  # without any command
FIRST, LONGEST = 0.5, 8.0  # s of pause after a failure


def apply_parameters(
    link: CrazyflieLink, expected: Mapping[str, ExpectedParameter], compensated: bool | None = None
) -> None:
    """
    Bring parameters to what the vehicle needs.

    What turns motors without a command is switched off first, on a drone that is then refused as
    well. Nothing else is written to one that is refused.

    Parameters
    ----------
    link : Link
        Open.
    expected : mapping
        Parameters by name.
    compensated : bool or None
        Whether the vehicle counts on firmware that corrects duties for the battery's voltage;
        None where that does not matter.

    Raises
    ------
    LinkFailed
        If one is missing, or differs and may not or cannot be written; or if the firmware corrects
        duties and the vehicle does not count on it, or the other way round.

    """
    for name in TURNING:
        if link.read_parameter(name):
            link.write_parameter(name, 0.0, CONFIRM)
    for name, want in expected.items():
        value = link.read_parameter(name)
        if value is None:
            raise LinkFailed(f'the firmware has no parameter {name} ({want.why})')
        if value != want.value and not want.write:
            raise LinkFailed(f'{name} is {value:g}, not {want.value:g} ({want.why})')
    if compensated is not None and (
        why := explain_mismatch(has_voltage_compensation(link), compensated)
    ):
        raise LinkFailed(why)
    for name, want in expected.items():
        if link.read_parameter(name) != want.value:
            link.write_parameter(name, want.value, CONFIRM)


def has_voltage_compensation(link: CrazyflieLink) -> bool:
    """Tell whether the firmware corrects duties for the battery's voltage; stock firmware does."""
    return link.read_parameter('lta.compensated') != 0.0


def explain_mismatch(firmware: bool, vehicle: bool) -> str:
    """Return why a drone that compensates, or not, cannot fly a vehicle; empty where it can."""
    if firmware and not vehicle:
        return (
            "the firmware corrects duties for the battery's voltage, and the vehicle file has no "
            'effect battery_compensation: flash the build of firmware/crazyflie, or add the '
            'effect to the vehicle file'
        )
    if vehicle and not firmware:
        return (
            'the firmware takes duties as they are, and the vehicle file has the effect '
            'battery_compensation: flash stock firmware, or remove the effect from the vehicle '
            'file'
        )
    return ''


@final
class ConnectionManager:
    """
    Hold one link open until told to let go.

    Parameters
    ----------
    link : Link
        Opened and closed from here alone.
    expected : mapping
        Parameters by name.
    given_back : callable
        Called, from the thread, when the link is closed for good.
    compensated : bool or None
        As for `apply_parameters`.

    Attributes
    ----------
    up : bool
        Whether the link is open and its parameters are as expected.
    why : str
        Why it is not.
    attempts : int
        How often it was tried.

    """

    def __init__(
        self,
        link: CrazyflieLink,
        expected: Mapping[str, ExpectedParameter],
        on_closed: Callable[[], None] = lambda: None,
        compensated: bool | None = None,
    ) -> None:
        self._link, self._expected, self._given_back = link, expected, on_closed
        self._compensated = compensated
        self.up, self.why, self.attempts = False, 'connecting', 0
        self._leave = threading.Event()
        self._again = threading.Event()
        self._thread = threading.Thread(target=self._run, name='crazyflie_link', daemon=True)
        self._thread.start()

    def reconnect(self, why: str) -> None:
        """Give this connection up and make a new one."""
        self.up, self.why = False, why
        self._again.set()

    def close(self, deadline: float = 5.0) -> bool:
        """Let go; return whether that was done within a deadline. [s]"""
        self.up = False
        self._leave.set()
        self._again.set()
        self._thread.join(deadline)
        return not self._thread.is_alive()

    def _run(self) -> None:
        pause = FIRST
        while not self._leave.is_set():
            self._again.clear()
            self.attempts += 1
            failed = self._hold_connection()
            self.up = False
            with suppress(Exception):  # whatever a dongle says that was pulled out
                self._link.close()
            if not failed:
                pause = FIRST
                continue
            self.why = failed
            self._leave.wait(pause)
            pause = min(2.0 * pause, LONGEST)
        self._given_back()

    def _hold_connection(self) -> str:
        """Connect, and hold it until told otherwise; return why it did not come up, if so."""
        try:
            self._link.open(DEADLINE)
            if not self._leave.is_set():
                apply_parameters(self._link, self._expected, self._compensated)
        except LinkFailed as error:
            return str(error)
        except Exception as error:  # a driver's own: without this thread there is no other try
            return suggest_remedy(f'{type(error).__name__}: {error}')
        if not (self._again.is_set() or self._leave.is_set()):
            self.up, self.why = True, ''
            self._again.wait()
        return ''

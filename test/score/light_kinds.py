"""
Faults on the link of the light board, and the time within which the bridge must report them.

No motor turns here: without light, the pilot or navigator lands the drone
(`test/integration/test_hardware_flight.py` unplugs the cable in flight). The bridge must not
publish wrong light, must report the loss, and must publish light again after the repair.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from lta_emulation.teensy.emulated_board import EmulatedBoard, FrameFaults

EVERY: Final = 10  # one of so many light frames is disturbed
TOLD: Final = 1.5  # s: half a second of silence, and health is reported each second
AGAIN: Final = 3.0  # s: a second between two port scans, and the clock is synchronised again
SOUND: Final = FrameFaults()
DRIFT: Final = 200e-6  # relative error of its clock, fast


@dataclass(frozen=True, slots=True)
class LightKind:
    """One kind of fault."""

    about: str  # label in the table
    word: str = ''  # part of the bridge's message; empty if the light continues
    # Inject the fault into a `LightTrial`, and remove it
    strike: Callable[[Any], object] = lambda trial: None
    cure: Callable[[Any], object] = lambda trial: None
    spoilt: FrameFaults = SOUND  # disturbance of the frames meanwhile
    figure: str = ''  # the bridge's counter of exactly the disturbed frames; empty for none
    drift: float = 0.0  # relative error of the board's clock, fast


def hushed(silent: bool) -> Callable[[Any], None]:
    """Return a function that silences the board, or ends the silence."""
    return lambda trial: setattr(trial.server, 'silent', silent)


def another(**board: int) -> Callable[[Any], None]:
    """Return a function that connects another board, or the same after a restart."""

    def strike(trial: Any) -> None:
        trial.server.board = EmulatedBoard(trial.server.now_ns, **board)

    return strike


LIGHT_KINDS: Final = {
    'light unplugged': LightKind(
        'cable unplugged and plugged in again', 'plug the light board in',
        lambda trial: trial.server.toggle_cable(), lambda trial: trial.server.toggle_cable(),
    ),
    'light silent': LightKind('board sends nothing', 'no data from the light board',
                              hushed(True), hushed(False)),
    'light dialect': LightKind('board with another protocol dialect', 'uses version 2',
                               another(dialect=2), another()),
    'light restart': LightKind('board restarts, its clock at 0', strike=another()),
    'light drift': LightKind('clock of the board 200 ppm fast', drift=DRIFT),
    'light lost': LightKind('every tenth frame lost', spoilt=FrameFaults(drop=EVERY)),
    'light partial': LightKind('every tenth frame truncated to a third',
                               spoilt=FrameFaults(cut=EVERY)),
    'light CRC': LightKind('one bit of every tenth frame flipped',
                           spoilt=FrameFaults(corrupt=EVERY), figure='crc_errors'),
    'light foreign': LightKind('every tenth frame followed by an unknown message',
                               spoilt=FrameFaults(foreign=EVERY), figure='unknown'),
}  # fmt: skip

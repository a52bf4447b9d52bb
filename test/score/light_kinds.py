"""
What goes wrong on the link of the light board, and how soon the bridge must say so.

Nothing here turns a motor: a drone without light is brought down by whoever commands it
(`test/integration/test_hardware_flight.py` pulls the cable in flight). What must be true is that
no wrong light is published, that the loss is told, and that light comes again.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from lta_emulation.teensy.emulated_board import EmulatedBoard, FrameFaults

EVERY: Final = 10  # frames of light, of which one is spoilt
TOLD: Final = 1.5  # s: half a second of silence, and health is told each second
AGAIN: Final = 3.0  # s: a second between two looks for a port, and its clock is learnt anew
SOUND: Final = FrameFaults()
DRIFT: Final = 200e-6  # part by which its clock is too fast


@dataclass(frozen=True, slots=True)
class LightKind:
    """
    One kind of fault.

    Attributes
    ----------
    about : str
        In the words of the table.
    word : str
        What the bridge says of it; empty where light goes on.
    strike, cure : callable
        Does it, and takes it away, to a `LightTrial`.
    spoilt : FrameFaults
        What happens to frames meanwhile.
    figure : str
        Which figure of the bridge counts just the frames that were spoilt; empty for none.
    drift : float
        Part by which the board's clock is too fast.

    """

    about: str
    word: str = ''
    strike: Callable[[Any], object] = lambda trial: None
    cure: Callable[[Any], object] = lambda trial: None
    spoilt: FrameFaults = SOUND
    figure: str = ''
    drift: float = 0.0


def hushed(silent: bool) -> Callable[[Any], None]:
    """Return what lets the board say nothing, or speak again."""
    return lambda trial: setattr(trial.server, 'silent', silent)


def another(**board: int) -> Callable[[Any], None]:
    """Return what puts another board, or the same after a restart, on the cable."""

    def strike(trial: Any) -> None:
        trial.server.board = EmulatedBoard(trial.server.now_ns, **board)

    return strike


LIGHT_KINDS: Final = {
    'light unplugged': LightKind(
        'the cable is pulled, and put back', 'plug the light board in',
        lambda trial: trial.server.toggle_cable(), lambda trial: trial.server.toggle_cable(),
    ),
    'light silent': LightKind('the board says nothing', 'silent for', hushed(True),
                              hushed(False)),
    'light dialect': LightKind('a board of another dialect', 'uses version 2',
                               another(dialect=2), another()),
    'light restart': LightKind('the board starts anew, its clock at 0', strike=another()),
    'light drift': LightKind('its clock is 200 ppm fast', drift=DRIFT),
    'light lost': LightKind('every tenth frame is lost', spoilt=FrameFaults(drop=EVERY)),
    'light partial': LightKind('every tenth frame ends after a third',
                               spoilt=FrameFaults(cut=EVERY)),
    'light CRC': LightKind('one bit of every tenth frame is wrong',
                           spoilt=FrameFaults(corrupt=EVERY), figure='crc_errors'),
    'light foreign': LightKind('every tenth frame is followed by an unknown message',
                               spoilt=FrameFaults(foreign=EVERY), figure='unknown'),
}  # fmt: skip

"""
What goes wrong in flight, and within what time the motors must then stand.

A time is stated for each way to command the drone. By duties its app stops the motors after 200 ms
without any, and a landing is half a second of ramp. By setpoints the firmware flies on level for
2 s and then locks, and a landing comes down at 0.3 m/s from wherever it was.
"""

from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any, Final

from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_emulation.crazyflie.simulated_body import SimulatedBody

ALONE: Final = 'the drone stops by itself: the app, or the lock after 2 s'
WRAP_MS: Final = 2**24  # of the stamps of log packets
AT_ONCE: Final = (0.2, 0.2)
CUT_OFF: Final = (0.3, 2.1)  # nobody tells the drone anything: its own stop
LANDS: Final = (0.7, 5.5)  # told at once
LOW: Final = (1.1, 5.9)  # told after 0.3 s of it, and after the 0.1 s between two voltages
STALE: Final = (1.1, 5.9)  # told after 0.3 s, and after what a setpoint may be late
SILENT: Final = (1.3, 6.0)  # told after half a second of silence
LATE: Final = (2.3, 7.0)  # the same, and a second for it to arrive
SLACK: Final = 1.0  # s more, for a machine with other work
STARTS: Final = (
    2.0  # s: its gyroscope alone is calibrated for one, at rest (sensors_bmi088_bmp3xx.c)
)
NEVER: Final = (0.0, 0.0)  # no motor ever turns


def made(body: SimulatedBody, **words: Any) -> Firmware:
    """Return the firmware that a body flies with."""
    return Firmware(body, build=body.build, **words)


@dataclass(frozen=True, slots=True)
class Kind:
    """
    One kind of fault.

    Attributes
    ----------
    about : str
        In the words of the table.
    stated : tuple of float
        Seconds to motors that stand: by duties, by setpoints.
    strike : callable
        Does it, to a `Trial`.
    ends : str
        What becomes of the flight, in the words of the table.
    word : str
        What the bridge says of it, in the bag; empty where it cannot.
    flies_on : bool
        Whether the flight goes on; the time then counts from the request to disarm.
    firmware : callable
        Makes the firmware for a body.

    """

    about: str
    stated: tuple[float, float]
    strike: Callable[[Any], object] = lambda trial: None
    word: str = ''
    ends: str = 'lands'
    flies_on: bool = False
    firmware: Callable[[SimulatedBody, Random], Firmware] = lambda body, random: made(body)


def link(**faults: float | bool) -> Callable[[Any], None]:
    """Return what spoils the link in both directions."""

    def strike(trial: Any) -> None:
        for way in (trial.server.up, trial.server.down):
            for name, value in faults.items():
                setattr(way, name, value)

    return strike


def one_way(name: str) -> Callable[[Any], None]:
    """Return what silences one direction: 'up' or 'down'."""
    return lambda trial: setattr(getattr(trial.server, name), 'silent', True)


def torn(trial: Any) -> None:
    """Tear what comes from the drone: a setpoint that is torn makes the firmware start anew."""
    trial.server.down.torn = 0.2


def turn_over(trial: Any) -> None:
    """Turn the drone upside down, for its accelerometer."""
    trial.server.firmware.acceleration = (0.0, 0.0, -1.0)


def reboot(trial: Any) -> None:
    """Let the cell fail for a moment: unarmed, and all log blocks are forgotten."""
    server: CrazyflieServer = trial.server
    up_at = server.now + STARTS
    server.firmware = made(trial.body, boot_ms=-int(1e3 * server.now), up_at=up_at)


def empty(trial: Any) -> None:
    """Let the cell sag below what the vehicle may fly with."""
    trial.server.firmware.voltage = 3.0


def refusing(code: int) -> Callable[[SimulatedBody, Random], Firmware]:
    """Return firmware that refuses every log block with an errno."""

    def refused(body: SimulatedBody, random: Random) -> Firmware:
        firmware = made(body)
        firmware.log.refuse = code
        return firmware

    return refused


def wrapping(body: SimulatedBody, random: Random) -> Firmware:
    """Return firmware whose fast clock wraps within its first seconds of flight."""
    return made(body, boot_ms=WRAP_MS - random.randrange(7000, 14000), drift=200e-6)


KINDS: Final = {
    'drop': Kind('20 % lost, both ways', LANDS, link(drop=0.2), 'on request', flies_on=True),
    'double': Kind('half come twice', LANDS, link(double=0.5), 'on request', flies_on=True),
    'reorder': Kind('overtaking by up to 60 ms', LANDS, link(jitter=0.06), 'on request',
                    flies_on=True),
    'torn': Kind('20 % from the drone end in the middle', LANDS, torn, 'on request',
                    flies_on=True),
    'delay': Kind('100 ms later', LANDS, link(delay=0.1), 'on request', flies_on=True),
    'wrap': Kind('its clock 200 ppm fast, its stamps wrap', LANDS, word='on request',
                 flies_on=True, firmware=wrapping),
    'old': Kind('protocol 11', LANDS, word='on request', flies_on=True,
                firmware=lambda body, random: made(body, protocol=11)),
    'late': Kind('1 s later', LATE, link(delay=1.0), 'sent nothing'),
    'silent': Kind('nothing, both ways', CUT_OFF, link(silent=True), 'sent nothing', ALONE),
    'dumb': Kind('nothing from the drone', SILENT, one_way('down'), 'sent nothing'),
    'deaf': Kind('nothing to the drone', CUT_OFF, one_way('up'), '', ALONE),
    'closed': Kind('its port closed', CUT_OFF, lambda trial: trial.server.close_port(), 'no link',
                   ALONE),
    'log reset': Kind('it forgets its log blocks', SILENT,
                      lambda trial: trial.server.firmware.log.reset(), 'sent nothing'),
    'reboot': Kind('it starts anew in the air', AT_ONCE, reboot, 'sent nothing', 'stops at once'),
    'locked': Kind('locked', AT_ONCE, lambda trial: trial.server.firmware.supervisor.lock(),
                   'locked', 'stops at once'),
    'tumbled': Kind('upside down', AT_ONCE, turn_over, 'crashed', 'stops at once'),
    'crashed': Kind('crashed', AT_ONCE, lambda trial: trial.server.firmware.supervisor.crash(),
                    'crashed', 'stops at once'),
    'low cell': Kind('3.0 V', LOW, empty, 'the cell has'),
    'too far': Kind('estimated 60 m away', LANDS, lambda trial: trial.stray(60.0), 'farther than'),
    'no command': Kind('commands end', STALE, lambda trial: trial.fall_silent(),
                       'the newest command is'),
    'no number': Kind('commands are NaN', STALE, lambda trial: trial.command(float('nan')),
                      'the newest command is'),
    'emergency': Kind('emergency stop', AT_ONCE, lambda trial: trial.emergency(),
                      'emergency stop', 'stops at once, and locks'),
    'ended': Kind('SIGTERM to the bridge', LANDS, lambda trial: trial.bridge.terminate(),
                  'deactivated'),
    'killed': Kind('SIGKILL to the bridge', CUT_OFF, lambda trial: trial.bridge.kill(), '',
                   ALONE),
    'protocol 7': Kind('protocol 7', NEVER, word='older than 9',
                       firmware=lambda body, random: made(body, protocol=7)),
    'E2BIG': Kind('log blocks refused: E2BIG', NEVER, word='was refused', firmware=refusing(7)),
    'ENOMEM': Kind('log blocks refused: ENOMEM', NEVER, word='was refused',
                   firmware=refusing(12)),
}  # fmt: skip

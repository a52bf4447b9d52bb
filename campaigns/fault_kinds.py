# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Faults in flight, and the time within which the motors must stop.

There is one time for each way to command the drone. With duties, the app stops the motors after
200 ms without a packet, and a landing is a ramp of half a second. With setpoints, the firmware
flies on level for 2 s and then locks, and a landing descends at 0.3 m/s from the current height.
"""

from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any, Final

from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_emulation.crazyflie.simulated_body import SimulatedBody

ALONE: Final = 'the drone stops itself'
WRAP_MS: Final = 2**24  # of the stamps of log packets
AT_ONCE: Final = (0.2, 0.2)
CUT_OFF: Final = (0.3, 2.1)  # the drone receives nothing: its own stop
LANDS: Final = (0.7, 5.5)  # commanded immediately
LOW: Final = (1.1, 5.9)  # after 0.3 s of low voltage, and 0.1 s between two readings
STALE: Final = (1.1, 5.9)  # after 0.3 s, and the delay of a setpoint
SILENT: Final = (1.3, 6.0)  # after half a second of silence
STUCK: Final = (2.8, 7.6)  # after 2 s in which the height repeats
LATE: Final = (2.3, 7.0)  # the same, and a delay of 1 s
STARTS: Final = (
    2.0  # s: its gyroscope alone is calibrated for one, at rest (sensors_bmi088_bmp3xx.c)
)
NEVER: Final = (0.0, 0.0)  # the motors never turn


def made(body: SimulatedBody, **words: Any) -> Firmware:
    return Firmware(body, build=body.build, **words)


@dataclass(frozen=True, slots=True)
class FaultKind:
    """
    One kind of fault.

    Attributes
    ----------
    about : str
        Label in the table.
    stated : tuple of float
        Time until the motors stop: by duties, by setpoints. [s]
    strike : callable
        Inject the fault into a `Trial`.
    ends : str
        Outcome of the flight, label in the table.
    word : str
        Part of the bridge's message in the bag; empty if there is none.
    flies_on : bool
        Whether the flight continues; the time then counts from the request to disarm.
    stays : float
        For how long no motor may turn again. [s]
    firmware : callable
        Make the firmware for a body.

    """

    about: str
    stated: tuple[float, float]
    strike: Callable[[Any], object] = lambda trial: None
    word: str = ''
    ends: str = 'lands'
    flies_on: bool = False
    stays: float = 0.0
    firmware: Callable[[SimulatedBody, Random], Firmware] = lambda body, random: made(body)


def link(**faults: float | bool) -> Callable[[Any], None]:
    """Return a function that disturbs the link in both directions."""

    def strike(trial: Any) -> None:
        for way in (trial.server.up, trial.server.down):
            for name, value in faults.items():
                setattr(way, name, value)

    return strike


def one_way(name: str) -> Callable[[Any], None]:
    """Return a function that drops all packets in one direction: 'up' or 'down'."""
    return lambda trial: setattr(getattr(trial.server, name), 'silent', True)


def torn(trial: Any) -> None:
    """Truncate packets from the drone; a truncated setpoint would restart the firmware."""
    trial.server.down.torn = 0.2


def turn_over(trial: Any) -> None:
    """Let the accelerometer show the drone upside down."""
    trial.server.firmware.acceleration = (0.0, 0.0, -1.0)


def reboot(trial: Any) -> None:
    """Restart the drone as after a short power failure: unarmed and without log blocks."""
    server: CrazyflieServer = trial.server
    up_at = server.now + STARTS
    server.firmware = made(trial.body, boot_ms=-int(1e3 * server.now), up_at=up_at)


def empty(trial: Any) -> None:
    """Let the cell voltage fall below the limit of the vehicle."""
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
    'drop': FaultKind(
        '20 % of the packets lost, both directions',
        LANDS,
        link(drop=0.2),
        'on request',
        flies_on=True,
    ),
    'double': FaultKind(
        'half of the packets duplicated', LANDS, link(double=0.5), 'on request', flies_on=True
    ),
    'reorder': FaultKind(
        'packets reordered, by up to 60 ms', LANDS, link(jitter=0.06), 'on request', flies_on=True
    ),
    'torn': FaultKind(
        '20 % of the packets from the drone truncated', LANDS, torn, 'on request', flies_on=True
    ),
    'delay': FaultKind(
        'packets delayed by 100 ms', LANDS, link(delay=0.1), 'on request', flies_on=True
    ),
    'wrap': FaultKind(
        'clock of the drone 200 ppm fast, time stamps wrap',
        LANDS,
        word='on request',
        flies_on=True,
        firmware=wrapping,
    ),
    'old': FaultKind(
        'CRTP protocol 11 (accepted)',
        LANDS,
        word='on request',
        flies_on=True,
        firmware=lambda body, random: made(body, protocol=11),
    ),
    'late': FaultKind('packets delayed by 1 s', LATE, link(delay=1.0), 'sent nothing'),
    'silent': FaultKind(
        'no packets, both directions', CUT_OFF, link(silent=True), 'sent nothing', ALONE
    ),
    'dumb': FaultKind('no packets from the drone', SILENT, one_way('down'), 'sent nothing'),
    'deaf': FaultKind('no packets to the drone', CUT_OFF, one_way('up'), '', ALONE),
    'closed': FaultKind(
        'port of the drone closed',
        CUT_OFF,
        lambda trial: trial.server.close_port(),
        'no link',
        ALONE,
    ),
    'log reset': FaultKind(
        'drone loses its log blocks',
        SILENT,
        lambda trial: trial.server.firmware.log.reset(),
        'sent nothing',
    ),
    'reboot': FaultKind(
        'drone restarts in flight', AT_ONCE, reboot, 'sent nothing', 'stops immediately'
    ),
    'locked': FaultKind(
        'supervisor locked',
        AT_ONCE,
        lambda trial: trial.server.firmware.supervisor.lock(),
        'locked',
        'stops immediately',
    ),
    'tumbled': FaultKind('drone upside down', AT_ONCE, turn_over, 'crashed', 'stops immediately'),
    'crashed': FaultKind(
        'crashed',
        AT_ONCE,
        lambda trial: trial.server.firmware.supervisor.crash(),
        'crashed',
        'stops immediately',
    ),
    'low cell': FaultKind('cell voltage of 3.0 V', LOW, empty, 'the battery has'),
    'too far': FaultKind(
        'position estimate 60 m away', LANDS, lambda trial: trial.stray(60.0), 'farther away than'
    ),
    'no command': FaultKind(
        'commands stop', STALE, lambda trial: trial.fall_silent(), 'the newest command is'
    ),
    'no number': FaultKind(
        'commands are NaN',
        STALE,
        lambda trial: trial.command(float('nan')),
        'the newest command is',
    ),
    'no estimate': FaultKind(
        'position estimates stop', SILENT, lambda trial: trial.lose_estimate(), 'position estimate'
    ),
    'stuck height': FaultKind(
        'height of the estimate repeats to the bit',
        STUCK,
        lambda trial: trial.freeze_height(),
        'the position of the drone is not known',
    ),
    'rises': FaultKind(
        'lighter than air, and disarmed in flight',
        LANDS,
        lambda trial: trial.disarm_rising(),
        'lighter than air',
        stays=6.0,
    ),
    'hung': FaultKind(
        'SIGSTOP to the bridge, and SIGCONT once the motors stand',
        CUT_OFF,
        lambda trial: trial.hang(),
        '',
        ALONE,
        stays=3.0,
    ),
    'emergency': FaultKind(
        'emergency stop',
        AT_ONCE,
        lambda trial: trial.emergency(),
        'emergency stop',
        'stops immediately and locks',
    ),
    'ended': FaultKind(
        'SIGTERM to the bridge', LANDS, lambda trial: trial.bridge.terminate(), 'deactivated'
    ),
    'killed': FaultKind(
        'SIGKILL to the bridge', CUT_OFF, lambda trial: trial.bridge.kill(), '', ALONE
    ),
    'protocol 7': FaultKind(
        'CRTP protocol 7 (too old, refused)',
        NEVER,
        word='must have 9 or newer',
        firmware=lambda body, random: made(body, protocol=7),
    ),
    'E2BIG': FaultKind(
        'log blocks refused: E2BIG', NEVER, word='refused the log block', firmware=refusing(7)
    ),
    'ENOMEM': FaultKind(
        'log blocks refused: ENOMEM', NEVER, word='refused the log block', firmware=refusing(12)
    ),
}

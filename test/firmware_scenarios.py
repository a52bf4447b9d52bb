# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Scripts that show what a Crazyflie does with its motors in each relevant situation.

`campaigns/firmware.py` plays them against the firmware and stores the outcomes in
`test/golden/crazyflie_firmware.json`; `test_firmware_contract.py` plays them against the emulator.
A script is a list of packets with times. An outcome lists when the supervisor's status word
changed and when the motors started and stopped.
"""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
import struct
from typing import Final, NamedTuple, Protocol

from lta_bridge.crazyflie import duties_packet

SOLD, ARMING, APP = 'sold', 'arming', 'app'  # builds, as in firmware/crazyflie/linux
BUILDS: Final = (SOLD, ARMING, APP)
PERIOD: Final = 0.02  # s between two packets of a stream, and between two samples
WORD_BITS: Final = 0xFF  # of the supervisor's word: without the high-level commander
PWM_STEP: Final = 256  # of 65535: a smaller ratio leaves the pin low
IDLE_THRUST: Final = 7000  # Kconfig's default where arming is required
BRIEF: Final = 0.1  # s: what lasts for less is a step on the way
FULL: Final = 65535

U8, U16, U32 = 0x08, 0x09, 0x0A  # types of parameters
FORMS: Final = {U8: '<B', U16: '<H', U32: '<I'}
ARM, DISARM = (9, 1, b'\x01\x01'), (9, 1, b'\x01\x00')
EMERGENCY, OLD_EMERGENCY = (9, 1, b'\x03'), (6, 1, b'\x03')
WATCHDOG = (9, 1, b'\x04')
STOP_SETPOINT, NOTIFY = (7, 0, b'\0'), (7, 1, bytes(5))
HOVER = (7, 0, b'\x0a' + struct.pack('<ffff', 0.0, 0.0, 0.0, 0.45))

Packet = tuple[int, int, bytes]  # port, channel, payload


def app_files() -> list[Path]:
    """Return our files that decide what a recorded build does."""
    folder = Path(__file__).resolve().parents[1] / 'firmware/crazyflie'
    parts = (folder / 'src', folder / 'linux', folder / 'linux/include')
    # A build leaves its objects beside the sources
    built = ('.o', '.cmd')
    found = [p for part in parts for p in part.iterdir() if p.is_file() and p.suffix not in built]
    return [folder / 'app-config', *found]


def set_by_name(name: str, kind: int, value: int) -> Packet:
    """Return the packet that sets a parameter by its name."""
    group, _, own = name.partition('.')
    text = f'{group}\0{own}\0'.encode()
    return (2, 3, b'\0' + text + bytes([kind]) + struct.pack(FORMS[kind], value))


def duties(level: float, hold_ms: int = 200) -> Callable[[int], Packet]:
    """Return a stream's packets to the app, by their number."""
    return lambda number: (13, 2, duties_packet.pack_duties(number, (level,) * 4, hold_ms))


class Stream(NamedTuple):
    """Packets from one time to another, `PERIOD` apart [s]."""

    begin: float
    end: float
    packet: Callable[[int], Packet]


def hover(begin: float, end: float) -> Stream:
    """Return hover setpoints from one time to another [s]."""
    return Stream(begin, end, lambda number: HOVER)


class Scenario(NamedTuple):
    """A script."""

    about: str  # label on the page
    builds: tuple[str, ...]  # builds that play it
    seconds: float  # duration [s]
    packets: tuple[tuple[float, Packet], ...] = ()  # times [s] and packets
    streams: tuple[Stream, ...] = ()  # packets that repeat
    # Times [s] with changes of the body: name and value
    bench: tuple[tuple[float, str, float], ...] = ()
    since: float = 0.0  # start of the outcome: in hover, motors may stop for a moment before [s]


class Sample(NamedTuple):
    """A time [s], the supervisor's word, and the ratios of M1 to M4 [1/65535]."""

    time: float
    word: int
    ratios: tuple[int, ...]


class Change(NamedTuple):
    """From when on what held: time [s], word, motors ('still', 'idle', 'turn')."""

    time: float
    word: int
    motors: str


class Player(Protocol):
    """A freshly started drone that a script is played to."""

    def play(self, scenario: Scenario) -> list[Sample]:
        """Play a script to its end; return what was seen."""
        ...


PID: Final = (0.05, set_by_name('stabilizer.controller', U8, 1))
ARMED: Final = (0.2, ARM)
STRUCK: Final = 1.5  # s at which most scripts strike


def _in_hover(about: str, *packets: tuple[float, Packet], until: float = STRUCK,
              seconds: float = 5.0, **more: object) -> Scenario:  # fmt: skip
    """Return a script that hovers by setpoints, which a build with the app needs PID for."""
    streams = (hover(0.4, until),)
    return Scenario(about, BUILDS, seconds, (PID, ARMED, *packets), streams, since=STRUCK - 0.1,
                    **more)  # type: ignore[arg-type] # fmt: skip


SCENARIOS: Final[dict[str, Scenario]] = {
    'armed and idle': Scenario('armed, no command', BUILDS, 2.0, (ARMED,)),
    'armed for too long': Scenario(
        'armed, no command, preflight time-out of 1 s', BUILDS, 3.0,
        ((0.05, set_by_name('supervisor.prefltTimeout', U16, 1000)), ARMED),
    ),
    'unarmed': Scenario('setpoints, not armed', (ARMING, APP), 1.5, (PID,),
                        (hover(0.2, 1.5),)),
    'setpoints end': _in_hover('setpoints stop in flight'),
    'disarmed': _in_hover('disarmed in flight', (STRUCK, DISARM), until=2.5),
    'emergency': _in_hover('emergency stop', (STRUCK, EMERGENCY), until=3.0, seconds=3.0),
    'old emergency': _in_hover('emergency stop on port 6', (STRUCK, OLD_EMERGENCY), until=3.0,
                               seconds=3.0),
    'watchdog': _in_hover('one watchdog packet', (STRUCK, WATCHDOG), until=4.0,
                          seconds=4.0),
    'stop parameter': _in_hover('stabilizer.stop = 1',
                                (STRUCK, set_by_name('stabilizer.stop', U8, 1)), until=3.0,
                                seconds=3.0),
    'stop setpoint': _in_hover('stop setpoint, then no packets', (STRUCK, STOP_SETPOINT)),
    'handed over': _in_hover('notify setpoint stop, no landing requested', (STRUCK, NOTIFY),
                             seconds=9.0),
    'emergency, landed': _in_hover('notify setpoint stop, emergency stop 3 s later',
                                   (STRUCK, NOTIFY), (STRUCK + 3.0, EMERGENCY), seconds=9.0),
    'disarmed, level': _in_hover('setpoints stop, disarmed 1 s later', (STRUCK + 1.0, DISARM)),
    'upside down': _in_hover('turned upside down in flight', until=4.0, seconds=4.0,
                             bench=((STRUCK, 'upside_down', 1.0),)),
    'duties end': Scenario('duty packets stop', (APP,), 4.0, (ARMED,),
                           (Stream(0.4, STRUCK, duties(0.3)),), since=0.4),
    'duties end, idle thrust': Scenario(
        'duty packets stop, idle thrust 7000', (APP,), 4.0,
        ((0.05, set_by_name('powerDist.idleThrust', U32, IDLE_THRUST)), ARMED),
        (Stream(0.4, STRUCK, duties(0.3)),), since=0.4,
    ),
    'coasting': Scenario('zero duties for 8 s', (APP,), 12.0, (ARMED,),
                         (Stream(0.4, 1.0, duties(0.3)), Stream(1.0, 9.0, duties(0.0))),
                         since=0.4),
    'waiting': Scenario('only zero duties', (APP,), 4.0,
                        ((0.05, set_by_name('supervisor.prefltTimeout', U16, 1000)), ARMED),
                        (Stream(0.4, 4.0, duties(0.0)),)),
    'duties, hover controller': Scenario('duties with the PID controller', (APP,), 2.0,
                                         (PID, ARMED), (Stream(0.4, 2.0, duties(0.3)),)),
    'idle thrust 0': Scenario('idle thrust set to 0, then armed', (ARMING,), 2.0,
                              ((0.05, set_by_name('powerDist.idleThrust', U32, 0)), ARMED)),
    'override': Scenario(
        'override, not armed; emergency stop at 1 s', BUILDS, 2.0,
        ((0.2, set_by_name('motorPowerSet.m1', U16, 30000)),
         (0.4, set_by_name('motorPowerSet.enable', U8, 1)),
         (1.0, EMERGENCY),
         (1.5, set_by_name('motorPowerSet.enable', U8, 0))),
    ),
}  # fmt: skip


def motors_of(ratios: Sequence[int]) -> str:
    """Return 'still', 'idle' where all run at the idle thrust, or 'turn'."""
    if max(ratios) < PWM_STEP:
        return 'still'
    return 'idle' if set(ratios) == {IDLE_THRUST} else 'turn'


def changes(samples: Iterable[Sample], since: float) -> list[Change]:
    """Return from when on what held, without what is brief or was before a time [s]."""
    told: list[Change] = []
    held = [Change(s.time, s.word & WORD_BITS, motors_of(s.ratios)) for s in samples]
    for place, one in enumerate(held):
        lasting = all(
            other[1:] == one[1:] for other in held[place:] if other.time < one.time + BRIEF
        )
        if lasting and (not told or told[-1][1:] != one[1:]):
            told.append(one)
    begun = [place for place, one in enumerate(told) if one.time <= since]
    return told[begun[-1] if begun else 0 :]


def disagreement(seen: Sequence[Change], kept: Sequence[Change], tolerance: float) -> str:
    """Return how two outcomes differ, their times by more than a tolerance [s]; or ''."""
    if [one[1:] for one in seen] != [one[1:] for one in kept]:
        return f'saw {list(map(tuple, seen))}, the firmware did {list(map(tuple, kept))}'
    late = [
        f'{one.motors} {one.word:#x} at {one.time:.2f} s, the firmware at {other.time:.2f} s'
        for one, other in list(zip(seen, kept, strict=True))[1:]
        if abs(one.time - other.time) > tolerance
    ]
    return '; '.join(late)


def due(scenario: Scenario, begin: float, end: float) -> list[Packet]:
    """Return the packets of a script in a span of time [s], in their order."""
    found = [(time, packet) for time, packet in scenario.packets if begin <= time < end]
    for stream in scenario.streams:
        number = max(0, round((begin - stream.begin) / PERIOD))
        time = stream.begin + number * PERIOD
        if begin - 1e-9 <= time < min(end, stream.end) - 1e-9:
            found.append((time, stream.packet(round(time / PERIOD))))
    return [packet for _, packet in sorted(found, key=lambda one: one[0])]

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Inject faults into flights of emulated hardware.

Each kind of `fault_kinds.py` comes at a random moment of a flight, by turns of one that is
commanded by duties (GT-MAB, even numbers) and by setpoints (multirotor, odd numbers).
"""

from argparse import Namespace
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
import math
from pathlib import Path
from random import Random
import re
import signal
import time
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticArray
from lta_bag.reader import read_bag
from lta_config.topics import load_topic_table
from lta_control.messages import from_duties
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_emulation.emulated_hardware import build_simulated_body
from lta_graph.ros.message_validation import find_message_type
from peer import Peer, start
from std_srvs.srv import SetBool, Trigger

from campaigns.fault_kinds import FaultKind, KINDS, NEVER, WRAP_MS
from campaigns.graph_trial import join_faults, Outcome, SLACK, try_flight
from campaigns.harness import Campaign, Case, count_right, Row, Rows

TABLE: Final = load_topic_table()
VEHICLES: Final = ('gtmab', 'multirotor')  # by duties, by setpoints
COMMANDS: Final = 0.05  # s between two
LEG: Final = 3.0  # s of each phase
PHASES: Final = ('climb', 'cruise', 'descent')
DUTIES: Final = {  # up_left, up_right, forward_left, forward_right: never all still
    'climb': (0.4, 0.4, 0.1, 0.1),
    'cruise': (0.1, 0.1, 0.3, 0.3),
    'descent': (0.05, 0.05, 0.05, 0.05),
}
HEIGHTS: Final = {'climb': 1.0, 'cruise': 1.0, 'descent': 0.6}  # m
SPEEDS: Final = {'climb': 0.0, 'cruise': 0.2, 'descent': 0.0}  # m/s
ASKED: Final = 0.3  # s between two requests to arm
HEARD: Final = 5.0  # s for the bridge's word to be heard
STANDS: Final = 1.5  # s without a motor turning after which they stand
GOES_ON: Final = 2.0  # s that a flight must go on where it may
RISE: Final = 0.15  # m/s of a drone that is lighter than air
WATCHED: Final = 6.0  # s in which a drone that must not arm is asked to


class Trial:
    """The parties of one flight."""

    def __init__(self, name: str, number: int, folder: Path, peer: Peer) -> None:
        kind = KINDS[name]
        self.name, self._kind, self._peer = name, kind, peer
        self.by_setpoints = bool(number % 2)
        self._random = Random(f'{name} {number}')
        vehicle = VEHICLES[self.by_setpoints]
        self.body, self.server = self._drone(name, vehicle, number)
        self.bag = folder / 'bag'
        self.recorder = start('lta_bridge.nodes.recorder', '-p', f'bag:={self.bag}')
        self.bridge = start(
            'lta_bridge.nodes.crazyflie_bridge',
            '-p', f'uri:={self.server.uri}', '-p', f'vehicle:={vehicle}',
            '-p', 'blind:=true', '-p', 'watchdog:=never',
            '-p', 'allow_other_commanders:=true',
        )  # fmt: skip
        self._words: set[str] = set()
        peer.node.create_subscription(DiagnosticArray, '/diagnostics', self._on_diagnostics, 10)
        self._names = self.body.world.vehicle.rotor_names
        names = ('odom', 'setpoint/pose', 'setpoint/velocity') if self.by_setpoints else (
            'odom', 'motors')  # fmt: skip
        self._publishers = {name: peer.publisher(name) for name in names}
        self._factor, self._distance, self._silent = 1.0, 0.0, False
        self._noise = Random(number)
        self._frozen = self._lost = False
        self._rises_from = math.inf
        self._commanded = self._turned = self._asked = -math.inf
        self.began = math.inf

    def _drone(self, name: str, vehicle: str, number: int) -> tuple[Any, Any]:
        """Return the body that flies and what its link ends at."""
        body = build_simulated_body(vehicle, 'lamp_room', number)
        return body, CrazyflieServer(self._kind.firmware(body, self._random))

    # What a fault may do.

    def stray(self, distance: float) -> None:
        """Let the estimate be elsewhere [m]."""
        self._distance = distance

    def fall_silent(self) -> None:
        """Command no more."""
        self._silent = True

    def command(self, factor: float) -> None:
        """Command a multiple of what the pilot wants."""
        self._factor = factor

    def lose_estimate(self) -> None:
        """Let no more estimates come."""
        self._lost = True

    def freeze_height(self) -> None:
        """Let the estimated height repeat to the bit."""
        self._frozen = True

    def disarm_rising(self) -> None:
        """Let the estimate rise, and ask to disarm; the pilot commands on."""
        self._rises_from = time.monotonic()
        self._peer.ask(SetBool, 'crazyflie_bridge/arm', data=False)

    def hang(self) -> None:
        """Stop the bridge where it is, as a debugger does."""
        self.bridge.send_signal(signal.SIGSTOP)

    def emergency(self) -> None:
        """Ask for an emergency stop."""
        self._peer.ask(Trigger, 'crazyflie_bridge/emergency_stop')

    def _strike(self) -> None:
        self._kind.strike(self)

    def _wrapped(self) -> bool:
        """Tell whether the drone's stamps have begun anew."""
        return bool(self.server.firmware.clock_ms(self.server.now) > WRAP_MS + 1000)

    # The flight.

    def _on_diagnostics(self, told: DiagnosticArray) -> None:
        self._words.update(words(told))

    @property
    def phase(self) -> str:
        """What the pilot does now."""
        return PHASES[int((time.monotonic() - self.began) / LEG) % len(PHASES)]

    def _send(self) -> None:
        """Command, every 50 ms."""
        now = time.monotonic()
        if self._silent or now < self._commanded + COMMANDS:
            return
        self._commanded, phase = now, self.phase if self.began < now else 'climb'
        stamp = self._peer.node.get_clock().now().to_msg()
        for name, publisher in self._publishers.items():
            if name == 'odom' and self._lost:
                continue
            message: Any = find_message_type(TABLE[name])()
            message.header.stamp = stamp
            match name:
                case 'odom':
                    message.pose.pose.position.x = self._distance
                    message.pose.pose.position.z = self._height(now)
                case 'motors':
                    duties = tuple(self._factor * duty for duty in DUTIES[phase])
                    message = from_duties(stamp, self._names, duties)
                case 'setpoint/pose':
                    message.pose.position.z = self._factor * HEIGHTS[phase]
                case 'setpoint/velocity':
                    message.twist.linear.x = self._factor * SPEEDS[phase]
            publisher.publish(message)

    def _height(self, now: float) -> float:
        """Return the estimated height, with the noise of a sensor that works [m]."""
        noise = 0.0 if self._frozen else 1e-3 * self._noise.random()
        return RISE * max(0.0, now - self._rises_from) + noise

    def _fly_until(self, condition: Callable[[], object]) -> None:
        """Command and watch the motors until something holds."""

        def done() -> object:
            self._send()
            if any(self.body.duties):
                self._turned = time.monotonic()
            return condition()

        self._peer.until(done)

    def _for(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        self._fly_until(lambda: time.monotonic() >= until)

    def _stands(self) -> bool:
        return time.monotonic() > self._turned + STANDS

    def _armed(self) -> bool:
        """Ask to arm, but not all the time, and say whether it was done."""
        if time.monotonic() < self._asked + ASKED:
            return False
        self._asked = time.monotonic()
        return bool(self._peer.ask(SetBool, 'crazyflie_bridge/arm', data=True).success)

    def fly(self) -> Outcome:
        """Fly, let it strike, and watch."""
        stated = self._kind.stated[self.by_setpoints] + SLACK
        with self.server:
            if self._kind.stated is NEVER:
                return self._refused()
            self._fly_until(self._armed)
            self._fly_until(lambda: any(self.body.duties))
            self.began = time.monotonic()
            self._for(self._random.uniform(0.3, 9.0))
            phase, struck = self.phase, time.monotonic()
            self._strike()
            flew_on = self._goes_on()
            if flew_on:
                struck = time.monotonic()
                self._peer.ask(SetBool, 'crazyflie_bridge/arm', data=False)
            self._turned = max(self._turned, struck)
            self._fly_until(self._stands)
            took = self._turned - struck
            wrong = '' if took <= stated else f'turned for {took:.2f} s, stated {stated:.1f} s'
            if self._kind.flies_on and not flew_on:
                wrong = 'it did not fly on'
            if self._kind.stays and self._turns_again():
                wrong = wrong or 'a motor turned again'
            return self._closed(Outcome(took, flew_on, phase, wrong, bool(wrong)))

    def _turns_again(self) -> bool:
        """Tell whether a motor turns once they stand; a bridge that hung goes on."""
        since = time.monotonic()
        self.bridge.send_signal(signal.SIGCONT)
        self._for(self._kind.stays)
        return self._turned > since

    def _goes_on(self) -> bool:
        """Fly on where the kind lets it; return whether motors turn to the end."""
        if not self._kind.flies_on:
            return False
        self._for(GOES_ON)
        if self._kind.about.endswith('wrap'):
            self._fly_until(self._wrapped)
        return time.monotonic() < self._turned + 0.2

    def _refused(self) -> Outcome:
        """Ask to arm what must refuse, and command it."""
        until = time.monotonic() + WATCHED
        armed = False
        while time.monotonic() < until:
            armed |= self._armed()
            self._for(0.5)
        turned = armed or self._turned > -math.inf
        wrong = 'armed' if armed else 'turned' if turned else ''
        return self._closed(Outcome(0.0, False, 'connecting', wrong))

    def _told(self, words: set[str]) -> bool:
        """Tell whether the bridge has said its word of the fault."""
        return any(self._kind.word in word for word in words)

    def _closed(self, outcome: Outcome) -> Outcome:
        """End bridge and recorder as Ctrl-C does, and look into the bag."""
        until = time.monotonic() + HEARD
        self._peer.until(lambda: self._told(self._words) or time.monotonic() > until)
        nodes = {'bridge': self.bridge, 'recorder': self.recorder}
        ended = closed_nodes(nodes, killed=self._kind is KINDS['killed'])
        bag = read_bag(self.bag)
        outcome = join_faults(outcome, ended, '' if bag.is_complete else 'the bag is not whole')
        if not outcome.wrong and not self._told(told(bag)):
            wrong = f"the bag says nowhere '{self._kind.word}', but {sorted(told(bag))}"
            return replace(outcome, wrong=wrong, timing=True)
        return outcome


def closed_nodes(nodes: dict[str, Any], killed: bool = False) -> str:
    """End nodes as Ctrl-C does; return what is wrong with how they ended, empty for nothing."""
    wrong = ''
    for name, process in nodes.items():
        if process.poll() is None:
            process.send_signal(2)
        _, text = process.communicate(timeout=30)
        if process.returncode and not (killed and process.returncode == -9):
            wrong = wrong or f'{name} ended with {process.returncode}: {text[-200:]}'
    return wrong


def told(bag: Any) -> set[str]:
    """Return what the bridge told of itself."""
    arrays = (bag.decode(topic, data) for topic, _, data in bag.iterate_messages(['/diagnostics']))
    return {word for array in arrays for word in words(array)}


def words(told: Any) -> set[str]:
    """Return what the bridge says in one array of diagnostics."""
    return {
        status.message
        for status in told.status
        if re.fullmatch('(.*/)?crazyflie_bridge: (link|safety)', status.name)
    }


def run(case: Case, options: Namespace) -> Row:
    """Return the row of a trial."""
    return try_flight(lambda folder, peer: Trial(*case, folder, peer).fly())


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the table of flights."""
    yield '| fault | outcome of the flight | by duties | by setpoints | as stated |'
    yield '|---|---|---|---|---|'
    for name, kind in KINDS.items():
        some = {case: row for case, row in rows.items() if case.kind == name}
        if some:
            times = [
                format_times(stated, [row for case, row in some.items() if case.number % 2 == way])
                for way, stated in enumerate(kind.stated)
            ]
            cells = (kind.about, describe_end(kind), *times, count_right(list(some.values())))
            yield f'| {" | ".join(cells)} |'


def format_times(stated: float, rows: Sequence[Row]) -> str:
    """Return the stated and the longest time; those that hung have none [s]."""
    times = [row['took'] for row in rows if row.get('took') is not None]
    longest = f'{max(times):.1f} s' if times else '-'
    return f'{stated:.1f} s; {longest}' if stated else longest


def describe_end(kind: FaultKind) -> str:
    """Return what becomes of a flight, in words."""
    if not any(kind.stated):
        return 'cannot be armed'
    return 'flies on, and lands on request' if kind.flies_on else kind.ends


CAMPAIGN: Final = Campaign(
    lambda options: list(KINDS), run, list_table, each=20, page='hardware_faults.md',
    alone=True, side=0, patience=240.0,
)  # fmt: skip

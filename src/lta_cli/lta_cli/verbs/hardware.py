# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Check connected devices, and bench-test one motor of a tethered drone."""

from contextlib import closing
import math
import sys
import time
from typing import Any, final

from lta_analysis.console import print_lines
from lta_bridge.crazyflie.cflib_link import CflibLink
from lta_bridge.crazyflie.connection_manager import CONNECT_TIME
from lta_bridge.crazyflie.drone_lock import DroneLock
from lta_bridge.crazyflie.link import CrazyflieLink, LinkFailed
from lta_bridge.crazyflie.log_table import LOG_BLOCKS
from lta_bridge.devices import format_udev_rules, RULES_FILE
from lta_bridge.hardware.check import (
    format_diode_rows,
    format_stream_rows,
    HardwareCheckRequest,
    run_hardware_check,
    to_json,
)
from lta_bridge.hardware.motor import interrupt_on_signals, MotorBench, MotorTurnResult
from lta_cli.doctor import exit_status, print_checks
from lta_config.errors import BadInput, unknown_name_error
from lta_config.schema.crazyflie_file import CF_MOTORS, find_crazyflie
from lta_model.vehicle import load_vehicle
from lta_report.progress_bar import ProgressBar
from lta_report.report import TextTable
from lta_report.report_terminal import print_table
from lta_report.request import Action, argument, option, Outcome, VEHICLE
from lta_vlc.settings import DemodulationSettings
from rich.console import Console
from rich.progress import BarColumn, TextColumn

HIGHEST_BENCH_DUTY = 0.3  # turns every rotor, lifts nothing
LONGEST_BENCH_TURN = 10.0  # s
# Smallest duty of 8-bit PWM that turns a motor; the app keeps m1 just above 0
LEAST_TURNING_DUTY = 1.0 / 256.0


@final
class DeviceCheckRequest(Action, command='hardware check', json=True):
    """
    Find radios, drones and light boards, listen to them, and report problems.

    Checks permissions, firmware, rates, packet loss, latency, battery, supervisor, parameters and
    each photodiode. Never writes parameters, arms or turns motors.

    Exit status 0: all in order, or only warnings. 1: a check failed. 2: no hardware found.

    Example: lta hardware check

    Example: lta hardware check --uri udp://127.0.0.1:19850

    Example: lta hardware check --udev | sudo tee /etc/udev/rules.d/60-lta.rules
    """

    uri: str = option('URI of the Crazyflie; by default the first that answers.', default='')
    port: str = option(
        'Port of the light board, or udp://HOST:PORT; by default the first found.', default=''
    )
    vehicle: str = VEHICLE
    frequency: float = option(
        'Flicker frequency of the lamp in Hz.', default=DemodulationSettings().frequency, low=1.0,
        high=1e5,
    )  # fmt: skip
    seconds: float = option('Listening time per device in s.', default=5.0, low=0.5, high=3600.0)
    udev: bool = option(
        'Print udev rules that allow access to the devices, and exit.', default=False
    )

    def run(self, console: Console) -> Outcome[Any]:
        """Print the checks, and return them."""
        if self.udev:
            sys.stdout.write(format_udev_rules())
            # The rules go to stdout for tee, the instructions to stderr
            sys.stderr.write(
                f'Save these rules as {RULES_FILE}, run: sudo udevadm control --reload && sudo '
                'udevadm trigger, then reconnect the devices.\n'
            )
            return Outcome(None)
        request = HardwareCheckRequest(
            self.uri, self.port, self.vehicle, self.frequency, self.seconds
        )
        columns = (TextColumn('{task.description}'), BarColumn())
        with ProgressBar(console, *columns, begin='searching', total=1.0) as bar:
            outcome = run_hardware_check(
                request, lambda doing, part: bar.update_bar(description=doing, completed=part)
            )
        print_checks(outcome.checks, console)
        if outcome.drone is not None:
            heads, *rows = format_stream_rows(outcome.drone.streams)
            print_table(TextTable('Log blocks', heads, rows), console)
        if outcome.board is not None and outcome.board.diodes:
            heads, *rows = format_diode_rows(outcome.board.diodes)
            print_table(TextTable('Diodes', heads, rows), console)
        return Outcome(to_json(outcome), status=exit_status(outcome.checks))


@final
class MotorBenchRequest(Action, command='hardware bench', json=True):
    """
    Turn one motor of a TETHERED drone at low duty, after a typed confirmation.

    The drone must run the app of firmware/crazyflie, which stops the motor 200 ms after the last
    command, even if this program dies. Ctrl-C, an error or a lost link disarm the drone.

    Exit status 0: only this motor turned. 1: it did not turn, or another one did. 2: bad input, or
    not confirmed. 130: Ctrl-C.

    Example: lta hardware bench m1 --duty 0.1 --seconds 2
    """

    motor: str = argument('Motor to turn: m1, m2, m3 or m4, numbered as on the Crazyflie.')
    uri: str = option('URI of the Crazyflie.', default='radio://0/80/2M/E7E7E7E7E7')
    vehicle: str = VEHICLE
    duty: float = option(
        'Motor duty as a fraction of full power.', default=0.1, low=0.01, high=HIGHEST_BENCH_DUTY
    )
    seconds: float = option('Duration in seconds.', default=2.0, low=0.2, high=LONGEST_BENCH_TURN)

    def run(self, console: Console) -> Outcome[Any]:
        """Turn the motor, and return what turned; None if the link failed."""
        vehicle = load_vehicle(self.vehicle)
        file = find_crazyflie(self.vehicle, vehicle.file.name)
        if self.motor not in CF_MOTORS:
            raise unknown_name_error('motor', self.motor, list(CF_MOTORS))
        # Setpoints reach the firmware's controller, which turns several motors
        if file.command != 'motors':
            raise BadInput(
                f"Vehicle '{self.vehicle}' uses the stock firmware, which cannot turn a single "
                'motor safely; flash the app in firmware/crazyflie and choose a --vehicle that '
                'uses it.'
            )
        # Not opened yet: the radio stays silent until the user has confirmed
        link = CflibLink(self.uri, LOG_BLOCKS, time.time_ns)
        # Nobody else may command the drone meanwhile
        with closing(DroneLock(self.uri)):
            self.confirm(file.motors[self.motor], console)
            turned = self.turn(MotorBench(link, file, vehicle, self.motor), link, console)
        if turned is None:
            return Outcome(None, status=1)
        # Half the command is enough to show that the motor turned; the others must stand still
        right = turned.duty > 0.5 * self.duty and turned.others < LEAST_TURNING_DUTY
        print_lines(console, self.describe_turn(turned, right))
        # JSON has no NaN
        volts = turned.voltage if math.isfinite(turned.voltage) else None
        data = {**turned._asdict(), 'voltage': volts, 'alone': right}
        return Outcome(data, status=int(not right))

    def turn(
        self, bench: MotorBench, link: CrazyflieLink, console: Console
    ) -> MotorTurnResult | None:
        """Open the link, turn the motor and always close the link; None if the link failed."""
        columns = (TextColumn('{task.description}'), BarColumn())
        name = f'{self.motor} turns'
        with interrupt_on_signals():
            try:
                # Opened inside the signal handler, so that Ctrl-C closes it
                link.open(CONNECT_TIME)
                with ProgressBar(console, *columns, begin=name, total=self.seconds) as bar:
                    return bench.turn_motor(
                        self.duty, self.seconds, lambda been: bar.update_bar(completed=been)
                    )
            except LinkFailed as error:
                # A lost link stops the motor: the firmware's time-out disarms the drone
                sys.stderr.write(f'The test of motor {self.motor} failed: {error}.\n')
                return None
            finally:
                link.close()

    def confirm(self, rotor: str, console: Console) -> None:
        """
        Ask the user to confirm by typing the motor's name.

        Raises BadInput if anything else is typed, or stdin is closed.
        """
        answer = f'spin {self.motor}'
        print_lines(
            console,
            f'Motor {self.motor} ({rotor}) is about to turn at {self.duty:.0%} duty for '
            f'{self.seconds:g} s. Tether the drone, keep fingers and strings away, then type '
            f"'{answer}':",
        )
        # A closed stdin gives an empty line, which is refused
        if sys.stdin.readline().strip() != answer:
            raise BadInput(f"Cancelled: '{answer}' was not typed, so no motor turned.")

    def describe_turn(self, turned: MotorTurnResult, right: bool) -> str:
        """Return the result of the test as text."""
        cell = (
            f'; the battery voltage fell to {turned.voltage:.2f} V'
            if math.isfinite(turned.voltage)
            else ''
        )
        text = (
            f'Motor {self.motor} turned at up to {turned.duty:.0%} duty, the others at '
            f'{turned.others:.0%}{cell}.'
        )
        if right:
            return (
                f'{text} Check that the right rotor turned, and that it blew in the right '
                'direction.'
            )
        return f'{text} This differs from the command; check the firmware before flying.'

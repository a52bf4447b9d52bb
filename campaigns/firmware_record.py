# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the firmware's builds do, as `test/golden/crazyflie_firmware.json` keeps it."""

from collections.abc import Iterator
from pathlib import Path
import re
import struct
import time
from typing import Any, Final

from firmware_scenarios import (
    APP,
    ARM,
    changes,
    duties,
    FULL,
    PERIOD,
    Sample,
    Scenario,
    SCENARIOS,
    set_by_name,
    U8,
    U16,
)
from lta_emulation.crazyflie.log_blocks import BASIC, PARAMETER_TYPES

from campaigns.linux_crazyflie import Process, RealPlayer, TooLate

PARAMETERS: Final = (  # that the bridge reads, writes or warns of, and examples of cflib
    'commander.enHighLevel', 'kalman.resetEstimation', 'lta.app', 'lta.compensated',
    'motorPowerSet.enable',
    'motorPowerSet.m1', 'motorPowerSet.m2', 'motorPowerSet.m3', 'motorPowerSet.m4',
    'pid_attitude.pitch_kd', 'pid_attitude.yaw_kd', 'powerDist.idleThrust',
    'stabilizer.controller', 'stabilizer.estimator', 'stabilizer.stop',
    'supervisor.landedTimeout', 'supervisor.prefltTimeout', 'supervisor.tmblChckEn',
)  # fmt: skip
VOLTAGES: Final = (3.3, 3.7, 4.1)  # V
DUTIES: Final = (0.0, 0.05, 0.1, 0.11, 0.2, 0.3, 0.5, 0.7, 1.0)
TRIES: Final = 5
SETTLES: Final = 1.0  # s for the firmware's low pass of the voltage (0.1 s) and for pm's samples
CONFIG: Final = {
    'requires_arming': 'CONFIG_MOTORS_REQUIRE_ARMING',
    'idle_thrust': 'CONFIG_MOTORS_DEFAULT_IDLE_THRUST',
    'compensated': 'CONFIG_ENABLE_THRUST_BAT_COMPENSATED',
    'app': 'CONFIG_APP_ENABLE',
}
WRITES: Final = {  # to supervisor.landedTimeout, of two bytes and 3000 by default
    'exact': b'\xd0\x07', 'one byte too many': b'\xd0\x07\x01', 'one byte too few': b'\xd0',
    'none': b'',
}  # fmt: skip


def config_of(program: Path) -> dict[str, int]:
    """Return the settings of a build that concern motors; 0 where one is off."""
    text = (program.parent / 'kconfig/include/generated/autoconf.h').read_text()
    found = dict(re.findall(r'#define (CONFIG_\w+) (\d+)', text))
    return {name: int(found.get(key, 0)) for name, key in CONFIG.items()}


def contents(player: RealPlayer) -> dict[str, tuple[int, int]]:
    """Return the number and the type of every parameter, by its name."""
    count = struct.unpack('<H', player.ask((2, 0, b'\x03'))[1:3])[0]
    found = {}
    for number in range(count):
        answer = player.ask((2, 0, struct.pack('<BH', 2, number)))
        group, name = answer[4:].split(b'\0')[:2]
        found[f'{group.decode()}.{name.decode()}'] = (number, answer[3])
    return found


def read(player: RealPlayer, number: int, kind: int) -> float:
    """Return a parameter's value."""
    answer = player.ask((2, 1, struct.pack('<H', number)))
    return float(struct.unpack_from('<' + PARAMETER_TYPES[kind & BASIC], answer, 3)[0])


def parameters_of(player: RealPlayer) -> dict[str, list[float]]:
    """Return type and default of each of `PARAMETERS` that there is."""
    found = contents(player)
    return {
        name: [found[name][1], read(player, *found[name])] for name in PARAMETERS if name in found
    }


def writes_of(program: Path) -> dict[str, dict[str, Any]]:
    """Return what becomes of parameter writes of each length: the answer's size, the value."""
    told = {}
    for name, data in WRITES.items():
        with Process(program) as process, RealPlayer(process) as player:
            number, kind = contents(player)['supervisor.landedTimeout']
            answer = player.answer((2, 2, struct.pack('<H', number) + data))
            told[name] = {
                'answered': len(answer) if answer is not None else None,
                'value': read(player, number, kind),
            }
    return told


def ratios_of(program: Path, voltage: float) -> Iterator[tuple[float, float, float]]:
    """Yield duty, ratio and compare value [1] at a voltage, through the app or motors.c itself."""
    by_app = program.parent.name == APP
    with Process(program) as process, RealPlayer(process) as player:
        process.set('voltage', voltage)
        player.wait_until_ready()
        player.send(ARM)
        if not by_app:  # motors.c: 3 is to try the compensation with the duty of m1
            player.send(set_by_name('motorPowerSet.enable', U8, 3))
        number = 0
        for duty in DUTIES:
            until = time.monotonic() + SETTLES
            while time.monotonic() < until:
                number += 1
                player.send(
                    duties(duty)(number)
                    if by_app
                    else set_by_name('motorPowerSet.m1', U16, round(FULL * duty))
                )
                time.sleep(PERIOD)
            bench = process.look()
            yield duty, bench.ratios[1] / FULL, bench.compares[1] / 255


def scenarios_of(program: Path) -> dict[str, list[list[Any]]]:
    """Return the outcome of every script of a build."""
    told = {}
    for name, scenario in SCENARIOS.items():
        if program.parent.name in scenario.builds:
            seen = changes(in_time(program, scenario), scenario.since)
            told[name] = [[round(one.time, 2), one.word, one.motors] for one in seen]
    return told


def in_time(program: Path, scenario: Scenario) -> list[Sample]:
    """Play a script; once more where the machine was too busy to play it at its times."""
    for _ in range(TRIES):
        with Process(program) as process, RealPlayer(process) as player:
            try:
                return player.play(scenario)
            except TooLate:
                continue
    raise SystemExit(f'The machine is too busy to play "{scenario.about}"; end other programs.')


def record(program: Path) -> dict[str, Any]:
    """Return everything that is kept of a build."""
    with Process(program) as process, RealPlayer(process) as player:
        parameters = parameters_of(player)
    return {
        'config': config_of(program),
        'parameters': parameters,
        'parameter_writes': writes_of(program),
        'ratios': {
            f'{voltage:g}': [[round(x, 4) for x in row] for row in ratios_of(program, voltage)]
            for voltage in VOLTAGES
        },
        'scenarios': scenarios_of(program),
    }

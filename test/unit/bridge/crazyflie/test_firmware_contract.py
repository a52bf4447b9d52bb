# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The emulator does what the real firmware did: `make campaign firmware` kept it, commit and all.

The same scripts, played to the emulator at a clock of its own; words, motors and their times must
be those of test/golden/crazyflie_firmware.json.
"""

import hashlib
import json
from pathlib import Path
import struct

from bench_body import BenchBody
from firmware_scenarios import (
    APP,
    app_files,
    ARMING,
    Change,
    changes,
    disagreement,
    due,
    PERIOD,
    Sample,
    SCENARIOS,
    SOLD,
)
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_emulation.crazyflie.firmware import CrtpPacket, Firmware
from lta_emulation.crazyflie.log_blocks import BASIC, EXTENDED, PARAMETER_TYPES, READ_ONLY
from lta_emulation.crazyflie.parameters import APP as APP_BUILD
from lta_emulation.crazyflie.parameters import ARMING as ARMING_BUILD
from lta_emulation.crazyflie.parameters import AS_SOLD, list_parameters
from lta_model.effects.motors import BATTERY_COMPENSATION
from lta_model.state import SURROUNDINGS, VOLTAGE
import pytest

KEPT = json.loads(
    (Path(__file__).resolve().parents[3] / 'golden/crazyflie_firmware.json').read_text()
)
BUILDS = {SOLD: AS_SOLD, ARMING: ARMING_BUILD, APP: APP_BUILD}
LATE = 0.15  # s: the firmware judges 25 times a second, and a sample takes 20 ms more
SETTLED = 1.0  # s after which an emulated drone has passed its own checks
FULL = 65535


def played(name, build):
    """Return the changes of a script that is played to the emulator."""
    scenario, drone = SCENARIOS[name], Firmware(BenchBody(), build=build)
    samples, last = [], 0.0
    for turn in range(round(SETTLED / PERIOD)):
        drone.tick(turn * PERIOD)
    for turn in range(round(scenario.seconds / PERIOD)):
        now = turn * PERIOD
        if any(last <= at < now for at, _, _ in scenario.bench):
            drone.acceleration = (0.0, 0.0, -1.0)
        for packet in due(scenario, last, now):
            drone.receive(CrtpPacket(*packet), SETTLED + now)
        drone.tick(SETTLED + now)
        ratios = tuple(round(FULL * duty) for duty in drone.body.duties)
        samples.append(Sample(now, drone.supervisor.word, ratios))
        last = now
    return changes(samples, scenario.since)


@pytest.mark.parametrize(
    ('build', 'name'),
    [(build, name) for name, scenario in SCENARIOS.items() for build in scenario.builds],
)
def test_the_emulator_does_what_the_firmware_did(build, name):
    kept = [Change(*row) for row in KEPT['builds'][build]['scenarios'][name]]
    begun = [one for one in kept if one.time <= SCENARIOS[name].since]
    kept = kept[max(0, len(begun) - 1) :]
    seen = played(name, BUILDS[build])
    if name == 'upside down':
        # A body that falls is weightless, and not tumbled until it lies; the clamped one is.
        seen, kept = without(seen, SupervisorBit.TUMBLED), without(kept, SupervisorBit.TUMBLED)
    assert disagreement(seen, kept, LATE) == ''


def without(told, bit):
    """Return changes without one bit of the word, and without those that only it made."""
    left = [one._replace(word=one.word & ~bit) for one in told]
    return [one for before, one in zip([None, *left], left, strict=False)
            if before is None or before[1:] != one[1:]]  # fmt: skip


def test_the_record_is_of_the_present_app():
    """Or run `make campaign firmware ARGS='--firmware /path --record'` again."""
    digest = hashlib.sha256()
    for path in sorted(app_files()):
        digest.update(path.read_bytes())
    for kept in KEPT['builds'].values():
        assert kept['ours'] == digest.hexdigest()[:12]


def test_our_build_has_no_idle_thrust_and_no_compensation():
    assert KEPT['builds'][APP]['config'] == {
        'requires_arming': 1,
        'idle_thrust': 0,
        'compensated': 0,
        'app': 1,
    }


@pytest.mark.parametrize('build', BUILDS)
def test_its_parameters_have_the_firmwares_types_and_values(build):
    """But for the mark of core parameters, which nothing here reads."""
    drone = Firmware(BenchBody(), build=BUILDS[build])
    entries = {entry.name: entry for entry in list_parameters(BUILDS[build])}
    matters = BASIC | EXTENDED | READ_ONLY
    kept = KEPT['builds'][build]['parameters']
    assert {name: drone.parameters.values[name] for name in kept} == pytest.approx(
        {name: value for name, (_, value) in kept.items()},
        rel=1e-7,  # of single precision
    )
    assert {name: entries[name].kind & matters for name in kept} == {
        name: kind & matters for name, (kind, _) in kept.items()
    }


@pytest.mark.parametrize('length', KEPT['builds'][APP]['parameter_writes'])
def test_it_takes_writes_of_every_length_as_the_firmware_does(length):
    """Extra bytes are ignored, missing ones are what an earlier packet left."""
    data = {'exact': b'\xd0\x07', 'one byte too many': b'\xd0\x07\x01',
            'one byte too few': b'\xd0', 'none': b''}[length]  # fmt: skip
    kept = KEPT['builds'][APP]['parameter_writes'][length]
    drone = Firmware(BenchBody())
    names = [entry.name for entry in list_parameters(APP_BUILD)]
    number = names.index('supervisor.landedTimeout')
    told = drone.receive(CrtpPacket(2, 2, struct.pack('<H', number) + data), 0.0)
    assert len(told[0].data) == kept['answered']
    if len(data) >= struct.calcsize(PARAMETER_TYPES[9]):
        assert drone.parameters.values['supervisor.landedTimeout'] == kept['value']


@pytest.mark.parametrize('voltage', KEPT['builds'][SOLD]['ratios'])
def test_our_build_passes_duties_on_and_the_vehicle_file_has_the_curve_of_others(voltage):
    """Within a step of the 8-bit PWM and the rounding of the record."""
    for duty, ratio, compare in KEPT['builds'][APP]['ratios'][voltage]:
        assert ratio == pytest.approx(duty, abs=1e-2 * duty + 2e-4)
        assert compare == pytest.approx(duty, abs=1 / 255)
    given = load_vehicle_file('multirotor').effects['battery_compensation']
    values = tuple(given[parameter.name].si for parameter in BATTERY_COMPENSATION.shared)
    surroundings = [0.0] * SURROUNDINGS
    surroundings[VOLTAGE] = float(voltage)
    for duty, ratio, _ in KEPT['builds'][SOLD]['ratios'][voltage]:
        told = BATTERY_COMPENSATION.output(values, (), duty, tuple(surroundings))
        assert told == pytest.approx(ratio, abs=2e-3)

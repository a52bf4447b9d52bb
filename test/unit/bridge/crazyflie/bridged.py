# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A bridge in flight at a clock of its own, and a link that keeps what was sent."""

import math

from lta_bridge.crazyflie.bridge_core import BridgeCore, CrazyflieCommand, PositionEstimate
from lta_bridge.crazyflie.link import LogPacket
from lta_bridge.crazyflie.safety import SafetyRequest as AskedBy
from lta_bridge.crazyflie.safety import SafetyStage
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_config.schema.crazyflie_file import load_crazyflie
from lta_model.vehicle import load_vehicle, Vehicle

FILE = load_crazyflie('gtmab')
TICK = 20_000_000  # ns
DUTIES = (0.1, 0.2, 0.3, 0.4)
NOTHING = AskedBy()


def tilt_rotors(axes):
    """Return GT-MAB with other axes of some rotors."""
    file = load_vehicle('gtmab').file
    rotors = dict(file.rotors)
    for name, axis in axes.items():
        turned = rotors[name].axis.model_copy(update={'value': axis})
        rotors[name] = rotors[name].model_copy(update={'axis': turned})
    return Vehicle(file.model_copy(update={'rotors': rotors}))


class Kept:
    """A link that keeps what was sent."""

    def __init__(self):
        self.said, self.options = [], []

    def __getattr__(self, name):
        def keep(*words, **options):
            self.said.append((name, words))
            self.options.append((name, options))

        return keep

    def options_of(self, name):
        return [options for said, options in self.options if said == name]

    def of(self, name):
        return [words for said, words in self.said if said == name]


class Bridged:
    """A bridge, and what its drone and its graph tell it at every tick."""

    def __init__(self, command='motors', watchdog=False, axes=None, blind=False):
        self.kept, self.now, self.word = Kept(), 0, SupervisorBit.ARMED
        self.bridge = BridgeCore(
            self.kept, FILE, tilt_rotors(axes or {}), command, watchdog, blind
        )
        self.turning = (0.0,) * 4  # what the drone says that its motors do
        self.linked = self.active = self.commands = self.logs = True
        self.height, self.noise = 1.0, 1e-6  # no height of a flight repeats to the bit
        # mbar and mm, and the smallest step of each
        self.air = {'baro.pressure': (1000.0, 1e-3), 'range.zrange': (800.0, 1.0)}
        self.power = {'pm.vbat': 4.0, 'pm.state': 0}
        self.asked = CrazyflieCommand(0, duties=DUTIES)

    @property
    def stage(self):
        return self.bridge.state.stage

    def fly(self):
        self.tick(AskedBy(arm=True))
        for _ in range(3):
            self.tick()
        assert self.stage is SafetyStage.FLYING
        return self

    def tick(self, asked=NOTHING):
        self.now += TICK
        if self.logs:
            values = {f'motor.m{n}': 65535.0 * duty for n, duty in enumerate(self.turning, 1)}
            values['supervisor.info'] = self.word
            odd = self.now // TICK % 2
            air = {name: value + odd * step for name, (value, step) in self.air.items()}
            for name, told in (('motors', values), ('power', self.power), ('air', air)):
                self.bridge.receive_packet(LogPacket(name, self.now // 1_000_000, told, self.now))
        if self.commands:
            self.bridge.accept_command(self.asked._replace(stamp_ns=self.now))
        if not math.isnan(self.height):
            height = self.height + self.noise * (self.now // TICK % 2)
            self.bridge.update_position(PositionEstimate(height, 1.0, self.now))
        self.bridge.tick(1e-9 * self.now, self.now, self.linked, self.active, asked)

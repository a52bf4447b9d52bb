# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Decode the supervisor's 16-bit status word, sent in `supervisor.info` and on port 9."""

from enum import IntFlag


class SupervisorBit(IntFlag):
    """Bits of the status word (crazyflie-firmware, supervisor.c, 2026.08)."""

    CAN_BE_ARMED = 1 << 0
    ARMED = 1 << 1
    AUTO_ARM = 1 << 2
    CAN_FLY = 1 << 3
    FLYING = 1 << 4
    TUMBLED = 1 << 5
    LOCKED = 1 << 6
    CRASHED = 1 << 7
    HIGH_LEVEL = 1 << 8
    TRAJECTORY_FINISHED = 1 << 9
    HIGH_LEVEL_DISABLED = 1 << 10
    DECK_FAULT = 1 << 11


TROUBLE: dict[SupervisorBit, str] = {
    SupervisorBit.LOCKED: 'the firmware has locked the motors: switch the Crazyflie off and on',
    SupervisorBit.CRASHED: 'the Crazyflie has crashed: set it upright, and switch it off and on',
    SupervisorBit.TUMBLED: 'the Crazyflie has tipped over: set it upright',
    SupervisorBit.DECK_FAULT: 'an expansion deck failed its self-test: check that it is plugged '
    'in correctly, and switch the Crazyflie off and on',
}


def explain_fault(word: int) -> str:
    """Return why the motors may not turn, with the remedy; empty if they may."""
    return next((text for bit, text in TROUBLE.items() if word & bit), '')

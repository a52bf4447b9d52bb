# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Results of hardware and system checks."""

from dataclasses import dataclass
from typing import final, Literal

MEGABYTE = 1_000_000
State = Literal['ok', 'warn', 'fail']


@final
@dataclass(frozen=True, slots=True)
class HardwareCheck:
    """The result of one check."""

    name: str  # subject of the check
    # `fail`: LTA cannot fly like this. `warn`: something will be slow or left out. 'ok', 'warn',
    # 'fail'
    state: State
    found: str  # the finding, with its figures
    remedy: str = ''  # what to do, in one sentence; empty if nothing needs doing


def grade_value(
    name: str, figure: float, warn: float, fail: float, finding: str, remedy: str
) -> HardwareCheck:
    """Return a check that warns or fails if the figure is below the respective limit."""
    state: State = 'ok' if figure >= warn else 'warn' if figure >= fail else 'fail'
    return HardwareCheck(name, state, finding, '' if state == 'ok' else remedy)


def assess_vehicle(name: str, commit: int, built: int, expected: int) -> HardwareCheck:
    """
    Check for which vehicle a board's firmware was built.

    `built` and `expected` are hashes of `lta_config.schema.crazyflie_file`, `commit` the first
    eight digits of the firmware's commit; 0 is unknown.
    """
    version = f'firmware of commit {commit:08x}' if commit else 'firmware of unknown commit'
    if built == expected:
        return HardwareCheck(name, 'ok', f'{version}, built for this vehicle ({built:08x})')
    remedy = 'Give the vehicle file of this drone with --vehicle, or flash it by "make firmware".'
    if not built:
        return HardwareCheck(name, 'warn', f'{version}, built for no vehicle', remedy)
    finding = f'{version}, built for another vehicle ({built:08x} instead of {expected:08x})'
    return HardwareCheck(name, 'fail', finding, remedy)

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A pilot of the independent simulator who commands one step, or nothing at all."""


class StepPilot:
    """A pilot who commands one force [N] or moment [N m] from a second on."""

    def __init__(self, axis: int = 0, size: float = 0.0) -> None:
        self._axis, self._size = axis, size

    def initial_duties(self) -> list[float]:
        """Return no command."""
        return [0.0] * 6

    def compute_duties(self, time: float, state: list[float]) -> list[float]:
        """Return the command at a time."""
        return [self._size * (k == self._axis and time >= 1.0) for k in range(6)]

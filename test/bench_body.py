# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A Crazyflie that does not move, below an emulated firmware."""

from collections.abc import Mapping

from lta_emulation.crazyflie.commander import BodyCommand, STOPPED_DUTIES


class BenchBody:
    """A Crazyflie clamped to a bench: motors turn, the body does not move."""

    def __init__(self) -> None:
        self.duties: tuple[float, ...] = STOPPED_DUTIES
        self._reads = 0

    def advance(self, now: float, wish: BodyCommand) -> None:
        """Turn the motors; hover and landing use half duty."""
        duties = wish.duties
        if duties is None:
            duties = (0.5,) * 4 if wish.hover is not None or wish.land else STOPPED_DUTIES
        self.duties = tuple(max(wish.idle, duty) for duty in duties)

    def read_log_values(self) -> Mapping[str, float]:
        """Return the sensor values of a Crazyflie at rest."""
        # Units of the firmware: g, mm, mbar
        self._reads += 1
        odd = self._reads % 2  # no sensor repeats its reading to the bit
        return {
            'acc.z': 1.0, 'range.zrange': 450.0 + odd, 'baro.pressure': 1013.25 + 1e-3 * odd,
        }  # fmt: skip

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hold one simulated vehicle as a row of numbers that compiled code reads and changes in place."""

from functools import cache
from types import ModuleType
from typing import final

from lta_config.compilation.kernel_cache import is_cached, load_kernel
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import (
    AXES,
    EffectParameter,
    Values,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_model.model import VehicleModel
from lta_sim.kernels.compose import build_layout, render_kernel_source
from lta_sim.kernels.row import row_slices
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIM_LAYOUT = build_layout(EFFECTS)


def _pass_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the commanded wrench."""
    x, y, z, k, m, n = p
    return (x, y, z, k, m, n)


# Of vehicles whose record has commanded forces and moments in place of duties. No vehicle file has
# it: a flight of recorded commands writes its numbers
COMMANDED = WrenchEffect(
    'commanded_wrench',
    tuple(
        EffectParameter(axis, unit, 0.0, -1e3, 1e3, 1.0, 'a command')
        for axis, unit in zip(AXES, 3 * ('N',) + 3 * ('N m',), strict=True)
    ),
    _pass_wrench,
)
SIMULATED_EFFECTS = {**EFFECTS, COMMANDED.name: COMMANDED}
SIMULATED_LAYOUT = build_layout(SIMULATED_EFFECTS)


@cache
def _build_source() -> str:
    """Return the source of the kernel with all effects."""
    # A kernel of a vehicle's own effects would save 1 us of the 60 us of a control step, and take
    # 6 s to compile: it pays after half a day of flight (docs/validation.md)
    return render_kernel_source(SIMULATED_EFFECTS)


@cache
def _load_kernel() -> ModuleType:
    """Load the kernel with all effects."""
    return load_kernel(_build_source())


def is_compiled() -> bool:
    """Return whether the kernel is compiled."""
    return is_cached(_build_source())


@final
class SimulatedVehicle:
    """
    One vehicle whose state, command and surroundings are views of the kernel's row.

    Nothing is checked. Assign into the arrays and do not replace them.

    Parameters
    ----------
    model : VehicleModel
        The vehicle.
    commanded : bool
        Whether forces and moments are commanded in place of duties: `commanded_wrench`, body
        frame, shape (6,). [N, N m]

    """

    def __init__(self, model: VehicleModel, *, commanded: bool = False) -> None:
        self._places = row_slices(SIMULATED_LAYOUT)
        self._row: Array = np.zeros(max(part.stop for part in self._places.values()))
        self._on = np.append(model.on, np.uint8(commanded))
        kernel = _load_kernel()
        self._derivative, self._advance = kernel.derivative, kernel.advance
        parameters = self._view_part('parameters')
        parameters[: len(model.parameters)] = model.parameters
        self.commanded_wrench = parameters[len(model.parameters) :]
        for name in ('body', 'inverse'):
            self._row[self._places[name]] = getattr(model, name)
        self.state, self.command = self._view_part('state'), self._view_part('command')
        self.surroundings, self.body = self._view_part('surroundings'), self._view_part('body')
        self.rate, self.thrusts, self.wind = map(self._view_part, ('rate', 'thrusts', 'wind'))
        # Of the effects of `SIM_LAYOUT`; that of a command comes last
        self.wrenches = self._view_part('wrenches').reshape(-1, 6)[:-1]

    def _view_part(self, name: str) -> Array:
        """Return a view of a part of the row."""
        return self._row[self._places[name]]

    def evaluate_state(self) -> None:
        """Update `rate`, `wrenches`, `thrusts` and `wind` for the present state."""
        self._derivative(self._row, self._on)

    def advance(self, dt: float, steps: int) -> None:
        """
        Take classical Runge-Kutta steps; the quaternion is normalised after each.

        `dt` must be below about 2.7 times the shortest time constant. [s]
        """
        self._advance(self._row, self._on, dt, steps)

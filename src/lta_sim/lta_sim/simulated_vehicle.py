"""Hold one simulated vehicle as a row of numbers that compiled code reads and changes in place."""

from functools import cache
from types import ModuleType
from typing import final

from lta_config.compilation.kernel_cache import is_cached, load_kernel
from lta_model.effects import LAW, MODEL_EFFECTS
from lta_model.model import VehicleModel
from lta_sim.kernels.compose import build_layout, render_kernel_source
from lta_sim.kernels.row import row_slices
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LAYOUT = build_layout(MODEL_EFFECTS)
PLACES = row_slices(LAYOUT)


@cache
def _build_source(law: bool) -> str:
    """Return the source of the kernel with all effects, with or without a law."""
    # A kernel for each set of effects would save 14 % of a step and take 5 s to compile: it pays
    # after a day of flight (docs/inside.md). Without a law, which is long, one serves all vehicles
    included = [name for name in LAYOUT.effects if law or name != LAW.name]
    return render_kernel_source(MODEL_EFFECTS, included=included)


@cache
def _load_kernel(law: bool) -> ModuleType:
    """Load the kernel with all effects, with or without a law."""
    return load_kernel(_build_source(law))


def is_compiled() -> bool:
    """Return whether the kernel of vehicles without a law is compiled, as after an edit it is not."""
    return is_cached(_build_source(law=False))


@final
class SimulatedVehicle:
    """
    One vehicle whose state, command and surroundings are views of the kernel's row.

    Nothing is checked. Assign into the arrays and do not replace them.
    """

    def __init__(self, model: VehicleModel) -> None:
        self._row: Array = np.zeros(max(part.stop for part in PLACES.values()))
        self._on = model.on
        kernel = _load_kernel(bool(model.on[LAYOUT.flag_index(LAW.name)]))
        self._derivative, self._advance = kernel.derivative, kernel.advance
        for name in ('parameters', 'body', 'inverse'):
            self._row[PLACES[name]] = getattr(model, name)
        self.state, self.command = self._view_part('state'), self._view_part('command')
        self.surroundings, self.body = self._view_part('surroundings'), self._view_part('body')
        self.rate, self.thrusts, self.wind = map(self._view_part, ('rate', 'thrusts', 'wind'))
        self.wrenches = self._view_part('wrenches').reshape(-1, 6)

    def _view_part(self, name: str) -> Array:
        """Return a view of a part of the row."""
        return self._row[PLACES[name]]

    def evaluate_state(self) -> None:
        """Update `rate`, `wrenches`, `thrusts` and `wind` for the present state."""
        self._derivative(self._row, self._on)

    def advance(self, dt: float, steps: int) -> None:
        """
        Take classical Runge-Kutta steps; the quaternion is normalised after each.

        `dt` must be below about 2.7 times the shortest time constant. [s]
        """
        self._advance(self._row, self._on, dt, steps)

"""A vehicle in flight: its numbers in one row, which compiled code reads and changes in place."""

from functools import cache
from types import ModuleType
from typing import final

from lta_config.compilation.kernel_cache import is_kept, load
from lta_model.effects import EFFECTS
from lta_model.model import Model
from lta_sim.kernels.compose import kernel_source, layout_of
from lta_sim.kernels.row import places
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LAYOUT = layout_of(EFFECTS)
PLACES = places(LAYOUT)


@cache
def _source() -> str:
    """Return the text of the kernel of all effects."""
    return kernel_source(EFFECTS)


@cache
def _kernel() -> ModuleType:
    """Return the kernel of all effects."""
    return load(_source())


def is_compiled() -> bool:
    """Tell whether the model is compiled already: a new or edited effect compiles it anew."""
    return is_kept(_source())


@final
class Craft:
    """
    One vehicle whose state, command and surroundings are written where the kernel reads them.

    Nothing is looked at: write numbers into the arrays, and do not put other arrays in their
    places.

    Parameters
    ----------
    model : Model
        The vehicle.

    Attributes
    ----------
    state, command, surroundings : ndarray of float64
        In the layouts of `lta_model.state`; `advance` changes the state.
    rate : ndarray of float64, shape (N,)
        d/dt of the state, of the last `look`. [1/s]
    wrenches : ndarray of float64, shape (W, 6)
        Force and moment about the hull centre, body frame, by wrench effect, of the last `look`.
        [N, N m]
    thrusts : ndarray of float64, shape (ACTUATORS,)
        Of each rotor, of the last `look`. [N]
    wind : ndarray of float64, shape (3,)
        Velocity of the air at the hull, `map`, of the last `look`. [m/s]

    """

    def __init__(self, model: Model) -> None:
        self._row: Array = np.zeros(max(part.stop for part in PLACES.values()))
        self._on = model.on
        self._derivative, self._advance = _kernel().derivative, _kernel().advance
        for name in ('parameters', 'body', 'inverse'):
            self._row[PLACES[name]] = getattr(model, name)
        self.state, self.command = self._part('state'), self._part('command')
        self.surroundings = self._part('surroundings')
        self.rate, self.thrusts, self.wind = map(self._part, ('rate', 'thrusts', 'wind'))
        self.wrenches = self._part('wrenches').reshape(-1, 6)

    def _part(self, name: str) -> Array:
        """Return a part of the row, not a copy of it."""
        return self._row[PLACES[name]]

    def look(self) -> None:
        """Set `rate`, `wrenches`, `thrusts` and `wind` to those of the present state."""
        self._derivative(self._row, self._on)

    def advance(self, dt: float, steps: int) -> None:
        """
        Take classical Runge-Kutta steps; the quaternion is normalised after each.

        Parameters
        ----------
        dt : float
            Length of a step; below about 2.7 times the shortest time constant. [s]
        steps : int
            Number of steps.

        """
        self._advance(self._row, self._on, dt, steps)

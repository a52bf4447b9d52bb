"""Many vehicles as the numbers that the batched kernels take."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final, Self

from lta_config.errors import BadInput
from lta_sim.compose import FIXED
from lta_sim.effects import EFFECTS, initial_memory
from lta_sim.model import Model
from lta_sim.state import ACTUATORS, RIGID
import numpy as np
from numpy.typing import ArrayLike, NDArray

Numbers = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Fleet:
    """
    The models of V vehicles, a row each.

    Parameters
    ----------
    parameters : ndarray, shape (V, P)
        Parameters of all effects in registry order.
    body : ndarray, shape (V, 16)
        As in `Model`.
    inverse : ndarray, shape (V, 36)
        As in `Model`.

    """

    parameters: Numbers
    body: Numbers
    inverse: Numbers

    @classmethod
    def of(cls, models: Sequence[Model]) -> Self:
        """
        Return the fleet of some models, one a vehicle.

        Raises
        ------
        BadInput
            If there are none.

        """
        if not models:
            raise BadInput('A fleet of 0 vehicles was asked for; give at least one.')
        return cls(
            np.stack([model.parameters for model in models]),
            np.stack([model.body for model in models]),
            np.stack([model.inverse for model in models]),
        )

    def __len__(self) -> int:
        """Return the number of vehicles."""
        return len(self.parameters)


def _rows(what: str, values: ArrayLike, vehicles: int, count: int) -> Numbers:
    """Return a float64 array of that many rows and columns."""
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (vehicles, count):
        # Compiled code does not look: it would read what lies behind the array.
        raise ValueError(f'The {what} have shape {array.shape}; it must be ({vehicles}, {count}).')
    return array


def columns(
    states: ArrayLike, fleet: Fleet, duties: ArrayLike, winds: ArrayLike
) -> tuple[Numbers, Numbers]:
    """
    Return what a kernel takes, a column a vehicle, so that neighbours lie side by side.

    Parameters
    ----------
    states : array_like, shape (V, N)
        Layout of `lta_sim.state`, SI.
    fleet : Fleet
        The vehicles.
    duties : array_like, shape (V, 4)
        Commanded duty of each rotor, -1 to 1.
    winds : array_like, shape (V, 3)
        Steady uniform velocity of the air in `map`. [m/s]

    Returns
    -------
    fixed : ndarray, shape (P + 59, V)
        What each vehicle keeps, in the order of `compose.FIXED`.
    state : ndarray, shape (N, V)
        Its state.

    Raises
    ------
    ValueError
        If an array has the wrong shape.

    """
    count = len(fleet)
    known = sum(len(effect.parameters) for effect in EFFECTS.values())
    fixed = (
        _rows('parameters', fleet.parameters, count, known),
        _rows('bodies', fleet.body, count, FIXED['body']),
        _rows('inverses', fleet.inverse, count, FIXED['inverse']),
        _rows('duties', duties, count, ACTUATORS),
        _rows('winds', winds, count, 3),
    )
    state = _rows('states', states, count, RIGID + len(initial_memory()))
    return np.concatenate([part.T for part in fixed]), np.ascontiguousarray(state.T)

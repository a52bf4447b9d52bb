"""Many vehicles as input arrays of the batched kernels."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final, Self

from lta_config.errors import BadInput
from lta_model.model import VehicleModel
from lta_model.state import COMMAND, SURROUNDINGS
from lta_sim.kernels.kernel import LAYOUT
from lta_sim.kernels.layout import FIXED
import numpy as np
from numpy.typing import ArrayLike, NDArray

Numbers = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True, eq=False)
class VehicleBatch:
    """
    The models of V vehicles, a row each, as in `VehicleModel`.

    Parameters
    ----------
    parameters : ndarray, shape (V, P)
        Parameters of the effects of the kernel in registry order.
    on : ndarray of uint8, shape (V, K)
        Which of these effects are on.
    body : ndarray, shape (V, BODY)
        What each vehicle is.
    inverse : ndarray, shape (V, 36)
        Inverse of its mass matrix.

    """

    parameters: Numbers
    on: NDArray[np.uint8]
    body: Numbers
    inverse: Numbers

    @classmethod
    def from_models(cls, models: Sequence[VehicleModel]) -> Self:
        """
        Return the fleet of some models, one a vehicle.

        Raises
        ------
        BadInput
            If there are none.

        """
        if not models:
            raise BadInput('A fleet needs at least one vehicle, but 0 were requested.')
        return cls(
            np.stack([model.parameters for model in models]),
            np.stack([model.on for model in models]),
            np.stack([model.body for model in models]),
            np.stack([model.inverse for model in models]),
        )

    def __len__(self) -> int:
        """Return the number of vehicles."""
        return len(self.parameters)

    def select_vehicles(self, which: NDArray[np.int64]) -> 'VehicleBatch':
        """Return some of the vehicles, by number; one may be taken more than once."""
        return VehicleBatch(
            self.parameters[which], self.on[which], self.body[which], self.inverse[which]
        )


def _to_rows(what: str, values: ArrayLike, vehicles: int, count: int, *, fill: bool) -> Numbers:
    """Return a float64 array of that many rows and columns, filled with zeros where allowed."""
    array = np.asarray(values, dtype=np.float64)
    fits = array.ndim == 2 and array.shape[0] == vehicles
    if not (fits and (array.shape[1] == count or (fill and array.shape[1] < count))):
        # Compiled code has no bounds check: a short array would be read beyond its end.
        raise ValueError(f'The {what} have shape {array.shape}; it must be ({vehicles}, {count}).')
    return np.pad(array, ((0, 0), (0, count - array.shape[1])))


def pack_columns(
    states: ArrayLike, vehicles: VehicleBatch, commands: ArrayLike, surroundings: ArrayLike
) -> tuple[Numbers, Numbers]:
    """
    Return what a kernel takes, a column a vehicle, so that neighbours lie side by side.

    Parameters
    ----------
    states : array_like, shape (V, N)
        Layout of `lta_model.state`, SI.
    fleet : Fleet
        The vehicles.
    commands : array_like, shape (V, up to COMMAND)
        Duties and the place of the moving mass.
    surroundings : array_like, shape (V, up to SURROUNDINGS)
        Wind, noise, irradiance, voltage.

    Returns
    -------
    fixed : ndarray, shape (`columns.rows(LAYOUT)`, V)
        What each vehicle keeps: parameters, then in the order of `stages.FIXED`.
    state : ndarray, shape (N, V)
        Its state.

    Raises
    ------
    ValueError
        If an array has the wrong shape.

    """
    count = len(vehicles)
    fixed = (
        _to_rows('parameters', vehicles.parameters, count, LAYOUT.parameters, fill=False),
        _to_rows('bodies', vehicles.body, count, FIXED['body'], fill=False),
        _to_rows('inverses', vehicles.inverse, count, FIXED['inverse'], fill=False),
        _to_rows('commands', commands, count, COMMAND, fill=True),
        _to_rows('surroundings', surroundings, count, SURROUNDINGS, fill=True),
    )
    state = _to_rows('states', states, count, LAYOUT.size, fill=False)
    return np.concatenate([part.T for part in fixed]), np.ascontiguousarray(state.T)

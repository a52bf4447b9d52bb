"""Many vehicles as input arrays of the batched kernels."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final, Self

from lta_config.errors import BadInput
from lta_model.effects import BUILT_IN, EFFECTS
from lta_model.effects.protocol import ActuatorEffect
from lta_model.model import VehicleModel
from lta_model.state import ACTUATORS, COMMAND, ROTOR, ROTOR_PLACE, SURROUNDINGS
from lta_sim.kernels.layout import FIXED
from lta_sim.simulated_vehicle import LAYOUT
import numpy as np
from numpy.typing import ArrayLike, NDArray

Numbers = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True, eq=False)
class VehicleBatch:
    """Models of V vehicles, one row each, as in `VehicleModel`."""

    parameters: Numbers  # parameters of the kernel's effects in registry order, shape (V, P)
    on: NDArray[np.uint8]  # flags of these effects, shape (V, K)
    body: Numbers  # rigid-body properties, shape (V, BODY)
    inverse: Numbers  # inverse of the mass matrix, shape (V, 36)

    @classmethod
    def from_models(cls, models: Sequence[VehicleModel]) -> Self:
        """Build a batch from at least one model; raise BadInput if there are none."""
        if not models:
            raise BadInput('A batch needs at least one vehicle, but none was given.')
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
        """Return the vehicles with these indices, which may repeat."""
        return VehicleBatch(
            self.parameters[which], self.on[which], self.body[which], self.inverse[which]
        )


def _to_padded_array(
    what: str, values: ArrayLike, vehicles: int, count: int, *, fill: bool
) -> Numbers:
    """Return a float64 array of the given shape, padded with zeros where allowed."""
    array = np.asarray(values, dtype=np.float64)
    fits = array.ndim == 2 and array.shape[0] == vehicles
    if not (fits and (array.shape[1] == count or (fill and array.shape[1] < count))):
        # Compiled code has no bounds check: a short array would be read beyond its end.
        raise ValueError(
            f'The {what} have the shape {array.shape}; it must be ({vehicles}, {count}).'
        )
    if array.shape[1] == count:
        return array
    # Missing columns are zero: no moving mass, no noise, no light
    return np.pad(array, ((0, 0), (0, count - array.shape[1])))


def pack_blocks(parts: Sequence[Numbers], width: int) -> Numbers:
    """
    Return vehicles side by side in blocks, shape (blocks, numbers, width).

    `parts` have a row per vehicle; copies of the last vehicle fill the last block.
    """
    missing = -len(parts[0]) % width
    blocks = (len(parts[0]) + missing) // width
    packed, first = np.empty((blocks, sum(part.shape[1] for part in parts), width)), 0
    for part in parts:
        count = part.shape[1]
        filled = np.concatenate([part, np.repeat(part[-1:], missing, axis=0)]) if missing else part
        packed[:, first : first + count] = filled.reshape(blocks, width, count).swapaxes(1, 2)
        first += count
    return packed


@final
@dataclass(frozen=True, slots=True, eq=False)
class UsedNumbers:
    """Input of a kernel of those effects that some vehicle has on, a row per vehicle."""

    names: tuple[str, ...]  # effects of the kernel, in registry order
    fixed: tuple[Numbers, ...]  # constants: parameters, then `layout.FIXED`, shapes (V, each)
    state: Numbers  # states with the memory of these effects only, shape (V, N')
    places: list[int]  # of these numbers in a whole state
    whole: Numbers  # whole states, shape (V, N)

    @property
    def zeros(self) -> frozenset[int]:
        """Places of the parameters that are 0 in all vehicles."""
        return frozenset(np.flatnonzero(~self.fixed[0].any(axis=0)).tolist())

    @property
    def rotors(self) -> int:
        """Number of rotors up to the last with an axis, a command or a memory in some vehicle."""
        actuators = [name for name in self.names if isinstance(EFFECTS[name], ActuatorEffect)]
        if not set(actuators) <= set(BUILT_IN):
            return ACTUATORS  # ours have no thrust without a command, which others may have
        _, body, _, commands, _ = self.fixed
        axes = body[:, ROTOR_PLACE:].reshape(-1, ACTUATORS, ROTOR)
        used = (commands[:, :ACTUATORS] != 0.0).any(axis=0) | (axes != 0.0).any(axis=(0, 2))
        for name in actuators:
            first = LAYOUT.remembers[name]
            memory = self.whole[:, first : first + LAYOUT.memory_size(name)]
            if memory.size:
                each = memory.reshape(len(memory), ACTUATORS, -1)
                used |= (each != 0.0).any(axis=(0, 2))
        return int(np.flatnonzero(used)[-1]) + 1 if used.any() else 1

    def merge_states(self, state: Numbers) -> Numbers:
        """Return whole states, shape (V, N), with new values of the used numbers, (V, N')."""
        merged = self.whole.copy()
        # Memory of effects that are off stays unchanged
        merged[:, self.places] = state
        return merged


def select_used_numbers(
    states: ArrayLike, vehicles: VehicleBatch, commands: ArrayLike, surroundings: ArrayLike
) -> UsedNumbers:
    """Return the input of a batched kernel; raise ValueError if an array has the wrong shape."""
    count = len(vehicles)
    names = tuple(name for name in LAYOUT.effects if vehicles.on[:, LAYOUT.flag_index(name)].any())
    parameters, places = LAYOUT.find_effect_indices(names)
    own = _to_padded_array('parameters', vehicles.parameters, count, LAYOUT.parameters, fill=False)
    fixed = (
        own[:, parameters],
        _to_padded_array('bodies', vehicles.body, count, FIXED['body'], fill=False),
        _to_padded_array('inverses', vehicles.inverse, count, FIXED['inverse'], fill=False),
        _to_padded_array('commands', commands, count, COMMAND, fill=True),
        _to_padded_array('surroundings', surroundings, count, SURROUNDINGS, fill=True),
    )
    whole = _to_padded_array('states', states, count, LAYOUT.size, fill=False)
    return UsedNumbers(names, fixed, whole[:, places], places, whole)

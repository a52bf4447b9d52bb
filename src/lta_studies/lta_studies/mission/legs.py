"""Fly legs: compile their source once and call it with arrays."""

from functools import cache
from types import ModuleType
from typing import Any, final

from lta_config.compilation.flat import TupleLayout
from lta_config.compilation.kernel_cache import load_kernel
from lta_config.topics import load_topic_table
from lta_flight.batch.batch_flight import BatchFlight, build_rhythm
from lta_model.state import pack_state, RIGID
from lta_sim.compiled_sensors import draw_turbulence_memory
from lta_sim.kernels.kernel import LAYOUT
from lta_studies.mission.leg_codegen import generate_source, initial_effect_memory
from lta_studies.mission.leg_state import initial_leg_state, LegPlan, LegState
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MEMORY = TupleLayout(initial_leg_state(1.0, 1.0))


@cache
def _load_kernel(
    names: tuple[str, ...], constants: TupleLayout[Any], leg: TupleLayout[Any], diodes: int
) -> ModuleType:
    """Compile the leg for a set of effects."""
    return load_kernel(
        generate_source(names, constants, leg, MEMORY, diodes, build_rhythm(load_topic_table()))
    )


@final
class LegPilot:
    """
    Flies the legs of one vehicle in one scene.

    Parameters
    ----------
    flight : BatchFlight
        Vehicle and scene.
    leg : LegPlan
        Any plan; only its layout is used.

    """

    def __init__(self, flight: BatchFlight, leg: LegPlan) -> None:
        model = flight.model
        # Only the effects of this vehicle are compiled in; the source is cached by their names.
        self.names = tuple(n for n in LAYOUT.effects if model.on[LAYOUT.flag_index(n)])
        parameters, _ = LAYOUT.find_places(self.names)
        self._fixed = np.array([*model.parameters[parameters], *model.body, *model.inverse])
        self._craft, self._leg = TupleLayout(flight.craft), TupleLayout(leg)
        self._fly = _load_kernel(
            self.names, self._craft, self._leg, len(flight.craft.listening.planes)
        ).fly_leg

    def pack_constants(self, flight: BatchFlight) -> Array:
        """Return the constants of a flight with the same layout, shape (n,)."""
        return np.array(flight.numbers)

    def ground_state(self, x: float, y: float, z: float, heading: float, seed: int) -> Array:
        """Return the state of the model on the ground. [m, rad]"""
        memory = initial_effect_memory(self.names)
        # Rigid-body state, then the memory of the active effects only.
        state = np.array([*pack_state((x, y, z), heading)[:RIGID], *memory])
        # The memory of turbulence is at the end of the state.
        if 'turbulence' in self.names:
            state[-len(draw_turbulence_memory(seed)) :] = draw_turbulence_memory(seed)
        return state

    def fly_leg(
        self, constants: Array, leg: LegPlan, memory: LegState, state: Array, seed: int
    ) -> tuple[LegState, Array]:
        """
        Return the leg state and the model state after a leg.

        Parameters
        ----------
        constants : ndarray
            From `pack_constants`.
        leg : LegPlan
            Leg to fly.
        memory : LegState
            State after the leg before, with the outcome reset to `FLYING`.
        state : ndarray
            State of the model.
        seed : int
            Random seed of the flight; only 32 bits are used.

        """
        # The kernel writes into both arrays; the copy keeps the caller's state intact.
        numbers, after = MEMORY.write(memory), state.copy()
        self._fly(self._fixed, constants, self._leg.write(leg), numbers, after, seed & 0xFFFFFFFF)
        return MEMORY.read(numbers), after

"""Fly legs: compile their text once, and call it with arrays."""

from functools import cache
from types import ModuleType
from typing import Any, final

from lta_config.compilation.flat import Layout
from lta_config.compilation.kernel_cache import load
from lta_config.topics import topic_table
from lta_flight.fleet.craft import Made, rhythm_of
from lta_model.state import pack, RIGID
from lta_sim.counted_sensors import eddies
from lta_sim.kernels.kernel import LAYOUT
from lta_studies.mission.aloft import Aloft, at_rest, Leg
from lta_studies.mission.leg_text import remembered, source
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MEMORY = Layout(at_rest(1.0, 1.0))


@cache
def _kernel(
    names: tuple[str, ...], craft: Layout[Any], leg: Layout[Any], diodes: int
) -> ModuleType:
    """Return the compiled leg of some effects."""
    return load(source(names, craft, leg, MEMORY, diodes, rhythm_of(topic_table())))


@final
class Pilot:
    """
    Flies the legs of one vehicle in one scene.

    Parameters
    ----------
    made : Made
        Vehicle and scene, as a flight of a batch.
    leg : Leg
        Any: an example.

    """

    def __init__(self, made: Made, leg: Leg) -> None:
        model = made.model
        self.names = tuple(n for n in LAYOUT.effects if model.on[LAYOUT.flag(n)])
        parameters, _ = LAYOUT.places(self.names)
        self._fixed = np.array([*model.parameters[parameters], *model.body, *model.inverse])
        self._craft, self._leg = Layout(made.craft), Layout(leg)
        self._fly = _kernel(
            self.names, self._craft, self._leg, len(made.craft.listening.planes)
        ).fly_leg

    def constants(self, made: Made) -> Array:
        """Return the numbers of the vehicle in a scene of the same form, shape (n,)."""
        return np.array(made.numbers)

    def standing(self, x: float, y: float, z: float, heading: float, seed: int) -> Array:
        """Return the state of the model on the ground. [m, rad]"""
        memory = remembered(self.names)
        state = np.array([*pack((x, y, z), heading)[:RIGID], *memory])
        if 'turbulence' in self.names:
            state[-len(eddies(seed)) :] = eddies(seed)
        return state

    def fly(
        self, constants: Array, leg: Leg, memory: Aloft, state: Array, seed: int
    ) -> tuple[Aloft, Array]:
        """
        Return what is remembered after a leg, and the state of the model.

        Parameters
        ----------
        constants : ndarray
            From `constants`.
        leg : Leg
            What to fly.
        memory : Aloft
            Where the leg before ended, its outcome `FLYING` again.
        state : ndarray
            Of the model.
        seed : int
            Of the flight's chance; 32 bits count.

        """
        numbers, after = MEMORY.write(memory), state.copy()
        self._fly(self._fixed, constants, self._leg.write(leg), numbers, after, seed & 0xFFFFFFFF)
        return MEMORY.read(numbers), after

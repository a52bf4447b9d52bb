# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Delay the commands on their way to the rotors, according to the vehicle's effects.

A command takes effect when it arrives: with a delay of 13 ms and a control period of 10 ms it
takes over 3 ms into the next period. Before the first command the rotors are off.
"""

from collections import deque
from collections.abc import Mapping, Sequence
import math
from typing import final

from lta_model.measurement_chain import apply_chain, Chain
from lta_model.state import COMMAND, MASS_PLACE
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
NS_A_SECOND = 1e9


@final
class CommandLink:
    """
    Queue of delayed commands.

    Parameters
    ----------
    reversible : sequence of bool
        Whether each rotor accepts negative duty.
    effect_parameters : mapping
        Parameters of the active effects; a moving mass starts at its given place.
    chain : Chain
        Effects on the channel `command_time`.

    Attributes
    ----------
    idle : ndarray of float64, shape (COMMAND,)
        Command before the first one arrives, in the layout of `lta_model.state`.

    """

    def __init__(
        self,
        reversible: Sequence[bool],
        effect_parameters: Mapping[str, Mapping[str, float]],
        chain: Chain,
    ) -> None:
        self._lowest = [-1.0 if reverses else 0.0 for reverses in reversible]
        self._chain = chain
        self.idle: Array = np.zeros(COMMAND)
        place = effect_parameters.get('moving_mass', {})
        self.idle[MASS_PLACE:] = [place.get(axis, 0.0) for axis in 'xyz']
        self._latest = self._obeyed = self.idle
        # Commands under way, with their send times [ns], oldest first
        self._coming: deque[tuple[int, Array]] = deque()

    def pack_command(self, duties: Sequence[float], mass_place: Vector | None = None) -> Array:
        """
        Return a command for the kernel, clipped to the rotors' limits.

        Raises
        ------
        ValueError
            If there is not one finite duty for each rotor, or a place is not finite.

        """
        numbers = list(map(float, duties))
        if len(numbers) != len(self._lowest) or not all(map(math.isfinite, numbers)):
            raise ValueError(
                f'The motor duties are {numbers}; there must be {len(self._lowest)} finite '
                'numbers, one for each rotor.'
            )
        # A command without a mass position keeps the last one
        command = self._latest.copy()
        command[: len(numbers)] = [
            low if duty < low else 1.0 if duty > 1.0 else duty
            for low, duty in zip(self._lowest, numbers, strict=True)
        ]
        if mass_place is not None:
            if len(mass_place) != 3 or not all(map(math.isfinite, mass_place)):
                raise ValueError(
                    f'The commanded position of the moving mass is {mass_place}; it must '
                    'be 3 finite numbers.'
                )
            command[MASS_PLACE:] = mass_place
        self._latest = command
        return command

    def send_command(
        self, now_ns: int, end_ns: int, elapsed: float, command: Array
    ) -> list[tuple[int, Array]]:
        """Send a command; return the active commands and their end times, in order."""
        if not self._chain:
            return [(end_ns, command)]
        # The delay is constant within a period.
        delay = elapsed - apply_chain(self._chain, (elapsed,), elapsed)[0]
        # A command cannot arrive before it is sent
        age_ns = max(0, round(delay * NS_A_SECOND))
        self._coming.append((now_ns, command))
        out: list[tuple[int, Array]] = []
        while self._coming and self._coming[0][0] + age_ns < end_ns:
            given_ns, later = self._coming.popleft()
            # Arrives within this period: the previous command stays active until then
            if given_ns + age_ns > now_ns:
                out.append((given_ns + age_ns, self._obeyed))
            self._obeyed = later
        return [*out, (end_ns, self._obeyed)]

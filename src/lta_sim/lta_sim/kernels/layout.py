# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Layout of parameters, memory and flags of the effects, and the stages of the model.

A compilation target defines how its source accesses a number (`KernelAccess`): in a row for one
vehicle (`row`), in tuples for each of many (`thread`).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import final, Protocol

from lta_model.effects.protocol import ActuatorEffect, KernelEffect, WrenchEffect
from lta_model.state import ACTUATORS, BODY, COMMAND, RIGID, SURROUNDINGS

# Values that stay constant during a call, after the parameters, with their sizes.
ROW_PARTS = {'body': BODY, 'inverse': 36, 'command': COMMAND, 'surroundings': SURROUNDINGS}


# Longer displays of tuples are built by way of a list, which numba does not always follow.
DISPLAY = 30


def format_tuple(items: Iterable[str]) -> str:
    """Return the source of a tuple of any length."""
    values = list(items)
    displays = [values[k : k + DISPLAY] for k in range(0, len(values), DISPLAY)] or [[]]
    texts = ['(' + ''.join(f'{item}, ' for item in part).rstrip() + ')' for part in displays]
    return texts[0] if len(texts) == 1 else f'({" + ".join(texts)})'


def indent_lines(lines: Iterable[str], depth: int = 1) -> str:
    """Return lines as a block of source."""
    return '\n'.join('    ' * depth + line for line in lines)


def format_offset(each: int) -> str:
    """Return the source of an index offset for rotor j."""
    return f' + {each} * j' if each > 1 else ' + j' if each else ''


@final
@dataclass(frozen=True, slots=True)
class ModelStage:
    """One stage of the state derivative."""

    lines: tuple[str, ...]  # source that computes it
    effect: str = ''  # effect whose flag controls it; '' if it always runs
    memory: tuple[tuple[int, str], ...] = ()  # places in the state and the source of their rates
    each: bool = False  # whether its lines are for one rotor j
    actuates: bool = False  # whether they set the duties of the rotors, in the end their thrusts


@final
class EffectLayout:
    """Offsets of parameters, memory and flag of each effect, in registry order."""

    def __init__(self, effects: Mapping[str, KernelEffect]) -> None:
        self.effects = dict(effects)
        self.first: dict[str, int] = {}
        self.remembers: dict[str, int] = {}
        parameters, size = 0, RIGID
        for name, effect in self.effects.items():
            # Offsets of the effect's parameters and of its memory in the state
            self.first[name], self.remembers[name] = parameters, size
            parameters += len(effect.parameters)
            size += self.memory_size(name)
        self.parameters, self.size = parameters, size

    def memory_size(self, name: str) -> int:
        """Return the size of an effect's memory in the state."""
        effect = self.effects[name]
        # An actuator effect has one memory per rotor
        return len(effect.memory) * (ACTUATORS if isinstance(effect, ActuatorEffect) else 1)

    def find_effect_indices(self, names: Iterable[str]) -> tuple[list[int], list[int]]:
        """Return the indices of some effects in the parameters and in the state."""
        parameters: list[int] = []
        state = list(range(RIGID))
        for name in names:
            first, place = self.first[name], self.remembers[name]
            parameters += range(first, first + len(self.effects[name].parameters))
            state += range(place, place + self.memory_size(name))
        return parameters, state

    def flag_index(self, name: str) -> int:
        """Return the index of an effect's flag."""
        return list(self.effects).index(name)

    @property
    def wrench_names(self) -> list[str]:
        """Names of the wrench effects."""
        return [name for name, e in self.effects.items() if isinstance(e, WrenchEffect)]

    @property
    def rate_source(self) -> str:
        """Source of d/dt of the whole state, from the results of the stages."""
        memory = [f'R_{name}[{k}]' for name in self.effects for k in range(self.memory_size(name))]
        # f, g, a: rates of position, quaternion and velocities, from the last stage
        return f'f + g + a + {format_tuple(memory)}'


class KernelAccess(Protocol):
    """How the generated source of a compilation target accesses the numbers of a vehicle."""

    @property
    def loops(self) -> bool:
        """Whether the rotors are handled in a loop over j."""
        ...

    def format_number(self, name: str, place: int, layout: EffectLayout, each: int = 0) -> str:
        """
        Return the source of a number of `state`, `rate_source`, `parameters`, `u` or FIXED.

        With `each` nonzero it is the number of rotor j, `each` places apart from rotor to rotor.
        """
        ...

    def format_all_numbers(self, name: str, layout: EffectLayout) -> str:
        """Return the source of all numbers of `u` or one of FIXED."""
        ...

    def build_template_parts(
        self, parts: list[ModelStage], layout: EffectLayout
    ) -> dict[str, str]:
        """Return the template parts of this target, in addition to the common ones."""
        ...

"""
Layout of the effects' numbers, and the parts of a stage of the model.

A form of the model defines how its source accesses a number (`KernelAccess`): in a row for one
vehicle (`row`), in columns for many (`columns`).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import final, Protocol

from lta_model.effects.protocol import ActuatorEffect, KernelEffect, WrenchEffect
from lta_model.state import ACTUATORS, BODY, COMMAND, RIGID, SURROUNDINGS

# Variables passed between stages, with their sizes.
VARIABLES = {'r': 9, 'ground': 3, 'wind': 3, 'flow': 3, 'airspeed': 3, 'u': ACTUATORS, 'total': 6}

# Values that stay constant during a call, after the parameters, with their sizes.
FIXED = {'body': BODY, 'inverse': 36, 'command': COMMAND, 'surroundings': SURROUNDINGS}


# Longer displays of tuples are built by way of a list, which numba does not always follow.
DISPLAY = 30


def format_tuple(items: Iterable[str]) -> str:
    """Return the source of a tuple of any length."""
    known = list(items)
    displays = [known[k : k + DISPLAY] for k in range(0, len(known), DISPLAY)] or [[]]
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
    """
    One part of the sum.

    Parameters
    ----------
    lines : tuple of str
        Source that computes it.
    reads, writes : tuple of str
        Which of VARIABLES it needs and sets.
    effect : str
        The effect whose flag lets it be skipped; '' for what is always done.
    memory : tuple of (int, str)
        Places in the state and the source of their rates.
    prelude : tuple of str
        What must stand before its lines where no earlier stage's locals are left.
    each : bool
        Whether its lines are those of rotor j.

    """

    lines: tuple[str, ...]
    reads: tuple[str, ...] = ()
    writes: tuple[str, ...] = ()
    effect: str = ''
    memory: tuple[tuple[int, str], ...] = ()
    prelude: tuple[str, ...] = ()
    each: bool = False


@final
class EffectLayout:
    """
    Where the parameters, the memory and the flag of each effect of the kernel are.

    Parameters
    ----------
    effects : mapping of str to KernelEffect
        In registry order.

    """

    def __init__(self, effects: Mapping[str, KernelEffect]) -> None:
        self.effects = dict(effects)
        self.first: dict[str, int] = {}
        self.remembers: dict[str, int] = {}
        parameters, size = 0, RIGID
        for name, effect in self.effects.items():
            self.first[name], self.remembers[name] = parameters, size
            parameters += len(effect.parameters)
            size += self.memory_size(name)
        self.parameters, self.size = parameters, size

    def memory_size(self, name: str) -> int:
        """Return how many numbers of the state are an effect's memory."""
        effect = self.effects[name]
        return len(effect.memory) * (ACTUATORS if isinstance(effect, ActuatorEffect) else 1)

    def find_places(self, names: Iterable[str]) -> tuple[list[int], list[int]]:
        """Return where in the parameters and in the state a kernel of some effects lives."""
        parameters: list[int] = []
        state = list(range(RIGID))
        for name in names:
            first, place = self.first[name], self.remembers[name]
            parameters += range(first, first + len(self.effects[name].parameters))
            state += range(place, place + self.memory_size(name))
        return parameters, state

    def flag_index(self, name: str) -> int:
        """Return the place of an effect's flag."""
        return list(self.effects).index(name)

    @property
    def wrench_names(self) -> list[str]:
        """Names of the wrench effects."""
        return [name for name, e in self.effects.items() if isinstance(e, WrenchEffect)]

    @property
    def rate_source(self) -> str:
        """Source of d/dt of the whole state, from what the stages leave behind."""
        memory = [f'R_{name}[{k}]' for name in self.effects for k in range(self.memory_size(name))]
        return f'f + g + a + {format_tuple(memory)}'


class KernelAccess(Protocol):
    """Access of a form's source to the numbers of a vehicle."""

    @property
    def loops(self) -> bool:
        """Whether the rotors are in a loop over j."""
        ...

    def format_item(self, name: str, place: int, layout: EffectLayout, each: int = 0) -> str:
        """
        Return the source of a number of `state`, `rate_source`, `parameters`, `u` or FIXED.

        Where `each` is not 0 it is that of rotor j, `each` places on from rotor to rotor.
        """
        ...

    def format_whole(self, name: str, layout: EffectLayout) -> str:
        """Return the source of all numbers of `u` or one of FIXED."""
        ...

    def build_parts(self, parts: list[ModelStage], layout: EffectLayout) -> dict[str, str]:
        """Return the template parts of this form, in addition to the common ones."""
        ...

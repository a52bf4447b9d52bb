"""
The stages of d/dt of a state: each effect a few lines of source, in the order of the physics.

Air, then actuators, then wrenches, then the acceleration of the whole. A stage says which
variables it reads and writes, so that the same lines serve one vehicle in local variables and many
vehicles side by side in arrays.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import final, Protocol

from lta_sim.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    KernelEffect,
    no_rate,
    no_rotor_rate,
    WrenchEffect,
)
from lta_sim.extract import Extract
from lta_sim.state import ACTUATORS, BODY, COMMAND, RIGID, SURROUNDINGS, WIND

# What only the kernel itself calls needs no way in from Python, which takes long to compile.
# Nothing is reordered and a division by zero gives inf: all forms of the model agree to the bit.
OWN = "error_model='numpy', fastmath=False, no_cpython_wrapper=True, no_cfunc_wrapper=True"

# What stages hand on to each other: how many numbers of each.
VARIABLES = {'r': 9, 'ground': 3, 'wind': 3, 'flow': 3, 'airspeed': 3, 'u': ACTUATORS, 'total': 6}

# What each vehicle keeps during a call, after its parameters: how many numbers of each.
FIXED = {'body': BODY, 'inverse': 36, 'command': COMMAND, 'surroundings': SURROUNDINGS}


# Longer displays of tuples are built by way of a list, which numba does not always follow.
DISPLAY = 30


def tuple_of(items: Iterable[str]) -> str:
    """Return the source of a tuple of any length."""
    known = list(items)
    displays = [known[k : k + DISPLAY] for k in range(0, len(known), DISPLAY)] or [[]]
    texts = ['(' + ''.join(f'{item}, ' for item in part).rstrip() + ')' for part in displays]
    return texts[0] if len(texts) == 1 else f'({" + ".join(texts)})'


def indented(lines: Iterable[str], depth: int = 1) -> str:
    """Return lines as a block of source."""
    return '\n'.join('    ' * depth + line for line in lines)


@final
@dataclass(frozen=True, slots=True)
class Stage:
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
    otherwise : tuple of (str, str)
        Names that it sets beside VARIABLES, and what they are where it is skipped.
    memory : tuple of (int, str)
        Places in the state and the source of their rates.
    prelude : tuple of str
        What must stand before its lines where no earlier stage's locals are left.

    """

    lines: tuple[str, ...]
    reads: tuple[str, ...] = ()
    writes: tuple[str, ...] = ()
    effect: str = ''
    otherwise: tuple[tuple[str, str], ...] = ()
    memory: tuple[tuple[int, str], ...] = ()
    prelude: tuple[str, ...] = ()


@final
class Layout:
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
            size += self.remembered(name)
        self.parameters, self.size = parameters, size

    def remembered(self, name: str) -> int:
        """Return how many numbers of the state are an effect's memory."""
        effect = self.effects[name]
        return len(effect.memory) * (ACTUATORS if isinstance(effect, ActuatorEffect) else 1)

    def places(self, names: Iterable[str]) -> tuple[list[int], list[int]]:
        """Return where in the parameters and in the state a kernel of some effects lives."""
        parameters: list[int] = []
        state = list(range(RIGID))
        for name in names:
            first, place = self.first[name], self.remembers[name]
            parameters += range(first, first + len(self.effects[name].parameters))
            state += range(place, place + self.remembered(name))
        return parameters, state

    def flag(self, name: str) -> int:
        """Return the place of an effect's flag."""
        return list(self.effects).index(name)

    @property
    def wrenches(self) -> list[str]:
        """Names of the wrench effects."""
        return [name for name, e in self.effects.items() if isinstance(e, WrenchEffect)]

    @property
    def rate(self) -> str:
        """Source of d/dt of the whole state, from what the stages leave behind."""
        memory = [f'R_{name}[{k}]' for name in self.effects for k in range(self.remembered(name))]
        return f'f + g + a + {tuple_of(memory)}'


class Access(Protocol):
    """How the source of a form reaches the numbers of a vehicle."""

    def item(self, name: str, place: int, layout: Layout) -> str:
        """Return the source of one number of `state`, `parameters` or one of FIXED."""
        ...

    def whole(self, name: str, layout: Layout) -> str:
        """Return the source of all numbers of one of FIXED."""
        ...

    def texts(self, parts: list[Stage], layout: Layout) -> dict[str, str]:
        """Return what the templates of this form need beyond the common parts."""
        ...


@final
class _Writer:
    """Write the stages of one form."""

    def __init__(self, layout: Layout, access: Access, extract: Extract) -> None:
        self._layout = layout
        self._access = access
        self._extract = extract

    def some(self, name: str, first: int, count: int) -> str:
        """Return the source of the tuple of some numbers of a name."""
        items = (self._access.item(name, first + k, self._layout) for k in range(count))
        return tuple_of(items)

    def motion(self, user: str = '') -> str:
        """Return the source of what wrench effects see, or of what one of them looks at."""
        body, command, around = (
            self._access.whole(name, self._layout)
            if not user or self._extract.mentions(user, f'.{name}')
            else '()'
            for name in ('body', 'command', 'surroundings')
        )
        position, v, w = (
            self.some('state', 0, 3),
            self.some('state', 7, 3),
            self.some('state', 10, 3),
        )
        seen = f'{position}, r, {v}, {w}, airspeed, {body}, {command}, {around}'
        return f'motion = rigid_body_motion({seen})'

    def see(self) -> Stage:
        """Return what comes first: attitude, and everything at its beginning."""
        lines = (
            f'r = rigid_body_rotation({self.some("state", 3, 4)})',
            f'ground = rigid_body_to_map(r, {self.some("state", 7, 3)})',
            f'wind = {self.some("surroundings", WIND, 3)}',
            'flow = (0.0, 0.0, 0.0)',
            f'u = {self.some("command", 0, ACTUATORS)}',
            'total = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)',
        )
        return Stage(lines, (), ('r', 'ground', 'wind', 'flow', 'u', 'total'))

    def meet(self) -> Stage:
        """Return the velocity through the air."""
        v = self.some('state', 7, 3)
        return Stage(
            (f'airspeed = rigid_body_airspeed(r, {v}, wind)',), ('r', 'wind'), ('airspeed',)
        )

    def accelerate(self) -> Stage:
        """Return what comes last: the rate of the rigid body."""
        q, w = self.some('state', 3, 4), self.some('state', 10, 3)
        motion = self.motion('rigid_body')
        inverse = self._access.whole('inverse', self._layout)
        lines = (
            'f = ground',
            f'g = rigid_body_quaternion_rate({q}, {w})',
            f'a = rigid_body_acceleration(total, motion, flow, {inverse})',
        )
        names = [*(f'f[{i}]' for i in range(3)), *(f'g[{i}]' for i in range(4))]
        places = enumerate([*names, *(f'a[{i}]' for i in range(6))])
        reads = ('r', 'ground', 'flow', 'airspeed', 'total')
        return Stage(lines, reads, (), memory=tuple(places), prelude=(motion,))

    def _begin(self, name: str, effect: AirEffect | WrenchEffect) -> list[str]:
        """Return the lines that take up an effect's parameters and memory."""
        layout = self._layout
        return [
            f'p = {self.some("parameters", layout.first[name], len(effect.parameters))}',
            f'm = {self.some("state", layout.remembers[name], len(effect.memory))}',
        ]

    def _remembered(self, name: str, count: int) -> tuple[tuple[int, str], ...]:
        """Return where the rates of an effect's memory go."""
        first = self._layout.remembers[name]
        return tuple((first + k, f'R_{name}[{k}]') for k in range(count))

    def air(self, name: str, effect: AirEffect) -> Stage:
        """Return the stage of an air effect."""
        around, position = (
            self._access.whole('surroundings', self._layout),
            self.some('state', 0, 3),
        )
        lines = [
            *self._begin(name, effect),
            f'place = rigid_body_place({position}, ground, wind, {around})',
            f'U = {self._extract.add(effect.air, name)}(p, m, place)',
            'wind = (wind[0] + U[0], wind[1] + U[1], wind[2] + U[2])',
            'flow = (flow[0] + U[3], flow[1] + U[4], flow[2] + U[5])',
        ]
        count = len(effect.memory)
        if effect.rate is not no_rate:
            lines.append(f'R_{name} = {self._extract.add(effect.rate, name)}(p, m, place)')
        return Stage(
            tuple(lines),
            ('ground', 'wind', 'flow'),
            ('wind', 'flow'),
            name,
            ((f'R_{name}', tuple_of(['0.0'] * count)),) if count else (),
            self._remembered(name, count),
        )

    def actuators(self, name: str, effect: ActuatorEffect) -> Stage:
        """Return the stage of an actuator effect: all rotors."""
        layout, size = self._layout, len(effect.memory)
        first, shared = layout.first[name], len(effect.shared)
        output = self._extract.add(effect.output, name)
        remembers = effect.rate is not no_rotor_rate
        around = self._access.whole('surroundings', layout)
        lines, outputs, rates = [], [], []
        for i in range(ACTUATORS):
            items = [self._access.item('parameters', first + k, layout) for k in range(shared)]
            items += [
                self._access.item('parameters', first + shared + k * ACTUATORS + i, layout)
                for k in range(len(effect.each))
            ]
            memory = self.some('state', layout.remembers[name] + i * size, size)
            lines += [f'p_{i} = {tuple_of(items)}', f'm_{i} = {memory}']
            seen = f'(p_{i}, m_{i}, u[{i}], {around})'
            outputs.append(f'{output}{seen}')
            if remembers:
                lines.append(f'r_{i} = {self._extract.add(effect.rate, name)}{seen}')
                rates += [f'r_{i}[{k}]' for k in range(size)]
        if remembers:
            lines.append(f'R_{name} = {tuple_of(rates)}')
        lines.append(f'u = {tuple_of(outputs)}')
        count = ACTUATORS * size
        off = ((f'R_{name}', tuple_of(['0.0'] * count)),) if count else ()
        return Stage(tuple(lines), ('u',), ('u',), name, off, self._remembered(name, count))

    def wrench(self, name: str, effect: WrenchEffect) -> Stage:
        """Return the stage of a wrench effect."""
        count = len(effect.memory)
        total = tuple_of(f'total[{i}] + W_{name}[{i}]' for i in range(6))
        lines = [
            *self._begin(name, effect),
            f'W_{name} = {self._extract.add(effect.wrench, name)}(p, m, motion, u)',
            f'total = {total}',
        ]
        off = [(f'W_{name}', tuple_of(['0.0'] * 6))]
        if effect.rate is not no_rate:
            lines.append(f'R_{name} = {self._extract.add(effect.rate, name)}(p, m, motion)')
            off.append((f'R_{name}', tuple_of(['0.0'] * count)))
        return Stage(
            tuple(lines),
            ('r', 'airspeed', 'u', 'total'),
            ('total',),
            name,
            tuple(off),
            self._remembered(name, count),
            prelude=(self.motion(name),),
        )


def stages(layout: Layout, access: Access, extract: Extract) -> list[Stage]:
    """
    Return the stages of d/dt of a state, in the order in which they are computed.

    Parameters
    ----------
    layout : Layout
        Of the effects.
    access : Access
        How the numbers of a vehicle are reached.
    extract : Extract
        Takes up the functions of the effects.

    """
    writer = _Writer(layout, access, extract)
    kinds = layout.effects.items()
    return [
        writer.see(),
        *(writer.air(name, e) for name, e in kinds if isinstance(e, AirEffect)),
        writer.meet(),
        *(writer.actuators(name, e) for name, e in kinds if isinstance(e, ActuatorEffect)),
        Stage((writer.motion(),)),
        *(writer.wrench(name, e) for name, e in kinds if isinstance(e, WrenchEffect)),
        writer.accelerate(),
    ]

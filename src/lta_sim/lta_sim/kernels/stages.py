"""
The stages of d/dt of a state: each effect a few lines of source, in the order of the physics.

Air, then actuators, then wrenches, then the acceleration of the whole. A stage says which
variables it reads and writes, so that the same lines serve one vehicle in local variables and many
vehicles side by side in arrays.
"""

from typing import final

from lta_config.compilation.extract import Extract
from lta_model.effects.protocol import ActuatorEffect, AirEffect, no_rate, WrenchEffect
from lta_model.state import WIND, WIND_RATE
from lta_sim.kernels.layout import Access, Layout, Stage, tuple_of
from lta_sim.kernels.rotor_stages import actuators, obey


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
            f'flow = {self.some("surroundings", WIND_RATE, 3)}',
            'total = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)',
        )
        return Stage(lines, (), ('r', 'ground', 'wind', 'flow', 'total'))

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
            self._remembered(name, count),
        )

    def wrench(self, name: str, effect: WrenchEffect) -> Stage:
        """Return the stage of a wrench effect."""
        count = len(effect.memory)
        lines = [
            *self._begin(name, effect),
            f'W_{name} = {self._extract.add(effect.wrench, name)}(p, m, motion, u)',
            f'total = rigid_body_plus(total, W_{name})',
        ]
        if effect.rate is not no_rate:
            lines.append(f'R_{name} = {self._extract.add(effect.rate, name)}(p, m, motion)')
        return Stage(
            tuple(lines),
            ('r', 'airspeed', 'u', 'total'),
            ('total',),
            name,
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
        obey(layout, access),
        *(
            actuators(name, effect, layout, access, extract)
            for name, effect in kinds
            if isinstance(effect, ActuatorEffect)
        ),
        Stage((f'u = {access.whole("u", layout)}', writer.motion())),
        *(writer.wrench(name, e) for name, e in kinds if isinstance(e, WrenchEffect)),
        writer.accelerate(),
    ]

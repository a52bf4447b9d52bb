"""
Many vehicles side by side: a vehicle is column i of a block, number k of it at k * width + i.

On the CPU a block is as wide as WIDTH and every stage of the model is a loop over its columns,
which the compiler turns into vector instructions; an effect that no vehicle of the block has on is
skipped whole. On a GPU the block is as wide as the fleet and a thread is a column.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

from lta_config.compilation.compiled import OWN
from lta_model.state import ACTUATORS
from lta_sim.kernels.layout import FIXED, indented, Layout, Stage, step, tuple_of, VARIABLES

# Of the functions of the stages.
LOOP = f'@njit({OWN})'


def _offset(name: str, layout: Layout) -> int:
    """Return the first row of what a vehicle keeps."""
    counts = {'parameters': layout.parameters, **FIXED}
    names = list(counts)
    return sum(counts[known] for known in names[: names.index(name)])


def _column(block: str, first: int, count: int, width: str) -> str:
    """Return the source of the tuple of some numbers of a vehicle in a block."""
    return tuple_of(f'{block}[{first + k} * {width} + i]' for k in range(count))


def thread(parts: list[Stage], layout: Layout) -> dict[str, str]:
    """Return the stages one after the other and the arithmetic of states that are tuples."""
    size = range(layout.size)
    return {
        'ahead': tuple_of(f'state[{k}] + dt * rate[{k}]' for k in size),
        'mean': tuple_of(f'(a[{k}] + 2.0 * (b[{k}] + c[{k}]) + d[{k}]) / 6.0' for k in size),
        'bare': indented(line for stage in parts for line in stage.lines),
        'rate': layout.rate,
    }


@final
@dataclass(frozen=True, slots=True)
class Columns:
    """
    Reach the numbers of vehicle i in blocks.

    Parameters
    ----------
    width : str
        Source of the width of a block.
    state : str
        Source of the block of states; '' where a state is a local tuple.

    """

    width: str
    state: str = ''

    @property
    def loops(self) -> bool:
        """Whether rotors are gone through in a loop: not where a vehicle is a local tuple."""
        return bool(self.state)

    def item(self, name: str, place: int, layout: Layout, each: int = 0) -> str:
        """Return the source of one number."""
        if name == 'state' and not self.state:
            return f'state[{place}]'
        blocks = {
            'state': (self.state, 0),
            'rate': ('rate', 0),
            'u': ('scratch', self._row('u')),
        }
        block, first = blocks.get(name) or ('fixed', _offset(name, layout))
        index = f'({first + place}{step(each)})' if each else f'{first + place}'
        return f'{block}[{index} * {self.width} + i]'

    def whole(self, name: str, layout: Layout) -> str:
        """Return the source of all numbers of a name."""
        if name == 'u':
            return self._scratch('u') if self.state else 'u'
        return _column('fixed', _offset(name, layout), FIXED[name], self.width)

    def texts(self, parts: list[Stage], layout: Layout) -> dict[str, str]:
        """Return how states go in and out of blocks, and the stages as loops."""
        if not self.state:
            return self._thread(parts, layout)
        return {
            'loops': '\n\n\n'.join(self._loops(parts)),
            'calls': indented(self._calls(parts, layout)),
            'LOOP': LOOP,
            'scratch': str(sum(VARIABLES.values())),
        }

    def _thread(self, parts: list[Stage], layout: Layout) -> dict[str, str]:
        """Return what one thread does, and how its vehicle goes in and out of the block."""
        size = range(layout.size)
        return {
            **thread(parts, layout),
            'state': _column('block', 0, layout.size, self.width),
            'stores': indented((f'block[{k} * {self.width} + i] = state[{k}]' for k in size), 3),
        }

    def _done(self, parts: list[Stage]) -> dict[str, Stage]:
        """Return the stages that do something, by the names of their functions."""
        done = [stage for stage in parts if stage.writes or stage.memory or stage.each]
        return {f'stage_{k}_{stage.effect}': stage for k, stage in enumerate(done)}

    def _loops(self, parts: list[Stage]) -> Iterator[str]:
        """Write each stage as a function, so that each is compiled into vectors by itself."""
        for name, stage in self._done(parts).items():
            lines = [f'{known} = {self._scratch(known)}' for known in stage.reads]
            lines += [*stage.prelude, *stage.lines]
            for known in stage.writes:
                lines += self._stored(known)
            lines += [f'rate[{k} * {self.width} + i] = {value}' for k, value in stage.memory]
            rotors = [f'    for j in range({ACTUATORS}):'] if stage.each else []
            depth = len(rotors) + 1
            columns = '    ' * depth + f'for i in range({self.width}):'
            loop = [*rotors, columns, indented(lines, depth + 1)]
            yield '\n'.join([LOOP, f'def {name}(fixed, trial, rate, scratch):', *loop])

    def _calls(self, parts: list[Stage], layout: Layout) -> Iterator[str]:
        """Write the calls of the stages, behind the flags of their effects."""
        for name, stage in self._done(parts).items():
            guard = f'if on[{layout.flag(stage.effect)}]: ' if stage.effect else ''
            yield f'{guard}{name}(fixed, trial, rate, scratch)'

    def _scratch(self, name: str) -> str:
        """Return the source of a variable of vehicle i."""
        return _column('scratch', self._row(name), VARIABLES[name], self.width)

    def _stored(self, name: str) -> list[str]:
        """Return the lines that store a variable of vehicle i."""
        first = self._row(name)
        return [
            f'scratch[{first + k} * {self.width} + i] = {name}[{k}]'
            for k in range(VARIABLES[name])
        ]

    def _row(self, name: str) -> int:
        """Return the first row of a variable."""
        names = list(VARIABLES)
        return sum(VARIABLES[known] for known in names[: names.index(name)])

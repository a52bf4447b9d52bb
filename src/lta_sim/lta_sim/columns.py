"""
Many vehicles side by side: a vehicle is column i of a block, number k of it at k * width + i.

On the CPU a block is as wide as WIDTH and every stage of the model is a loop over its columns,
which the compiler turns into vector instructions; an effect that no vehicle of the block has on is
skipped whole. On a GPU the block is as wide as the fleet and a thread is a column.
"""

from dataclasses import dataclass
from typing import final

from lta_sim.stages import FIXED, indented, Layout, Stage, tuple_of, VARIABLES


def _offset(name: str, layout: Layout) -> int:
    """Return the first row of what a vehicle keeps."""
    counts = {'parameters': layout.parameters, **FIXED}
    names = list(counts)
    return sum(counts[known] for known in names[: names.index(name)])


def _column(block: str, first: int, count: int, width: str) -> str:
    """Return the source of the tuple of some numbers of a vehicle in a block."""
    return tuple_of(f'{block}[{first + k} * {width} + i]' for k in range(count))


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

    def item(self, name: str, place: int, layout: Layout) -> str:
        """Return the source of one number."""
        if name == 'state':
            return f'{self.state}[{place} * {self.width} + i]' if self.state else f'state[{place}]'
        return f'fixed[{_offset(name, layout) + place} * {self.width} + i]'

    def whole(self, name: str, layout: Layout) -> str:
        """Return the source of all numbers of a name."""
        return _column('fixed', _offset(name, layout), FIXED[name], self.width)

    def texts(self, parts: list[Stage], layout: Layout) -> dict[str, str]:
        """Return how states go in and out of blocks, and the stages as loops."""
        size = range(layout.size)
        put = [f'block[{k} * {self.width} + i] = state[{k}]' for k in size]
        return {
            'state': _column('block', 0, layout.size, self.width),
            'put': indented(put),
            'stores': indented(put, 3),
            'loops': indented([line for stage in parts for line in self._loop(stage, layout)]),
            'scratch': str(sum(VARIABLES.values())),
        }

    def _loop(self, stage: Stage, layout: Layout) -> list[str]:
        """Return a stage as a loop over the columns of a block."""
        if not (stage.writes or stage.memory):
            return []
        lines = [f'{name} = {self._scratch(name)}' for name in stage.reads]
        lines += [*stage.prelude, *stage.lines]
        for name in stage.writes:
            lines += self._stored(name)
        lines += [f'rate[{k} * {self.width} + i] = {value}' for k, value in stage.memory]
        loop = [f'for i in range({self.width}):', *(f'    {line}' for line in lines)]
        if not stage.effect:
            return loop
        guard = f'if on[{layout.flag(stage.effect)}]:'
        return [guard, *(f'    {line}' for line in loop)]

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

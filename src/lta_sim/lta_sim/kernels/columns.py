"""
Store many vehicles side by side: number k of vehicle i is at k * width + i of a block.

A block is WIDTH vehicles wide, and every stage of the model is a loop over its columns, which the
compiler vectorises. All that a stage reads and writes is in one array with constant offsets: the
compiler then knows without checks that no row overlaps another.
"""

from dataclasses import dataclass
from typing import final

from lta_config.compilation.compiler import INNER_OPTIONS
from lta_model.state import ACTUATORS
from lta_sim.kernels.layout import (
    EffectLayout,
    FIXED,
    format_offset,
    format_tuple,
    indent_lines,
    ModelStage,
    VARIABLES,
)

# Of the functions of the stages.
LOOP = f'@njit({INNER_OPTIONS})'


def _row_offset(name: str, layout: EffectLayout) -> int:
    """Return the first row of a variable in a block: inputs first, then results of a step."""
    counts = {
        'parameters': layout.parameters,
        **FIXED,
        **dict.fromkeys(('state', 'begin', 'rate', 'first', 'middle'), layout.size),
        **VARIABLES,
    }
    names = list(counts)
    return sum(counts[column] for column in names[: names.index(name)])


def _format_column(block: str, first: int, count: int, width: str) -> str:
    """Return the source of a tuple of consecutive numbers of vehicle i."""
    return format_tuple(f'{block}[{first + k} * {width} + i]' for k in range(count))


@final
@dataclass(frozen=True, slots=True)
class ColumnAccess:
    """Access all numbers of vehicle i in one block."""

    width: str  # source of the block width
    # Places of parameters that are 0 in all vehicles: written as such, so that the compiler leaves
    # out what an effect skips because of them
    zeros: frozenset[int] = frozenset()
    rotors: int = ACTUATORS  # those beyond are not computed: their thrust is 0
    loops = True

    def format_number(self, name: str, place: int, layout: EffectLayout, each: int = 0) -> str:
        """Return the source of one number."""
        if name == 'parameters' and not each and place in self.zeros:
            return '0.0'
        row = _row_offset(name, layout) + place
        index = f'({row}{format_offset(each)})' if each else f'{row}'
        return f'block[{index} * {self.width} + i]'

    def format_all_numbers(self, name: str, layout: EffectLayout) -> str:
        """Return the source of all numbers of a name."""
        if name == 'u':
            thrusts = (self.format_number('u', k, layout) for k in range(self.rotors))
            return format_tuple((*thrusts, *['0.0'] * (ACTUATORS - self.rotors)))
        count = (FIXED | VARIABLES)[name]
        return _format_column('block', _row_offset(name, layout), count, self.width)

    def build_template_parts(
        self, parts: list[ModelStage], layout: EffectLayout
    ) -> dict[str, str]:
        """Return the stages as loops, and the offsets of the rows of a block."""
        stages = {f'stage_{k}': run for k, run in enumerate(_join_stages(parts))}
        last = list(VARIABLES)[-1]
        return {
            'loops': '\n\n\n'.join(
                self._write_loop(name, run, layout) for name, run in stages.items()
            ),
            'calls': indent_lines(f'{name}(block)' for name in stages),
            'LOOP': LOOP,
            'inputs': str(_row_offset('begin', layout)),
            'rows': str(_row_offset(last, layout) + VARIABLES[last]),
            **{
                name: str(_row_offset(name, layout))
                for name in ('state', 'begin', 'rate', 'first', 'middle')
            },
        }

    def _write_loop(self, name: str, run: list[ModelStage], layout: EffectLayout) -> str:
        """Return stages as a function with one loop over vehicles."""
        lines: list[str] = []
        loaded: set[str] = set()
        for stage in run:
            new = [variable for variable in stage.reads if variable not in loaded]
            lines += [f'{each} = {self.format_all_numbers(each, layout)}' for each in new]
            lines += [*stage.prelude, *stage.lines]
            lines += [
                f'{self.format_number("rate", k, layout)} = {value}' for k, value in stage.memory
            ]
            loaded |= {*stage.reads, *stage.writes}
        for variable in dict.fromkeys(each for stage in run for each in stage.writes):
            lines += [
                f'{self.format_number(variable, k, layout)} = {variable}[{k}]'
                for k in range(VARIABLES[variable])
            ]
        # Vehicles in the inner loop: neighbouring columns are contiguous in memory
        rotors = [f'    for j in range({self.rotors}):'] if run[0].each else []
        depth = len(rotors) + 1
        columns = '    ' * depth + f'for i in range({self.width}):'
        loop = [*rotors, columns, indent_lines(lines, depth + 1)]
        return '\n'.join([LOOP, f'def {name}(block):', *loop])


def _join_stages(parts: list[ModelStage]) -> list[list[ModelStage]]:
    """Return the stages that compute something, with those in a list that share a loop."""
    runs: list[list[ModelStage]] = []
    for stage in parts:
        if not (stage.writes or stage.memory or stage.each):
            continue
        last = runs[-1][-1] if runs else None
        if last and last.joins and stage.joins and last.each == stage.each:
            runs[-1].append(stage)
        else:
            runs.append([stage])
    return runs

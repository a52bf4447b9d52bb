"""
Store many vehicles side by side: number k of vehicle i is at k * width + i of a block.

On the CPU a block is WIDTH vehicles wide, and every stage of the model is a loop over its columns,
which the compiler vectorises; an effect that is off for the whole block is skipped. On a GPU the
block is as wide as the batch and each thread handles one column.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

from lta_config.compilation.compiler import OWN
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
LOOP = f'@njit({OWN})'


def _row_offset(name: str, layout: EffectLayout) -> int:
    """Return the first row of a constant input in a block."""
    counts = {'parameters': layout.parameters, **FIXED}
    names = list(counts)
    return sum(counts[known] for known in names[: names.index(name)])


def _format_column(block: str, first: int, count: int, width: str) -> str:
    """Return the source of a tuple of consecutive numbers of vehicle i."""
    return format_tuple(f'{block}[{first + k} * {width} + i]' for k in range(count))


def build_thread_sources(parts: list[ModelStage], layout: EffectLayout) -> dict[str, str]:
    """Return the source of all stages in sequence, and the arithmetic of states held as tuples."""
    size = range(layout.size)
    return {
        'ahead': format_tuple(f'state[{k}] + dt * rate[{k}]' for k in size),
        # Same order of operations as in the scalar kernel, so that results agree
        'mean': format_tuple(f'(a[{k}] + 2.0 * (b[{k}] + c[{k}]) + d[{k}]) / 6.0' for k in size),
        'bare': indent_lines(line for stage in parts for line in stage.lines),
        'rate': layout.rate_source,
    }


@final
@dataclass(frozen=True, slots=True)
class ColumnAccess:
    """Access the numbers of vehicle i in blocks."""

    width: str  # source of the block width
    state: str = ''  # source of the block of states; '' where a state is a local tuple

    @property
    def loops(self) -> bool:
        """Whether the rotors are handled in a loop; unrolled where a vehicle is a local tuple."""
        return bool(self.state)

    def format_number(self, name: str, place: int, layout: EffectLayout, each: int = 0) -> str:
        """Return the source of one number."""
        if name == 'state' and not self.state:
            return f'state[{place}]'
        blocks = {
            'state': (self.state, 0),
            'rate': ('rate', 0),
            'u': ('scratch', self._variable_row('u')),
        }
        block, first = blocks.get(name) or ('fixed', _row_offset(name, layout))
        index = f'({first + place}{format_offset(each)})' if each else f'{first + place}'
        return f'{block}[{index} * {self.width} + i]'

    def format_all_numbers(self, name: str, layout: EffectLayout) -> str:
        """Return the source of all numbers of a name."""
        if name == 'u':
            return self._format_variable('u') if self.state else 'u'
        return _format_column('fixed', _row_offset(name, layout), FIXED[name], self.width)

    def format_parameters(self, first: int, count: int, layout: EffectLayout) -> str:
        """Return the source of consecutive parameters of vehicle i as a view of the block."""
        begin = _row_offset('parameters', layout) + first
        return f'fixed[{begin} * {self.width} + i : {begin + count} * {self.width} : {self.width}]'

    def build_template_parts(
        self, parts: list[ModelStage], layout: EffectLayout
    ) -> dict[str, str]:
        """Return the loading and storing of states in blocks, and the stages as loops."""
        if not self.state:
            return self._generate_thread_code(parts, layout)
        return {
            'loops': '\n\n\n'.join(self._write_loops(parts)),
            'calls': indent_lines(self._write_calls(parts, layout)),
            'LOOP': LOOP,
            'scratch': str(sum(VARIABLES.values())),
        }

    def _generate_thread_code(
        self, parts: list[ModelStage], layout: EffectLayout
    ) -> dict[str, str]:
        """Return the code of one thread, with loading and storing of its vehicle."""
        size = range(layout.size)
        return {
            **build_thread_sources(parts, layout),
            'state': _format_column('block', 0, layout.size, self.width),
            'stores': indent_lines(
                (f'block[{k} * {self.width} + i] = state[{k}]' for k in size), 3
            ),
        }

    def _select_stages(self, parts: list[ModelStage]) -> dict[str, ModelStage]:
        """Return the non-empty stages, by the names of their functions."""
        done = [stage for stage in parts if stage.writes or stage.memory or stage.each]
        return {f'stage_{k}_{stage.effect}': stage for k, stage in enumerate(done)}

    def _write_loops(self, parts: list[ModelStage]) -> Iterator[str]:
        """Write each stage as a function, so that each is vectorised separately."""
        for name, stage in self._select_stages(parts).items():
            lines = [f'{known} = {self._format_variable(known)}' for known in stage.reads]
            lines += [*stage.prelude, *stage.lines]
            for known in stage.writes:
                lines += self._format_stores(known)
            lines += [f'rate[{k} * {self.width} + i] = {value}' for k, value in stage.memory]
            # Vehicles in the inner loop: neighbouring columns are contiguous in memory
            rotors = [f'    for j in range({ACTUATORS}):'] if stage.each else []
            depth = len(rotors) + 1
            columns = '    ' * depth + f'for i in range({self.width}):'
            loop = [*rotors, columns, indent_lines(lines, depth + 1)]
            yield '\n'.join([LOOP, f'def {name}(fixed, trial, rate, scratch):', *loop])

    def _write_calls(self, parts: list[ModelStage], layout: EffectLayout) -> Iterator[str]:
        """Write the calls of the stages, behind the flags of their effects."""
        for name, stage in self._select_stages(parts).items():
            guard = f'if on[{layout.flag_index(stage.effect)}]: ' if stage.effect else ''
            yield f'{guard}{name}(fixed, trial, rate, scratch)'

    def _format_variable(self, name: str) -> str:
        """Return the source of a variable of vehicle i."""
        return _format_column('scratch', self._variable_row(name), VARIABLES[name], self.width)

    def _format_stores(self, name: str) -> list[str]:
        """Return the lines that store a variable of vehicle i."""
        first = self._variable_row(name)
        return [
            f'scratch[{first + k} * {self.width} + i] = {name}[{k}]'
            for k in range(VARIABLES[name])
        ]

    def _variable_row(self, name: str) -> int:
        """Return the first row of a variable."""
        names = list(VARIABLES)
        return sum(VARIABLES[known] for known in names[: names.index(name)])

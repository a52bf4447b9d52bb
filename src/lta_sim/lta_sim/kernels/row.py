# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Store one vehicle as one row of numbers, which the scalar kernel reads and writes in place.

Every number has a fixed index in the row. The compiler therefore knows that stores of one stage do
not alias loads of the next, a call passes one array, and a long flight reuses its row
(`lta_sim.simulated_vehicle`).
"""

from collections.abc import Iterable, Iterator
from typing import final

from lta_model.state import ACTUATORS
from lta_sim.kernels.layout import (
    EffectLayout,
    format_offset,
    format_tuple,
    indent_lines,
    ModelStage,
    ROW_PARTS,
)

ROW_ENTRIES = '''
$INLINE
def tell(row, first, wrench):
    """Write a wrench."""
    for k in range(6):
        row[first + k] = wrench[k]


$INLINE
def rates(row, on):
    """Write d/dt of the state, and what makes it where that is to be told."""
    told = row[$told] != 0.0  # an argument that is a constant would be compiled twice
$head
$body


$ENTRY
def derivative(row, on):
    """Write d/dt of the state, the wrench of each wrench effect, thrusts and wind."""
    for i in range($rate, $end):
        row[i] = 0.0  # what is off says nothing
    row[$told] = 1.0
    rates(row, on)


$ENTRY
def advance(row, on, dt, steps):
    """Take `steps` steps of dt."""
    for i in range($size):
        row[$rate + i] = 0.0  # memory of effects that are off stays as it is
    row[$told] = 0.0
    half = 0.5 * dt
    for _ in range(steps):
        for i in range($size):
            row[$begin + i] = row[i]
        rates(row, on)
        for i in range($size):
            row[$first + i] = row[$rate + i]
            row[i] = row[$begin + i] + half * row[$rate + i]
        rates(row, on)
        for i in range($size):
            row[$middle + i] = row[$rate + i]
            row[i] = row[$begin + i] + half * row[$rate + i]
        rates(row, on)
        for i in range($size):
            row[$middle + i] = row[$middle + i] + row[$rate + i]
            row[i] = row[$begin + i] + dt * row[$rate + i]
        rates(row, on)
        for i in range($size):
            mean = (row[$first + i] + 2.0 * row[$middle + i] + row[$rate + i]) / 6.0
            row[i] = row[$begin + i] + dt * mean
        x, y, z, w = row[3], row[4], row[5], row[6]
        n = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
        row[3], row[4], row[5], row[6] = x * n, y * n, z * n, w * n
'''


def row_part_sizes(layout: EffectLayout) -> dict[str, int]:
    """
    Return the parts of a row in order, with their sizes.

    `begin`, `first` and `middle` hold intermediate results of a Runge-Kutta step; `told` is the
    flag that requests the outputs after `rate`.
    """
    size = layout.size
    inputs = {'state': size, 'parameters': layout.parameters, **ROW_PARTS}
    scratch = dict.fromkeys(('begin', 'first', 'middle'), size)
    return {
        **inputs,
        **scratch,
        'told': 1,
        # From here on: outputs, which `derivative` zeroes first
        'rate': size,
        'wrenches': 6 * len(layout.wrench_names),
        'thrusts': ACTUATORS,
        'wind': 3,
    }


def row_slices(layout: EffectLayout) -> dict[str, slice]:
    """Return the slice of each part of a row."""
    out, first = {}, 0
    for name, count in row_part_sizes(layout).items():
        out[name] = slice(first, first + count)
        first += count
    return out


@final
class RowAccess:
    """Access to the numbers of one vehicle in its row."""

    loops = True

    def format_number(self, name: str, place: int, layout: EffectLayout, each: int = 0) -> str:
        """Return the source of one number; `u` is stored in the place of the thrusts."""
        first = row_slices(layout)['thrusts' if name == 'u' else name].start
        return f'row[{first + place}{format_offset(each)}]'

    def format_all_numbers(self, name: str, layout: EffectLayout) -> str:
        """Return the source of all numbers of a name: a local variable, except for `u`."""
        if name != 'u':
            return name
        return format_tuple(self.format_number('u', i, layout) for i in range(ACTUATORS))

    def build_template_parts(
        self, stages: list[ModelStage], layout: EffectLayout
    ) -> dict[str, str]:
        """Return the source of all stages in sequence, and the offsets of the parts of a row."""
        where = row_slices(layout)
        head = [
            f'{name} = '
            f'{format_tuple(f"row[{k}]" for k in range(where[name].start, where[name].stop))}'
            for name in ROW_PARTS
        ]
        return {
            'head': indent_lines(head),
            'body': indent_lines(self._write_body(stages, layout)),
            **{
                name: str(where[name].start)
                for name in ('begin', 'first', 'middle', 'told', 'rate')
            },
            'end': str(max(part.stop for part in where.values())),
        }

    def _write_body(self, stages: list[ModelStage], layout: EffectLayout) -> Iterator[str]:
        """Write each stage behind the flag of its effect, then the reported values."""
        where = row_slices(layout)
        for stage in stages:
            lines = [*stage.lines, *self._format_stores(where['rate'].start, stage.memory)]
            if stage.effect in layout.wrench_names:
                row = where['wrenches'].start + 6 * layout.wrench_names.index(stage.effect)
                lines.append(f'if told: tell(row, {row}, W_{stage.effect})')
            depth = 0
            if stage.effect:
                yield f'if on[{layout.flag_index(stage.effect)}]:'
                depth += 1
            if stage.each:
                yield '    ' * depth + f'for j in range({ACTUATORS}):'
                depth += 1
            yield from ('    ' * depth + line for line in lines)
        yield from self._format_stores(where['wind'].start, ((k, f'wind[{k}]') for k in range(3)))

    def _format_stores(self, first: int, values: Iterable[tuple[int, str]]) -> list[str]:
        """Return the lines that store values from an index on."""
        return [f'row[{first + k}] = {value}' for k, value in values]

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Write a vehicle sheet as sentences, for the terminal, and as JSON."""

from collections.abc import Iterator, Mapping, Sequence
import math

from lta_report.report import Report, TextTable
from lta_report.report_terminal import print_report, print_table
from lta_vehicle.difference import FigureChange, VehicleDifference
from lta_vehicle.figures.figure import DerivedFigure, MISSING_FIGURE
from lta_vehicle.figures.sheet import VehicleFileEntry, VehicleSheet
from rich.console import Console
from rich.text import Text

MINUS = '\N{MINUS SIGN}'
NUMBER_WORDS = ('no', 'one', 'two', 'three', 'four', 'five', 'six', 'seven', 'eight')


def format_headline(sheet: VehicleSheet) -> str:
    """Return the headline: weight, heaviness and hover duty."""
    f = sheet.by_key
    name = sheet.vehicle.file.name
    heavy = f['heaviness']
    weight = f['mass'].value_with_unit
    if sheet.vehicle.file.hull.shape == 'none':
        first = f'{name} weighs {weight}, all carried by its rotors'
    # Exactly zero: trimmed to neutral buoyancy by the file
    elif heavy.value == 0.0:
        first = f'{name} weighs {weight}, gas included, and is neutrally buoyant'
    else:
        value = heavy.value_with_unit.replace('\N{MINUS SIGN}', '')
        than = 'heavier' if (heavy.value or 0.0) > 0.0 else 'lighter'
        first = f'{name} weighs {weight}, gas included, and is {value} {than} than air'
    duty = f['hover_duty']
    if duty.value is None:
        return f'{first}; its rotors cannot lift it'
    if duty.value == 0.0:
        return first
    return f'{first}; it hovers at {duty.value_with_unit} duty'


def describe_vehicle(sheet: VehicleSheet) -> list[str]:
    """Return the most important properties as sentences, and the share of assumed numbers."""
    return [
        *_describe_weight(sheet),
        *_describe_push(sheet),
        *_describe_stability(sheet),
        *_describe_helium(sheet),
        f'{sheet.assumed_count} of the {len(sheet.numbers)} numbers in its file are assumed, '
        'neither measured nor published.',
    ]


def _describe_weight(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    ballast = f.get('ballast')
    if ballast is not None:
        yield (
            f'Add {ballast.value_with_unit} of ballast to make it '
            f'{f["heaviness"].value_with_unit} heavier than air; then measure its actual '
            'weight in a hover with lta vehicle trim.'
        )
    if 'cg_x' in f and 'lean' in f and (f['lean'].value or 0.0) > 1.0:
        yield (
            f'At rest it tilts by {f["lean"].value_with_unit}, because its centre of '
            f'gravity is {_format_side(f["cg_x"], "ahead of", "behind")} the hull centre '
            f'and {_format_side(f["cg_y"], "to the left", "to the right")} of it.'
        )


def _format_side(figure: DerivedFigure, positive: str, negative: str) -> str:
    """Return a length with the side that its sign denotes."""
    words = negative if (figure.value or 0.0) < 0.0 else positive
    return f'{figure.value_with_unit.removeprefix(MINUS)} {words}'


def _describe_push(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    up, rotors = f['push_up'], len(sheet.vehicle.rotors)
    count = NUMBER_WORDS[rotors] if rotors < len(NUMBER_WORDS) else str(rotors)
    if up.value is not None and up.note:
        able = up.note if up.note.startswith('could') else f'is {up.note}'
        yield f'With its {count} rotor{"s" if rotors != 1 else ""} it {able}.'
    level = f['level_speed']
    if level.value:
        climb = f.get('climb_speed')
        more = f' and its top climb rate {climb.value_with_unit}' if climb and climb.value else ''
        yield f'Its top speed in level flight is {level.value_with_unit}{more}.'


def _describe_stability(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    if 'swing_pitch' not in f:
        yield 'It has no righting moment when tilted; a controller must stabilise it.'
        return
    half = f['damping_pitch'].note
    yield (
        f'After a tilt, it oscillates with a period of {f["swing_pitch"].value_with_unit}; {half}.'
    )
    tumble, level = f['tumble_speed'], f['level_speed']
    if tumble.value is not None and not math.isinf(tumble.value):
        yield f'The hull can tumble above {tumble.value_with_unit} ({tumble.note}).'
    lean = f.get('push_lean')
    if lean is not None and (lean.value or 0.0) >= 0.5 and level.value:
        yield f'At full forward thrust it tilts by {lean.value_with_unit}.'


def _describe_helium(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    if 'leak_low' not in f:
        return
    yield (
        f'By helium leakage it would lose {f["leak_low"].value_with_unit} to '
        f'{f["leak_high"].value_with_unit} of lift (assumed: a film like that of airships, '
        'because no value for this film was found).'
    )
    loss = f['hover_loss']
    if loss.value is not None:
        yield f'It can hover until {loss.value_with_unit} of lift are lost: {loss.note}.'
    if 'gains_loss' in f:
        held = f['gains_loss']
        yield (
            f'Its controller stays stable until {held.value_with_unit} of lift are lost: '
            f'{held.note}.'
        )


GUESS = 'yellow'


def show_sheet(sheet: VehicleSheet, report: Report, console: Console) -> None:
    """Print the description of a vehicle, then the tables of its report."""
    console.print(Text('\n'.join(f'• {line}' for line in describe_vehicle(sheet))))
    console.print()
    print_report(report, console)


def show_warnings(warnings: Sequence[str], console: Console) -> None:
    """Print the warnings."""
    for line in warnings:
        console.print(Text.assemble(('! ', GUESS), line))


def show_difference(
    difference: VehicleDifference, names: tuple[str, str], console: Console
) -> None:
    """Print the differing entries of two vehicles and the changed figures."""
    if not difference.changes:
        console.print(f'{names[0]} and {names[1]} have the same content.', highlight=False)
        return
    rows, sources = [], []
    for change in difference.changes:
        before, after = change.before, change.after
        source = after.source if after else 'removed'
        rows.append((
            change.place, before.value if before else MISSING_FIGURE, after.value if after else
            MISSING_FIGURE,
            source,
        ))  # fmt: skip
        sources += [source] if after is not None and after.is_assumed else []
    heads = ('place', 'before', 'after', 'source')
    title = f'Differences: {names[0]} → {names[1]}'
    print_table(TextTable(title, heads, rows, colors=dict.fromkeys(sources, 'bad')), console)
    if difference.changed_effects:
        console.print(
            'The figures do not include most effects. To see the influence of '
            f'{", ".join(difference.changed_effects)}, '
            'simulate both vehicles (lta simulate) and compare the flights (lta compare).',
            highlight=False,
        )
    show_warnings(difference.warnings, console)
    if not difference.consequences:
        if not difference.changed_effects and not difference.stale_aero_notes:
            console.print('No derived figure changes.')
        return
    heads = ('figure', 'before', 'after', 'change')
    rows = [format_figure_change(item) for item in difference.consequences]
    print_table(TextTable('Changes of the derived figures', heads, rows), console)


def format_figure_change(item: FigureChange) -> tuple[str, str, str, str]:
    """Return label, value before and after, and change of a figure."""
    texts = [
        figure.value_with_unit if figure else MISSING_FIGURE
        for figure in (item.before, item.after)
    ]
    return item.figure.words, texts[0], texts[1], format_change(item)


def format_change(item: FigureChange) -> str:
    """Format a change, such as '+1.2 g (+8 %)'."""
    shift = item.shift
    if shift is None or item.before is None:
        return ''
    figure = item.figure
    unit = 'points' if figure.unit == '%' else figure.unit
    text = f'{shift:+.{figure.digits}f} {unit}'.replace('-', '\N{MINUS SIGN}')
    if figure.unit == '%':
        return text  # a percentage of a percentage would be confusing
    # A change of more than 1000 % of a value near zero is not informative
    if not item.before.value or abs(shift / item.before.value) > 10.0:
        return text
    share = f'{100.0 * shift / abs(item.before.value):+.1f}'.replace('-', '\N{MINUS SIGN}')
    return f'{text} ({share} %)'


def encode_sheet(sheet: VehicleSheet, warnings: Sequence[str]) -> dict[str, object]:
    """Return a sheet as plain data."""
    file = sheet.vehicle.file
    return {
        'vehicle': file.name,
        'about': file.about,
        'words': [f'{format_headline(sheet)}.', *describe_vehicle(sheet)],
        'warnings': list(warnings),
        'figures': {figure.key: encode_figure(figure, sheet) for figure in sheet.figures},
        'budget': [
            {'layer': s.layer, 'part': s.part, 'mass': s.mass, 'unit': 'kg', 'source': s.source}
            for s in sheet.budget
        ],
        'numbers': [encode_entry(entry) for entry in sheet.numbers],
        'assumed': sheet.assumed_count,
    }


def encode_figure(figure: DerivedFigure, sheet: VehicleSheet) -> dict[str, object]:
    """Return one figure as plain data; infinity becomes None."""
    value = figure.value
    # JSON has no infinity
    finite = value is not None and abs(value) != float('inf')
    used, guessed = sheet.count_inputs(figure)
    return {
        'words': figure.words,
        'value': value if finite else None,
        'unit': figure.unit,
        'source': figure.source,
        'note': figure.note,
        'rests_on': used,
        'assumed': guessed,
    }


def encode_entry(entry: VehicleFileEntry | None) -> Mapping[str, object] | None:
    """Return one file entry as plain data, in SI units."""
    if entry is None:
        return None
    value = entry.numbers[0] if len(entry.numbers) == 1 else list(entry.numbers)
    return {
        'place': entry.place,
        'value': value if entry.numbers else entry.value,
        'unit': entry.unit or ('1' if entry.numbers else ''),
        'written': entry.value,
        'source': entry.source,
        'assumed': entry.is_assumed,
    }


def encode_difference(difference: VehicleDifference) -> dict[str, object]:
    """Return the differences of two vehicles as plain data."""
    return {
        'vehicles': [sheet.vehicle.file.name for sheet in (difference.before, difference.after)],
        'changes': [
            {
                'place': change.place,
                'before': encode_entry(change.before),
                'after': encode_entry(change.after),
            }
            for change in difference.changes
        ],
        'warnings': difference.warnings,
        'consequences': {
            item.figure.key: {
                'words': item.figure.words,
                'unit': item.figure.unit,
                'before': item.before.value if item.before else None,
                'after': item.after.value if item.after else None,
            }
            for item in difference.consequences
        },
    }

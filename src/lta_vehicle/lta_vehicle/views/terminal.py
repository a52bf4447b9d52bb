"""Print vehicle sheets and differences on a terminal."""

from collections.abc import Sequence

from lta_vehicle.difference import FigureChange, VehicleDifference
from lta_vehicle.figures.entries import GUESSED, VehicleFileEntry
from lta_vehicle.figures.figure import DerivedFigure, MISSING
from lta_vehicle.figures.sheet import VehicleSheet
from lta_vehicle.views.sheet_summary import describe_vehicle, format_headline
from lta_vehicle.views.side_view import draw_side_view
from rich.console import Console
from rich.table import Table
from rich.text import Text

QUIET = 'dim'
GUESS = 'yellow'
HEAD = 'bold'
PICTURE = 46  # characters
WIDE = 100


def show_sheet(
    sheet: VehicleSheet, warnings: Sequence[str], console: Console, everything: bool
) -> None:
    """Print a vehicle sheet; with `everything`, all numbers of the file as well."""
    console.print(Text(f'{format_headline(sheet)}.', HEAD))
    console.print(Text(sheet.vehicle.file.about, QUIET))
    console.print()
    picture = draw_side_view(sheet, PICTURE)
    words = Text('\n'.join(f'• {line}' for line in describe_vehicle(sheet)))
    # The sentences need about 44 characters beside the picture; otherwise put them below
    if console.width >= PICTURE + 44:
        table = Table.grid(padding=(0, 3))
        table.add_column(no_wrap=True, width=PICTURE)
        table.add_column()
        table.add_row(picture, words)
        console.print(table)
    else:
        console.print(picture)
        console.print(words)
    console.print()
    console.print(build_budget_table(sheet))
    for name, figures in sheet.groups.items():
        console.print()
        console.print(build_figures_table(name, figures, sheet, console.width))
    if everything:
        console.print()
        console.print(build_numbers_table(sheet.numbers, console.width >= WIDE))
    console.print()
    show_warnings(warnings, console)


def show_warnings(warnings: Sequence[str], console: Console) -> None:
    """Print the warnings."""
    for line in warnings:
        console.print(Text.assemble(('! ', GUESS), line))


def build_budget_table(sheet: VehicleSheet) -> Table:
    """Return the mass budget by layer."""
    table = _create_table('Mass budget')
    table.add_column('layer', style=HEAD)
    table.add_column('mass', justify='right', no_wrap=True)
    table.add_column('parts')
    layers: dict[str, list[tuple[str, float]]] = {}
    for share in sheet.budget:
        layers.setdefault(share.layer, []).append((share.part, share.mass))
    for layer, parts in layers.items():
        total = sum(mass for _, mass in parts)
        names = ', '.join(f'{part.replace("_", " ")} {1e3 * mass:.1f}' for part, mass in parts)
        table.add_row(layer.replace('_', ' '), f'{1e3 * total:.1f} g', Text(names, QUIET))
    return table


def build_figures_table(
    name: str, figures: Sequence[DerivedFigure], sheet: VehicleSheet, console_width: int
) -> Table:
    """Return the table of a group; all groups have equal widths if the console is wide enough."""
    table = _create_table(name)
    wide = console_width >= WIDE
    table.add_column('figure', width=40 if wide else None)
    table.add_column('value', justify='right', no_wrap=True, style=HEAD, width=11)
    table.add_column('computed from', width=console_width - 72 if wide else None)
    table.add_column('assumed', justify='right', no_wrap=True)
    for figure in figures:
        used, guessed = sheet.count_inputs(figure)
        words = Text(figure.words)
        if figure.note:
            words.append(f'\n{figure.note}', QUIET)
        share = Text(f'{guessed} of {used}' if used else '', GUESS if guessed else QUIET)
        guess = any(word in figure.source for word in GUESSED)
        if guess:
            share = Text('the rule', GUESS)
        source = Text(figure.source, GUESS if guess else QUIET)
        table.add_row(words, figure.value_with_unit, source, share)
    return table


def build_numbers_table(numbers: Sequence[VehicleFileEntry], wide: bool) -> Table:
    """Return a table of all numbers of the file with their sources."""
    table = _create_table('All numbers in the vehicle file')
    table.add_column('place', overflow='fold', no_wrap=wide)
    table.add_column('value', justify='right', style=HEAD)
    table.add_column('source')
    for entry in numbers:
        table.add_row(
            entry.place, entry.value, Text(entry.source, GUESS if entry.is_assumed else '')
        )
    return table


def show_difference(
    difference: VehicleDifference, names: tuple[str, str], console: Console
) -> None:
    """Print the differing entries of two vehicles and the changed figures."""
    if not difference.changes:
        console.print(f'{names[0]} and {names[1]} have the same content.', highlight=False)
        return
    changed = _create_table(f'Differences: {names[0]} → {names[1]}')
    changed.add_column('place', overflow='fold')
    changed.add_column('before', justify='right')
    changed.add_column('after', justify='right', style=HEAD)
    changed.add_column('source of the value after')
    for change in difference.changes:
        newer = change.after or change.before
        source = newer.source if newer else ''
        style = GUESS if newer is not None and newer.is_assumed else QUIET
        changed.add_row(
            change.place,
            change.before.value if change.before else MISSING,
            change.after.value if change.after else MISSING,
            Text(source if change.after else 'removed', style),
        )
    console.print(changed)
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
    follows = _create_table('Changes of the derived figures')
    follows.add_column('figure')
    for name, style in (('before', ''), ('after', HEAD), ('change', '')):
        follows.add_column(name, justify='right', no_wrap=True, style=style)
    for item in difference.consequences:
        follows.add_row(*format_figure_change(item))
    console.print(follows)


def format_figure_change(item: FigureChange) -> tuple[str, str, str, str]:
    """Return label, value before and after, and change of a figure."""
    shown = [figure.value_with_unit if figure else MISSING for figure in (item.before, item.after)]
    return item.figure.words, shown[0], shown[1], format_change(item)


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


def _create_table(title: str) -> Table:
    return Table(
        title=title,
        title_justify='left',
        title_style='bold',
        box=None,
        padding=(0, 2, 0, 0),
        header_style=QUIET,
    )

"""Print vehicle sheets and differences on a terminal."""

from collections.abc import Sequence

from lta_report.report import Report, TextTable
from lta_report.report_terminal import print_report, print_table
from lta_vehicle.difference import FigureChange, VehicleDifference
from lta_vehicle.figures.figure import MISSING
from lta_vehicle.figures.sheet import VehicleSheet
from lta_vehicle.views.sheet_summary import describe_vehicle
from lta_vehicle.views.side_view import draw_side_view
from rich.console import Console
from rich.table import Table
from rich.text import Text

GUESS = 'yellow'
PICTURE = 46  # characters


def show_sheet(sheet: VehicleSheet, report: Report, console: Console) -> None:
    """Print a drawing of a vehicle beside its description, then the tables of its report."""
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
            change.place, before.value if before else MISSING, after.value if after else MISSING,
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
    texts = [figure.value_with_unit if figure else MISSING for figure in (item.before, item.after)]
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

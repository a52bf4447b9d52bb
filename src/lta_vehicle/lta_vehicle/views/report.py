# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a vehicle sheet."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from lta_config.command_line import format_lta_command
from lta_report.formatting import Tile
from lta_report.html_elements import render_colors
from lta_report.palette import ESTIMATE, FILL, GOOD, TIME, TRUTH
from lta_report.report import (
    CellColor,
    Grid,
    HtmlBlock,
    Report,
    ReportSection,
    TextSection,
    TextTable,
)
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.mass_budget import CENTIMETRES, MassBudgetItem
from lta_vehicle.figures.sheet import GUESSED, VehicleSheet
from lta_vehicle.views.gondola import draw_gondola
from lta_vehicle.views.sheet_summary import describe_vehicle, encode_sheet, format_headline
from lta_vehicle.views.three_views import draw_three_views

DRAWING_COLOURS: Final = {'cg': ESTIMATE, 'lift': TRUTH, 'push': GOOD, 'film': FILL}
SHEET_TILES: Final = (
    ('heaviness', 'Heavier than air'), ('ballast', 'Ballast to add'),
    ('hover_duty', 'Hover duty'),
    ('push_up', 'Spare thrust up'), ('level_speed', 'Top speed in level flight'),
    ('climb_time', 'Time to climb 1 m'),
    ('swing_pitch', 'Oscillation period'), ('hover_loss', 'Tolerable lift loss'),
)  # fmt: skip
NOTES: Final = {
    'heaviness': 'carried by the rotors', 'ballast': 'at the position given in the vehicle file',
    'level_speed': 'altitude and heading held', 'climb_time': 'from rest, at full thrust',
    'swing_pitch': 'pitch, small angles',
}  # fmt: skip

FILTER: Final = (
    '<label class="filter"><input type="checkbox" id="only"> only assumed values</label>'
)


def build_report(
    sheet: VehicleSheet, warnings: Sequence[str], name: str, everything: bool = False
) -> Report:
    """
    Build the report of a vehicle.

    `warnings`: warnings of `lta vehicle check`. `name`: vehicle name as given on the command line.
    `everything`: whether the terminal lists all numbers of the file.
    """
    file = sheet.vehicle.file
    words = TextSection('In words', describe_vehicle(sheet), bullets=True)
    noted = [TextSection('Warnings', warnings, bullets=True)] if warnings else []
    summary = ReportSection('', [words, *noted, build_budget_table(sheet.budget)])
    numbers = [(each.place, each.value, each.source) for each in sheet.numbers]
    return Report(
        command='vehicle',
        subject=f'{file.name}{format_control_law(sheet)}',
        headline=f'{format_headline(sheet)}.',
        introduction=file.about,
        tiles=build_tiles(sheet.by_key),
        blocks=[
            Grid([HtmlBlock(render_drawing(sheet)), summary]),
            Grid([build_figure_table(name, sheet) for name in sheet.groups]),
            build_part_table(sheet.budget),
            HtmlBlock(FILTER),
            TextTable(
                'All numbers of the file and their sources', ('place', 'value', 'source'), numbers,
                printed=everything, colors=mark_assumed(each.source for each in sheet.numbers),
            ),
        ],
        data=encode_sheet(sheet, warnings),
        commands=suggest_commands(name),
        closing=[f'! {each}' for each in warnings],
        asset='vehicle.html',
    )  # fmt: skip


def render_drawing(sheet: VehicleSheet) -> str:
    """Return the figure with the views, and the colours of its parts in both themes."""
    colours = DRAWING_COLOURS | {f'l{k}': colour for k, colour in enumerate(TIME)}
    views = draw_three_views(sheet.vehicle, pressure_center_offset(sheet))
    return (
        f'{render_colors(colours)}'
        '<figure class="panel" id="panel-views" aria-labelledby="title-views">'
        f'<h2 id="title-views">Views</h2><div class="drawing" tabindex="0">{views}'
        f'{draw_gondola(sheet.vehicle)}</div><figcaption>To scale, with parts as boxes. Point at '
        'a part for its name and mass. Dashed: rotor mounts, if the file has no parts.'
        '<span class="swipe"> Swipe for the rest.</span></figcaption></figure>'
    )


def mark_assumed(sources: Iterable[str]) -> dict[str, CellColor]:
    """Return the colour of the sources that are neither measured nor published."""
    return {each: 'bad' for each in sources if any(word in each.lower() for word in GUESSED)}


def format_control_law(sheet: VehicleSheet) -> str:
    """Return the control law as a suffix of the page's kicker."""
    control = sheet.vehicle.file.control
    return f' · control law: {control.law.replace("_", " ")}' if control else ''


def pressure_center_offset(sheet: VehicleSheet) -> float:
    """Return the distance of the centre of pressure ahead of the hull centre [m]."""
    figure = sheet.by_key.get('cp_x')
    return 0.0 if figure is None or figure.value is None else figure.value / CENTIMETRES


def build_tiles(figures: Mapping[str, DerivedFigure]) -> list[Tile]:
    """Return the tiles of the most important figures."""
    tiles = []
    for key, words in SHEET_TILES:
        figure = figures.get(key)
        if figure is None:
            continue
        value, _, unit = figure.value_with_unit.partition(' ')
        note = NOTES.get(key) or figure.note
        # A missing or zero value needs its reason rather than the general note
        if not figure.value:
            note = figure.note or note
        tiles.append(Tile(words, value, unit, note))
    return tiles


def build_budget_table(shares: Sequence[MassBudgetItem]) -> TextTable:
    """Return the mass budget by layer."""
    layers: dict[str, list[MassBudgetItem]] = {}
    for share in shares:
        layers.setdefault(share.layer, []).append(share)
    total = sum(share.mass for share in shares)
    rows = []
    for layer, parts in layers.items():
        mass = sum(part.mass for part in parts)
        names = ', '.join(f'{each.part.replace("_", " ")} {1e3 * each.mass:.1f}' for each in parts)
        cells = (f'{1e3 * mass:.1f} g', f'{100 * mass / total:.0f} %', names)
        rows.append((layer.replace('_', ' '), *cells))
    return TextTable('Mass budget', ('layer', 'mass', 'share', 'parts [g]'), rows)


def build_figure_table(name: str, sheet: VehicleSheet) -> TextTable:
    """Return one group of derived figures, each with its source."""
    rows = []
    for figure in sheet.groups[name]:
        used, guessed = sheet.count_inputs(figure)
        words = f'{figure.words} ({figure.note})' if figure.note else figure.words
        inputs = f'{guessed} of {used}' if used else ''
        rows.append((words, figure.value_with_unit, figure.source, inputs))
    heads = ('figure', 'value', 'computed from', 'assumed')
    return TextTable(name, heads, rows, colors=mark_assumed(row[2] for row in rows))


def build_part_table(shares: Sequence[MassBudgetItem]) -> TextTable:
    """Return the parts with the sources of their masses."""
    rows = [
        (each.part.replace('_', ' '), each.layer.replace('_', ' '), f'{1e3 * each.mass:.1f} g',
         each.source)
        for each in shares
    ]  # fmt: skip
    heads, colors = ('part', 'layer', 'mass', 'source'), mark_assumed(row[3] for row in rows)
    return TextTable('Parts', heads, rows, printed=False, colors=colors)


def suggest_commands(name: str) -> dict[str, str]:
    """Return commands for the next steps."""
    return {
        'Check the file': format_lta_command('vehicle', 'check', name),
        'Create your own vehicle': format_lta_command(
            'vehicle', 'new', 'my_blimp', '--from', name
        ),
        'Show the effect of a change': format_lta_command(
            'vehicle', 'diff', name, '--set', 'trim.heaviness=4 g'
        ),
        'Simulate it': format_lta_command('simulate', '--vehicle', name),
        'Estimate its weight from a hover': format_lta_command(
            'vehicle', 'trim', 'BAG', '--vehicle', name
        ),
    }

"""Write a vehicle sheet as a self-contained HTML page."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_config.command_line import format_lta_command
from lta_report.formatting import Tile
from lta_report.html_elements import render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_report.palette import DARK, ESTIMATE, FILL, GOOD, TIME, TRUTH
from lta_vehicle.figures.entries import GUESSED, VehicleFileEntry
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.mass_budget import CENTIMETRES, MassBudgetItem
from lta_vehicle.figures.sheet import VehicleSheet
from lta_vehicle.views.gondola import draw_gondola
from lta_vehicle.views.sheet_summary import describe_vehicle, format_headline
from lta_vehicle.views.three_views import draw_three_views

COLOURS: Final = {'cg': ESTIMATE, 'lift': TRUTH, 'push': GOOD, 'film': FILL}
TILES: Final = (
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


def write_page(sheet: VehicleSheet, warnings: Sequence[str], name: str, out: Path) -> None:
    """Write the page; raise `BadInput` if it cannot be written."""
    write_file(render_page(sheet, warnings, name), out)


def render_page(sheet: VehicleSheet, warnings: Sequence[str], name: str) -> str:
    """
    Render the page.

    `warnings`: warnings of `lta vehicle check`. `name`: vehicle name as given on the command line.
    """
    file = sheet.vehicle.file
    colours = COLOURS | {f'layer{k}': colour for k, colour in enumerate(TIME)}
    colours |= {f'{key}_dark': DARK[colour] for key, colour in colours.items()}
    return assemble_page(
        'vehicle.html',
        title=f'{escape(format_headline(sheet))}.',
        kicker=escape(f'vehicle · {file.name}{format_control_law(sheet)}'),
        about=escape(file.about),
        tiles='\n'.join(render_tile(*tile) for tile in build_tiles(sheet.by_key)),
        drawing=draw_three_views(sheet.vehicle, pressure_center_offset(sheet))
        + draw_gondola(sheet.vehicle),
        words=render_list(describe_vehicle(sheet)),
        warnings=render_warnings(warnings),
        budget='\n'.join(render_budget_rows(sheet.budget)),
        groups='\n'.join(render_figure_group(name, sheet) for name in sheet.groups),
        parts='\n'.join(map(render_part_row, sheet.budget)),
        numbers='\n'.join(map(render_number_row, sheet.numbers)),
        facts={},
        commands=suggest_commands(name),
        files={},
        has_plots=False,
        has_scene=False,
        **colours,
    )


def format_control_law(sheet: VehicleSheet) -> str:
    """Return the control law as a suffix of the page's kicker."""
    control = sheet.vehicle.file.control
    return f' · control law: {control.law.replace("_", " ")}' if control else ''


def pressure_center_offset(sheet: VehicleSheet) -> float:
    """Return the distance of the centre of pressure ahead of the hull centre. [m]"""
    figure = sheet.by_key.get('cp_x')
    return 0.0 if figure is None or figure.value is None else figure.value / CENTIMETRES


def build_tiles(figures: Mapping[str, DerivedFigure]) -> list[Tile]:
    """Return the tiles of the most important figures."""
    tiles = []
    for key, words in TILES:
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


def render_list(lines: Sequence[str]) -> str:
    """Return sentences as HTML list items."""
    return '\n'.join(f'        <li>{escape(line)}</li>' for line in lines)


def render_warnings(warnings: Sequence[str]) -> str:
    """Return the warnings as a list with a heading; '' if there are none."""
    if not warnings:
        return ''
    return (
        f'      <h2 class="guess">Warnings</h2>\n      <ul class="words">\n'
        f'{render_list(warnings)}\n      </ul>'
    )


def render_budget_rows(shares: Sequence[MassBudgetItem]) -> list[str]:
    """Return the mass budget by layer, with bars."""
    layers: dict[str, float] = {}
    for share in shares:
        layers[share.layer] = layers.get(share.layer, 0.0) + share.mass
    total, most = sum(layers.values()), max(layers.values())
    return [
        f'<tr><th scope="row">{escape(layer.replace("_", " "))}</th>'
        f'<td>{1e3 * mass:.1f} g</td><td>{100 * mass / total:.0f} %</td>'
        f'<td aria-hidden="true"><div class="share" style="width: {100 * mass / most:.1f}%"></div>'
        '</td></tr>'
        for layer, mass in layers.items()
    ]


def render_figure_group(name: str, sheet: VehicleSheet) -> str:
    """Return one group of derived figures as a table."""
    rows = '\n'.join(render_figure_row(figure, sheet) for figure in sheet.groups[name])
    slug = name.lower().replace(' ', '-')
    return (
        f'<section class="panel" aria-labelledby="title-{slug}"><h2 id="title-{slug}">'
        f'{escape(name)}</h2><table class="plain"><caption class="hidden">{escape(name)}'
        f'</caption><thead><tr><th scope="col">Figure</th><th scope="col">Value</th>'
        f'<th scope="col" style="text-align: left; padding-left: 16px">Follows from</th></tr>'
        f'</thead><tbody>{rows}</tbody></table></section>'
    )


def render_figure_row(figure: DerivedFigure, sheet: VehicleSheet) -> str:
    """Return the table row of a derived figure, with its source."""
    used, guessed = sheet.count_inputs(figure)
    basis = ''
    if used:
        kind = ' class="guess"' if guessed else ''
        basis = f'<small{kind}>{used} numbers, {guessed} of them assumed</small>'
    note = f'<small>{escape(figure.note)}</small>' if figure.note else ''
    return (
        f'<tr><th scope="row">{escape(figure.words)}{note}</th>'
        f'<td class="value">{escape(figure.value_with_unit)}</td>'
        f'<td class="why">{render_number_source(figure.source)}{basis}</td></tr>'
    )


def render_part_row(share: MassBudgetItem) -> str:
    """Return the table row of a part in the mass budget."""
    return (
        f'<tr><th scope="row">{escape(share.part.replace("_", " "))}</th>'
        f'<td>{escape(share.layer.replace("_", " "))}</td>'
        f'<td class="value">{1e3 * share.mass:.1f} g</td>'
        f'<td class="why">{render_number_source(share.source)}</td></tr>'
    )


def render_number_row(entry: VehicleFileEntry) -> str:
    """Return the table row of a number in the file."""
    kind = 'assumption' if entry.is_assumed else 'known'
    return (
        f'<tr class="{kind}"><th scope="row">{insert_line_breaks(entry.place)}</th>'
        f'<td class="value">{escape(entry.value)}</td>'
        f'<td class="why">{render_number_source(entry.source)}</td></tr>'
    )


def insert_line_breaks(place: str) -> str:
    """Return a path with optional line breaks after dots and underscores."""
    # Long paths would otherwise widen the table beyond a phone's screen
    return escape(place).replace('.', '.<wbr>').replace('_', '_<wbr>')


def render_number_source(source: str) -> str:
    """Return a source as HTML, tagged if it is an assumption."""
    words = escape(source)
    if any(word in source.lower() for word in GUESSED):
        return f'<span class="tag">assumed</span> {"" if source == "assumed" else words}'
    return words


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

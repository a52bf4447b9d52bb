"""One vehicle as one self-contained HTML file, in the look of a flight's page."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_config.typed import typed
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.palette import DARK, ESTIMATE, FILL, GOOD, TIME, TRUTH
from lta_report.pieces import tile_html
from lta_vehicle.figures.entries import Entry, GUESSED
from lta_vehicle.figures.figure import Figure
from lta_vehicle.figures.sheet import Sheet
from lta_vehicle.figures.weighing import CENTIMETRES, Share
from lta_vehicle.views.detail import detail
from lta_vehicle.views.drawing import drawing
from lta_vehicle.views.words import headline, sentences

COLOURS: Final = {'cg': ESTIMATE, 'lift': TRUTH, 'push': GOOD, 'film': FILL}
TILES: Final = (
    ('heaviness', 'Heavier than air'), ('ballast', 'Ballast to add'),
    ('hover_duty', 'Hover duty'),
    ('push_up', 'Push to spare'), ('level_speed', 'Top speed, level'),
    ('climb_time', 'Climb of 1 m'),
    ('swing_pitch', 'Swings in'), ('hover_loss', 'Helium to lose'),
)  # fmt: skip
NOTES: Final = {
    'heaviness': 'what the rotors carry', 'ballast': 'in the place that the file gives',
    'level_speed': 'altitude and heading held', 'climb_time': 'from rest, at full push',
    'swing_pitch': 'pitch, small angles',
}  # fmt: skip


def write_page(sheet: Sheet, warnings: Sequence[str], name: str, out: Path) -> None:
    """Write the page of a vehicle; `BadInput` where it cannot be written."""
    written(page(sheet, warnings, name), out)


def page(sheet: Sheet, warnings: Sequence[str], name: str) -> str:
    """
    Return the whole page.

    Parameters
    ----------
    sheet : Sheet
        What the vehicle is and can do.
    warnings : sequence of str
        What `lta vehicle check` would say of it.
    name : str
        As the vehicle was named on the command line.

    """
    file = sheet.vehicle.file
    colours = COLOURS | {f'layer{k}': colour for k, colour in enumerate(TIME)}
    colours |= {f'{key}_dark': DARK[colour] for key, colour in colours.items()}
    return framed(
        'vehicle.html',
        title=f'{escape(headline(sheet))}.',
        kicker=escape(f'vehicle · {file.name}{law_of(sheet)}'),
        about=escape(file.about),
        tiles='\n'.join(tile_html(*tile) for tile in tiles(sheet.by_key)),
        drawing=drawing(sheet.vehicle, pressure_of(sheet)) + detail(sheet.vehicle),
        words=listed(sentences(sheet)),
        warnings=warned(warnings),
        budget='\n'.join(budget_rows(sheet.budget)),
        groups='\n'.join(group_html(name, sheet) for name in sheet.groups),
        parts='\n'.join(map(part_row, sheet.budget)),
        numbers='\n'.join(map(number_row, sheet.numbers)),
        facts={},
        commands=commands(name),
        files={},
        drawn=False,
        **colours,
    )


def law_of(sheet: Sheet) -> str:
    """Return how it is flown, to be put behind its name."""
    control = sheet.vehicle.file.control
    return f' · flown by {control.law.replace("_", " ")}' if control else ''


def pressure_of(sheet: Sheet) -> float:
    """Return where the centre of pressure is, ahead of the hull centre. [m]."""
    found = sheet.by_key.get('cp_x')
    return 0.0 if found is None or found.value is None else found.value / CENTIMETRES


def tiles(figures: Mapping[str, Figure]) -> list[Tile]:
    """Return the figures that matter most."""
    found = []
    for key, words in TILES:
        figure = figures.get(key)
        if figure is None:
            continue
        value, _, unit = figure.shown.partition(' ')
        note = NOTES.get(key) or figure.note
        if not figure.value:
            note = figure.note or note
        found.append(Tile(words, value, unit, note))
    return found


def listed(lines: Sequence[str]) -> str:
    """Return sentences as a list."""
    return '\n'.join(f'        <li>{escape(line)}</li>' for line in lines)


def warned(warnings: Sequence[str]) -> str:
    """Return warnings as a list with a heading; nothing where there are none."""
    if not warnings:
        return ''
    return (
        f'      <h2 class="guess">Look at this</h2>\n      <ul class="words">\n'
        f'{listed(warnings)}\n      </ul>'
    )


def budget_rows(shares: Sequence[Share]) -> list[str]:
    """Return the mass budget by layer, each with a bar."""
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


def group_html(name: str, sheet: Sheet) -> str:
    """Return one group of derived figures as a table."""
    rows = '\n'.join(figure_row(figure, sheet) for figure in sheet.groups[name])
    slug = name.lower().replace(' ', '-')
    return (
        f'<section class="panel" aria-labelledby="title-{slug}"><h2 id="title-{slug}">'
        f'{escape(name)}</h2><table class="plain"><caption class="hidden">{escape(name)}'
        f'</caption><thead><tr><th scope="col">Figure</th><th scope="col">Value</th>'
        f'<th scope="col" style="text-align: left; padding-left: 16px">Follows from</th></tr>'
        f'</thead><tbody>{rows}</tbody></table></section>'
    )


def figure_row(figure: Figure, sheet: Sheet) -> str:
    """Return one derived figure with what it follows from."""
    used, guessed = sheet.rests_on(figure)
    basis = ''
    if used:
        kind = ' class="guess"' if guessed else ''
        basis = f'<small{kind}>{used} numbers, {guessed} of them assumed</small>'
    note = f'<small>{escape(figure.note)}</small>' if figure.note else ''
    return (
        f'<tr><th scope="row">{escape(figure.words)}{note}</th>'
        f'<td class="value">{escape(figure.shown)}</td>'
        f'<td class="why">{source_html(figure.source)}{basis}</td></tr>'
    )


def part_row(share: Share) -> str:
    """Return one part of the mass budget."""
    return (
        f'<tr><th scope="row">{escape(share.part.replace("_", " "))}</th>'
        f'<td>{escape(share.layer.replace("_", " "))}</td>'
        f'<td class="value">{1e3 * share.mass:.1f} g</td>'
        f'<td class="why">{source_html(share.source)}</td></tr>'
    )


def number_row(entry: Entry) -> str:
    """Return one number of the file."""
    kind = 'assumption' if entry.assumed else 'known'
    return (
        f'<tr class="{kind}"><th scope="row">{breakable(entry.place)}</th>'
        f'<td class="value">{escape(entry.value)}</td>'
        f'<td class="why">{source_html(entry.source)}</td></tr>'
    )


def breakable(place: str) -> str:
    """Return a place in the file that may break behind its points and underscores."""
    return escape(place).replace('.', '.<wbr>').replace('_', '_<wbr>')


def source_html(source: str) -> str:
    """Return a source, marked where it is a guess."""
    words = escape(source)
    if any(word in source.lower() for word in GUESSED):
        return f'<span class="tag">assumed</span> {"" if source == "assumed" else words}'
    return words


def commands(name: str) -> dict[str, str]:
    """Return what to do next."""
    return {
        'Find what is wrong with it': typed('vehicle', 'check', name),
        'Start one of your own': typed('vehicle', 'new', 'my_blimp', '--from', name),
        'See what a change does': typed('vehicle', 'diff', name, '--set', 'trim.heaviness=4 g'),
        'Fly it': typed('simulate', '--vehicle', name),
        'Weigh it by a hover': typed('vehicle', 'trim', 'BAG', '--vehicle', name),
    }

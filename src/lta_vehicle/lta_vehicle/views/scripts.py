"""A vehicle, and where two differ, for scripts: what --json prints."""

from collections.abc import Mapping, Sequence

from lta_vehicle.difference import Difference
from lta_vehicle.figures.entries import Entry
from lta_vehicle.figures.figure import Figure
from lta_vehicle.figures.sheet import Sheet
from lta_vehicle.views.words import headline, sentences


def plain(sheet: Sheet, warnings: Sequence[str]) -> dict[str, object]:
    """Return a sheet for scripts."""
    file = sheet.vehicle.file
    return {
        'vehicle': file.name,
        'about': file.about,
        'words': [f'{headline(sheet)}.', *sentences(sheet)],
        'warnings': list(warnings),
        'figures': {figure.key: plain_figure(figure, sheet) for figure in sheet.figures},
        'budget': [
            {'layer': s.layer, 'part': s.part, 'mass': s.mass, 'unit': 'kg', 'source': s.source}
            for s in sheet.budget
        ],
        'numbers': [plain_entry(entry) for entry in sheet.numbers],
        'assumed': sheet.assumed,
    }


def plain_figure(figure: Figure, sheet: Sheet) -> dict[str, object]:
    """Return one figure for scripts; infinity is null with its note."""
    value = figure.value
    finite = value is not None and abs(value) != float('inf')
    used, guessed = sheet.rests_on(figure)
    return {
        'words': figure.words,
        'value': value if finite else None,
        'unit': figure.unit,
        'source': figure.source,
        'note': figure.note,
        'rests_on': used,
        'assumed': guessed,
    }


def plain_entry(entry: Entry | None) -> Mapping[str, object] | None:
    """Return one number of a file for scripts, in SI."""
    if entry is None:
        return None
    value = entry.numbers[0] if len(entry.numbers) == 1 else list(entry.numbers)
    return {
        'place': entry.place,
        'value': value if entry.numbers else entry.value,
        'unit': entry.unit or ('1' if entry.numbers else ''),
        'written': entry.value,
        'source': entry.source,
        'assumed': entry.assumed,
    }


def plain_difference(found: Difference) -> dict[str, object]:
    """Return where two vehicles differ for scripts."""
    return {
        'vehicles': [sheet.vehicle.file.name for sheet in (found.before, found.after)],
        'changes': [
            {
                'place': change.place,
                'before': plain_entry(change.before),
                'after': plain_entry(change.after),
            }
            for change in found.changes
        ],
        'warnings': found.kept,
        'consequences': {
            item.figure.key: {
                'words': item.figure.words,
                'unit': item.figure.unit,
                'before': item.before.value if item.before else None,
                'after': item.after.value if item.after else None,
            }
            for item in found.consequences
        },
    }

"""Encode vehicle sheets and differences as JSON."""

from collections.abc import Mapping, Sequence

from lta_vehicle.difference import VehicleDifference
from lta_vehicle.figures.entries import VehicleFileEntry
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.sheet import VehicleSheet
from lta_vehicle.views.sheet_summary import describe_vehicle, format_headline


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

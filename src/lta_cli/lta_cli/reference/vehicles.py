"""The shipped vehicles as a page, from their files and what follows from these."""

from lta_config.files import list_shipped
from lta_model.vehicle import load_vehicle
from lta_vehicle.figures.sheet import build_sheet, VehicleSheet

HEAD = """# Vehicles

Generated from `config/vehicles` by `python -m lta_cli.reference vehicles > docs/vehicles.md`.

Each is one file. Every number in it has its source; *assumed* are those that nobody measured or
published. What is below follows from the files: `./lta vehicle show NAME` draws it and says from
which numbers, `./lta vehicle diff A B` says what differs. Level speed is where full forward push
equals drag; what a hull can hold without rising or tumbling may be less (`./lta wind`).

"""
COLUMNS = {  # the figure of a sheet, and its heading
    'mass': 'mass, gas included',
    'heaviness': 'heavier than air by',
    'level_speed': 'level speed',
    'climb_speed': 'climb',
    'yaw_rate': 'turn',
    'hover_duty': 'hover duty',
    'hover_power': 'hover power',
}


def render_page() -> str:
    """Return the page: one table to compare, then each vehicle."""
    sheets = [build_sheet(load_vehicle(name)) for name in list_shipped('vehicles')]
    titles = ['vehicle', *COLUMNS.values(), 'rotors', 'numbers', 'assumed']
    rows = '\n'.join(f'| {" | ".join(format_cells(sheet))} |' for sheet in sheets)
    table = f'| {" | ".join(titles)} |\n|{"---|" * len(titles)}\n{rows}\n'
    return HEAD + table + ''.join(format_section(sheet) for sheet in sheets)


def format_cells(sheet: VehicleSheet) -> list[str]:
    """Return a vehicle's row of the table; empty where a figure is none of this vehicle's."""
    file, figures = sheet.vehicle.file, sheet.by_key
    told = [figures[key].value if key in figures else None for key in COLUMNS]
    units = [figures[key].unit if key in figures else '' for key in COLUMNS]
    texts = [format_amount(v, u) for v, u in zip(told, units, strict=True)]
    counts = (len(file.rotors), len(sheet.numbers), sheet.assumed_count)
    return [f'[`{file.name}`](#{file.name})', *texts, *map(str, counts)]


def format_amount(value: float | None, unit: str) -> str:
    """Return three digits of a figure with its unit; a speed of 0 is one that nobody can tell."""
    if value is None or (value == 0.0 and unit in {'m/s', '°/s'}):
        return ''
    return f'{value:.0f} {unit}' if abs(value) >= 1000.0 else f'{value:.3g} {unit}'


def format_section(sheet: VehicleSheet) -> str:
    """Return what one vehicle is: in words, its control law, its effects."""
    file = sheet.vehicle.file
    law = file.control.law if file.control else 'none'
    effects = ', '.join(f'`{name}`' for name in sorted(file.effects)) or 'none of its own'
    return (
        f'\n## {file.name}\n{" ".join(file.about.split())}\n\n'
        f'Control: `{law}`. Effects: {effects}.\n'
    )

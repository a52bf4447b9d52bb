# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Generate the page of the shipped vehicles from their files."""

from lta_config.files import list_shipped_names
from lta_model.vehicle import load_vehicle
from lta_vehicle.figures.sheet import build_sheet, VehicleSheet

HEAD = """# Vehicles

Generated from `config/vehicles` by `make reference`.

Each vehicle is one file. Every number in it has a source; *assumed* numbers were neither measured
nor published. The figures below are derived from the files: `./lta vehicle show NAME` shows how,
`./lta vehicle diff A B` compares two vehicles. Level speed is the speed at which full forward
thrust equals drag; the hull may rise or tumble at a lower speed (`./lta wind`).

![GT-MAB from three sides, and its layers below the hull](images/vehicle.png)

"""
COLUMNS = {  # key of a sheet's figure, and its heading
    'mass': 'mass, gas included',
    'heaviness': 'heavier than air by',
    'level_speed': 'level speed',
    'climb_speed': 'climb',
    'yaw_rate': 'turn',
    'hover_duty': 'hover duty',
    'hover_power': 'hover power',
}


def render_page() -> str:
    """Return the page: a comparison table, then a section for each vehicle."""
    sheets = [build_sheet(load_vehicle(name)) for name in list_shipped_names('vehicles')]
    titles = ['vehicle', *COLUMNS.values(), 'rotors', 'numbers', 'assumed']
    rows = '\n'.join(f'| {" | ".join(format_vehicle_row(sheet))} |' for sheet in sheets)
    table = f'| {" | ".join(titles)} |\n|{"---|" * len(titles)}\n{rows}\n'
    return HEAD + table + ''.join(format_vehicle_section(sheet) for sheet in sheets)


def format_vehicle_row(sheet: VehicleSheet) -> list[str]:
    """Return a vehicle's table row; figures that do not apply are empty."""
    file, figures = sheet.vehicle.file, sheet.by_key
    values = [figures[key].value if key in figures else None for key in COLUMNS]
    units = [figures[key].unit if key in figures else '' for key in COLUMNS]
    texts = [format_amount(v, u) for v, u in zip(values, units, strict=True)]
    counts = (len(file.rotors), len(sheet.numbers), sheet.assumed_count)
    return [f'[`{file.name}`](#{file.name})', *texts, *map(str, counts)]


def format_amount(value: float | None, unit: str) -> str:
    """Format a figure to three digits with its unit; empty for a speed of 0 (unknown)."""
    if value is None or (value == 0.0 and unit in {'m/s', '°/s'}):
        return ''
    # .3g would show large values with an exponent
    return f'{value:.0f} {unit}' if abs(value) >= 1000.0 else f'{value:.3g} {unit}'


def format_vehicle_section(sheet: VehicleSheet) -> str:
    """Return the section of a vehicle: description, control law and effects."""
    file = sheet.vehicle.file
    law = file.control.law if file.control else 'none'
    effects = ', '.join(f'`{name}`' for name in sorted(file.effects)) or 'none of its own'
    return (
        f'\n## {file.name}\n{" ".join(file.about.split())}\n\n'
        f'Control: `{law}`. Effects: {effects}.\n'
    )

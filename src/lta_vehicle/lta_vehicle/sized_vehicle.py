"""
Create a vehicle file and its gains from what a pilot can weigh and measure.

Given are the size of the envelope, the mass without gas, and number, thrust and place of the
motors. Volume, lift, ballast, inertia and added mass follow from the file.
"""

from collections.abc import Mapping
from pathlib import Path
import re
from typing import Any

from lta_config.errors import BadInput
from lta_config.files import list_shipped_names, validate_content
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.vehicle_edit import format_yaml
from lta_model.vehicle import Vehicle
from lta_vehicle.gains_estimate import format_gains
from lta_vehicle.new_vehicle import check_vehicle_name, write_new_file
from lta_vehicle.vehicle_estimate import build_blocks
from lta_vehicle.vehicle_size import VehicleSize


def write_sized_vehicle(name: str, size: VehicleSize, out: Path) -> tuple[Vehicle, Path]:
    """
    Write a vehicle file and, beside it, its gains; return the vehicle and the gains file.

    Raise `BadInput` if the vehicle cannot fly, or a file exists or cannot be written.
    """
    check_vehicle_name(name)
    if name in list_shipped_names('vehicles'):
        raise BadInput(f'{name} is the name of a shipped vehicle; choose another one.')
    if out.is_dir():
        raise BadInput(f'{out} is a folder; name a file, such as {out / name}.yaml.')
    gains = out.with_name(f'{name}.gains.yaml')
    blocks = build_blocks(name, size, gains.name)
    vehicle = Vehicle(validate_content(VehicleFile, blocks, f'The vehicle {name}'))
    _ = vehicle.hover_duty  # raises BadInput if the motors cannot lift it
    if gains.exists() or gains == out:
        raise BadInput(f'{gains} already exists; choose another one with --file.')
    texts = format_vehicle_file(blocks, vehicle, size), format_gains(vehicle)
    write_new_file(out, texts[0])
    try:
        write_new_file(gains, texts[1])
    except BadInput:
        out.unlink()
        raise
    return vehicle, gains


def describe_balance(vehicle: Vehicle) -> str:
    """Return in words what the gas and the ballast leave to the motors."""
    heavy = 1e3 * vehicle.heaviness
    if vehicle.file.trim.ballast == 'none':
        return f'{heavy:.3g} g heavier than air, which the motors carry'
    way = 'lighter than air: tether it' if heavy < 0.0 else 'heavier than air'
    return f'{1e3 * vehicle.ballast_mass:.0f} g of ballast leave it {abs(heavy):.2g} g {way}'


def format_vehicle_file(blocks: Mapping[str, Any], vehicle: Vehicle, size: VehicleSize) -> str:
    """Return the text of the vehicle file, with what follows from it as comments."""
    added = vehicle.added_mass
    cm = f'{100.0 * -vehicle.cg[2]:.1f}'
    gas = f'{1e3 * vehicle.gross_lift:.1f} g lift of {vehicle.volume:.4g} m3'
    inertia = ', '.join(f'{each:.3g}' for each in vehicle.inertia.diagonal())
    masses = ', '.join(f'{1e3 * each:.3g}' for each in added[:3])
    head = [
        f'# {vehicle.file.name}: written by lta vehicle new from size, mass and motors.',
        '#',
        '# What follows from the numbers below (lta vehicle show computes it anew):',
        f'#   gas        {gas}; {size.mass * 1e3:.4g} g without gas',
        f'#   balance    {describe_balance(vehicle)}',
        f'#   gravity    centre {cm} cm below the hull centre',
        f'#   inertia    {inertia} kg m2 about x, y, z: envelope, gondola, ballast and gas',
        f'#   added mass {masses} g along x, y, z (Lamb 1932, spheroid)',
        '#',
        '# Weigh and measure first what has the source "assumed" and a wide range: the envelope',
        '# alone, the depth of the gondola, the thrust of a motor at full and half duty. What a',
        '# scale does not tell, flights do: lta tests plan.',
    ]
    # A blank line before each block
    text = re.sub(r'(?m)^(?=\w+:\n)', '\n', format_yaml(blocks))
    return '\n'.join(head) + f'\n\n{text}'

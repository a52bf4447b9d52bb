# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Create a vehicle file: a renamed copy of another, comments included, or one by size.

For the latter, given are the size of the envelope, the mass without gas, and number, thrust and
place of the motors. Volume, lift, ballast, inertia and added mass follow from the file.
"""

from collections.abc import Mapping
import math
from pathlib import Path
import re
from typing import Any, Final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names, validate_content
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.vehicle_edit import format_yaml
from lta_model import limits
from lta_model.vehicle import load_vehicle, Vehicle
from lta_sim.wind_limits import rise_speed
from lta_vehicle.vehicle_estimate import build_blocks, round_digits, VehicleSize

VEHICLE_NAME_PATTERN = re.compile(r'[a-z][a-z0-9_]*')
# The top-level key only: nested keys are indented
NAME_LINE = re.compile(r'(?m)^name:[ \t]*\S.*$')
COPY_HEAD = """\
# {name}: copied from {model}.
#
# Replace the numbers with your own. Weigh each part, measure its position from the hull centre,
# and give the source of each number: "measured, kitchen scale", "data sheet", or "assumed" if
# it is a guess. Then:
#   lta vehicle check {file}      check it for errors
#   lta vehicle show {file}       show its properties and performance
#   lta vehicle diff {model} {file}      show what your changes did
# The rest of this file was written for {model}.
#
"""


def check_vehicle_name(name: str) -> None:
    """Raise `BadInput` for an invalid name of a vehicle."""
    if not VEHICLE_NAME_PATTERN.fullmatch(name):
        raise BadInput(
            f"Invalid vehicle name '{name}'; use lower-case letters, digits and "
            'underscores, and begin with a letter.'
        )


def format_new_vehicle(name: str, model: str) -> str:
    """
    Return the text of a new vehicle file.

    `name`: name of the new vehicle: lower-case letters, digits and underscores. `model`: vehicle
    name or file to copy. Raise `BadInput` if the name is invalid, or the model cannot be read.
    """
    check_vehicle_name(name)
    copied = load_vehicle(model).file.name  # raises BadInput if the model itself is invalid
    text = find_file('vehicle', model).read_text(encoding='utf-8')
    # Edit the text and not the parsed YAML, which would lose the comments
    renamed, count = NAME_LINE.subn(f'name: {name}', text, count=1)
    if count != 1:
        raise BadInput(f"{find_file('vehicle', model)} has no line 'name: ...'; add one.")
    return COPY_HEAD.format(name=name, model=copied, file=f'{name}.yaml') + renamed


def write_new_vehicle(name: str, model: str, out: Path) -> None:
    """Write a new vehicle file; raise `BadInput` if it exists or cannot be written."""
    write_new_file(out, format_new_vehicle(name, model))
    load_vehicle(str(out.absolute()))  # the copy must be valid under its new name


def write_new_file(out: Path, text: str) -> None:
    """Write a file; raise `BadInput` if it exists or cannot be written."""
    try:
        # Mode 'x' never overwrites an existing file
        with out.open('x', encoding='utf-8') as stream:
            stream.write(text)
    except FileExistsError:
        raise BadInput(f'{out} already exists; choose another one with --file.') from None
    except OSError as error:
        raise BadInput(
            f'{out} cannot be written ({error.strerror}); choose another one with --file.'
        ) from None


LEAN: Final = math.radians(20.0)  # largest tilt under forward thrust


def format_gains(vehicle: Vehicle) -> str:
    """
    Return a file of gains for the cascade, scaled to mass, inertia and thrust.

    The bandwidths (1/s) are those of the hand-tuned gains of GT-MAB and Blimp2b, rounded: 0.65 in
    heave, 2 in yaw, 0.4 in surge. Limits leave each axis a share of the thrust that the others
    keep.
    """
    m, added = vehicle.mass, vehicle.added_mass
    surge, heave = m + added[0], m + added[2]
    turn = float(vehicle.inertia[2, 2]) + added[5]
    columns = [(rotor.column, rotor.full_thrust) for rotor in vehicle.rotors]
    up = sum(max(column[2], 0.0) * full for column, full in columns)
    ahead = sum(max(column[0], 0.0) * full for column, full in columns)
    yaw = sum(abs(column[5]) * full for column, full in columns)
    depth = float(-vehicle.cg[2])
    lowest = max(-rotor.place[2] for rotor in vehicle.rotors)
    # The forward thrust that the righting moment holds at the largest tilt
    level = m * STANDARD_GRAVITY * depth * math.sin(LEAN) / lowest
    push = min(0.5 * ahead, level)
    drag = vehicle.file.aero.quadratic_drag.force.vector[0]
    # Without a motor that holds it down it rises at any speed, so that is no limit
    rise = rise_speed(vehicle) if up else math.inf
    top = min(math.sqrt(push / drag), limits.tumble_speed(vehicle), rise, 2.0)
    lines = [
        'altitude_kp: 0.4',
        'climb_limit: 0.15',
        f'climb: {_format_loop(0.65 * heave, 0.2, 0.65 * up)}',
        'heading_kp: 0.5',
        'yaw_rate_limit: 0.5',
        f'yaw_rate: {_format_loop(2.0 * turn, 0.25, 0.25 * yaw)}',
        f'speed: {_format_loop(0.4 * surge, 0.1, push)}',
        'turn_first: 0.9',
        'drift_gain: 1.0',
        'drift_limit: 0.6',
        f'speed_limit: {round_digits(max(0.9 * top, 0.05))}',
        'rise_limit: 0.4',
        f'swing_gain: {round_digits(0.2 * surge)}',
    ]
    head = (
        f'# Gains of the cascade for {vehicle.file.name}, computed from mass, inertia and thrust '
        'by lta vehicle new: assumed.\n# Tune them with lta tune, and name the new file in '
        'control.gains of the vehicle file.\n'
    )
    return head + '/**/controller:\n  ros__parameters:\n    gains:\n' + ''.join(
        f'      {line}\n' for line in lines
    )  # fmt: skip


def _format_loop(kp: float, integral: float, limit: float) -> str:
    first, second, third = map(round_digits, (kp, integral * kp, limit))
    return f'{{kp: {first}, ki: {second}, kd: 0.0, limit: {third}}}'


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

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Validate a vehicle file: list all faults, and warn about unusual values.

A vehicle with faults cannot fly; one with warnings can. Thresholds of warnings are assumed.
"""

from collections.abc import Iterator
from functools import partial
import math
from pathlib import Path
from typing import Final, final, NamedTuple

from lta_config.constants import AIR_DENSITY
from lta_config.errors import BadInput
from lta_config.files import find_file, format_errors, KIND_FOLDERS, list_shipped_names
from lta_config.schema.vehicle_file import load_vehicle_content, VehicleFile
from lta_model import effect_parameters, mass_properties, propulsion
from lta_model.model import STEP_NS
from lta_model.vehicle import load_vehicle, Vehicle
from lta_vehicle.difference import find_stale_columns
from lta_vehicle.figures.sheet import build_sheet, list_numbers, VehicleSheet
from pydantic import ValidationError

SHALLOW: Final = 2.0  # least depth of the CG below the CB [cm]
LEANING: Final = 3.0  # largest tilt at rest [deg]
STEEP: Final = 30.0  # largest tilt at full forward thrust [deg]
BUSY: Final = 70.0  # largest hover duty [%]
SOON: Final = 7.0  # least hover endurance at the highest leak rate [days]
LEAST_BALLAST: Final = 1.0  # least ballast that can still be removed [g]
DISAGREE: Final = 0.03  # relative; displaced air (weighed, hull) and sizes (envelope, hull)
COPIED: Final = 0.5  # share of numbers of another vehicle, with their sources
IMPURE: Final = 0.8  # least purity of the gas [1]


@final
class VehicleValidation(NamedTuple):
    """Faults and warnings of a vehicle file; the sheet is None if there are faults."""

    faults: list[str]
    warnings: list[str]
    sheet: VehicleSheet | None


def validate_vehicle_file(path: Path) -> VehicleValidation:
    """Check a vehicle file; raise BadInput if the file is not valid YAML."""
    content = load_vehicle_content(path)
    if not isinstance(content, dict):
        return VehicleValidation(
            ['It is not a YAML mapping (key: value); compare it with a shipped file.'], [], None
        )
    try:
        file = VehicleFile.model_validate(content)
    except ValidationError as error:
        return VehicleValidation(
            [capitalize_sentence(text) for text in format_errors(error)], [], None
        )
    # Several checks may report the same fault
    faults = list(dict.fromkeys(_find_faults(file)))
    if faults:
        return VehicleValidation(faults, [], None)
    sheet = build_sheet(Vehicle(file))
    return VehicleValidation([], [*find_warnings(sheet), *_find_source_warnings(sheet)], sheet)


def capitalize_sentence(text: str) -> str:
    """Capitalize a sentence, unless it begins with a path of the file."""
    # Paths such as 'rotors.left.axis' are case-sensitive and stay as they are
    return text[0].upper() + text[1:] if text.startswith(('the ', 'is ', 'has ')) else text


def _find_faults(file: VehicleFile) -> Iterator[str]:
    """Yield the faults of a file that matches the schema."""
    own = ''
    # First without effects, so that a fault of the body is not reported once for each effect.
    try:
        Vehicle(file.model_copy(update={'effects': {}}))
    except BadInput as error:
        own = str(error)
        yield own
    plain = [
        text for text in map(partial(_find_effect_fault, file, not own), file.effects) if text
    ]
    yield from plain
    try:
        if file.control and file.control.gains:
            find_file('gains', file.control.gains)
    except BadInput as error:
        yield f'control.gains: {error}'
    # Check numerical stability last: it needs a complete, valid model
    if not plain and not own:
        try:
            Vehicle(file).check_step(STEP_NS * 1e-9)
        except BadInput as error:
            yield str(error)


def _find_effect_fault(file: VehicleFile, flies: bool, name: str) -> str:
    """Return the fault of one effect, '' if there is none."""
    alone = file.model_copy(update={'effects': {name: file.effects[name]}})
    try:
        added = mass_properties.added_mass(file.hull, AIR_DENSITY)
        effect_parameters.collect_effects(alone, propulsion.build_rotors(file), added, AIR_DENSITY)
        if flies:  # some bounds are checked only by the complete model
            Vehicle(alone)
    except BadInput as error:
        return str(error)
    return ''


def find_warnings(sheet: VehicleSheet) -> list[str]:
    """Return the warnings about a valid vehicle, as sentences."""
    return [
        *_find_balance_warnings(sheet),
        *_find_lift_warnings(sheet),
        *_find_hull_warnings(sheet),
        *_find_push_warnings(sheet),
    ]


def _find_balance_warnings(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    # The figures hold display units: cm, degrees, % and g, as do the thresholds above
    depth = f['cg_depth'].value or 0.0
    if sheet.vehicle.file.hull.shape == 'none':
        return
    if depth <= 0.0:
        yield (
            f'The centre of gravity is {-depth:.1f} cm above the centre of buoyancy, so '
            'the vehicle will flip over; move mass down.'
        )
    elif depth < SHALLOW:
        yield (
            f'The centre of gravity is only {depth:.1f} cm below the centre of buoyancy, so the '
            'righting moment is small; move mass down.'
        )
    if 'lean' in f and (f['lean'].value or 0.0) > LEANING:
        hanging = f['lean'].value_with_unit
        yield f'At rest it tilts by {hanging}; move mass to the other side.'
    lean = f.get('push_lean')
    # No lean exists if the thrust moment exceeds the largest righting moment
    if lean is not None and lean.value is None:
        yield f'Full forward thrust turns it over: {lean.note}.'
    elif lean is not None and (lean.value or 0.0) > STEEP:
        yield (
            f'It tilts by {lean.value_with_unit} at full forward thrust; move the rotors '
            'closer to the centre of buoyancy.'
        )


def _find_lift_warnings(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    duty, up = f['hover_duty'], f['push_up']
    if duty.value is None:
        yield duty.note or 'Its rotors cannot lift it.'
    elif duty.value > BUSY:
        yield (
            f'Its rotors need {duty.value_with_unit} duty to hover, which leaves little '
            'for control and climbing; make it lighter.'
        )
    ballast = f.get('ballast')
    if ballast is not None and (ballast.value or 0.0) < LEAST_BALLAST:
        yield (
            f'It carries only {ballast.value_with_unit} of ballast; if its parts are '
            'heavier than the file says by more than that, it is too heavy.'
        )
    loss, leak = f.get('hover_loss'), f.get('leak_high')
    if loss is not None and leak is not None and loss.value and leak.value:
        # Days until the loss, at the highest leak rate
        soon = loss.value / leak.value
        if soon < SOON:
            yield (
                f'It cannot hover after losing {loss.value_with_unit} of lift by helium '
                f'leakage, which may happen within {soon:.0f} days.'
            )
    if up.value is None:
        yield 'Its rotors cannot lift it while they hold heading and position.'


def _find_hull_warnings(sheet: VehicleSheet) -> Iterator[str]:
    vehicle = sheet.vehicle
    file = vehicle.file
    if file.hull.shape == 'none':
        return
    if file.measured and file.trim.heaviness:
        geometric = vehicle.volume * AIR_DENSITY
        off = vehicle.displaced_mass / geometric - 1.0
        if abs(off) > DISAGREE:
            yield (
                'From its mass and trim.heaviness, it displaces '
                f'{1e3 * vehicle.displaced_mass:.1f} g of air, but from the volume of its '
                f'hull {1e3 * geometric:.1f} g ({100 * off:+.0f} %); check these values.'
            )
    if file.hull.purity and file.hull.purity.si < IMPURE:
        yield f'The helium purity of {100 * file.hull.purity.si:.0f} % is low; refill the hull.'
    # A shell part is the film of the hull, so both must have the same size
    sizes = [2.0 * half for half in mass_properties.half_axes(file.hull)]
    for name, part in file.parts.items():
        if part.shape == 'shell' and any(
            abs(own / size - 1.0) > DISAGREE
            for own, size in zip(part.size.vector, sizes, strict=True)
        ):
            # m to cm, as most vehicle files give sizes
            own = ' x '.join(f'{100 * number:.1f}' for number in part.size.vector)
            of_hull = ' x '.join(f'{100 * number:.1f}' for number in sizes)
            yield (
                f'The part {name} (shape: shell) measures {own} cm, but the hull measures '
                f'{of_hull} cm; make them equal.'
            )


def _find_push_warnings(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    level, tumble = f['level_speed'], f.get('tumble_speed')
    limit = math.inf if tumble is None or tumble.value is None else tumble.value
    if tumble is not None and level.value is not None and level.value > limit:
        yield (
            f'It can fly {level.value_with_unit}, but its hull may tumble above '
            f'{tumble.value_with_unit}; limit its speed.'
        )
    yield from find_stale_columns(sheet.vehicle.file)
    turns = [f[f'push_turn_{side}'].value for side in ('left', 'right')]
    if not all(turns):
        yield 'Its rotors cannot yaw it in both directions; check their positions and axes.'


def _find_copied_numbers(sheet: VehicleSheet) -> Iterator[str]:
    """Warn if most numbers are those of a shipped vehicle, which `lta vehicle new` copied."""
    names = list_shipped_names(KIND_FOLDERS['vehicle'])
    if sheet.vehicle.file.name in names:
        return
    own = {(each.place, each.value, each.source) for each in sheet.numbers}
    shared = {
        name: own & {
            (each.place, each.value, each.source)
            for each in list_numbers(load_vehicle(name).file)
        }
        for name in names
    }  # fmt: skip
    model = max(names, key=lambda name: len(shared[name]))
    copied = sorted(place for place, _, _ in shared[model])
    if len(copied) > COPIED * len(own):
        groups = ', '.join(dict.fromkeys(place.split('.')[0] for place in copied))
        yield (
            f'{len(copied)} of its {len(own)} numbers and their sources are those of {model} '
            f'(in {groups}); replace them with those of your vehicle, and name their source.'
        )


def _find_source_warnings(sheet: VehicleSheet) -> Iterator[str]:
    yield from _find_copied_numbers(sheet)
    if sheet.assumed_count:
        yield (
            f'{sheet.assumed_count} of the {len(sheet.numbers)} numbers in the vehicle '
            'file are assumed; measure the important ones (lta vehicle show --sources '
            'lists them).'
        )

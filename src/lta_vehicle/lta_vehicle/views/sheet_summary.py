"""Summarize a vehicle sheet in sentences."""

from collections.abc import Iterator
import math

from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.sheet import VehicleSheet

MINUS = '\N{MINUS SIGN}'
MANY = ('no', 'one', 'two', 'three', 'four', 'five', 'six', 'seven', 'eight')


def format_headline(sheet: VehicleSheet) -> str:
    """Return the headline: weight, heaviness and hover duty."""
    f = sheet.by_key
    name = sheet.vehicle.file.name
    heavy = f['heaviness']
    weight = f['mass'].value_with_unit
    if sheet.vehicle.file.hull.shape == 'none':
        first = f'{name} weighs {weight}, all carried by its rotors'
    # Exactly zero: trimmed to neutral buoyancy by the file
    elif heavy.value == 0.0:
        first = f'{name} weighs {weight}, gas included, and is neutrally buoyant'
    else:
        value = heavy.value_with_unit.replace('\N{MINUS SIGN}', '')
        than = 'heavier' if (heavy.value or 0.0) > 0.0 else 'lighter'
        first = f'{name} weighs {weight}, gas included, and is {value} {than} than air'
    duty = f['hover_duty']
    if duty.value is None:
        return f'{first}; its rotors cannot lift it'
    if duty.value == 0.0:
        return first
    return f'{first}; it hovers at {duty.value_with_unit} duty'


def describe_vehicle(sheet: VehicleSheet) -> list[str]:
    """Return the most important properties as sentences, and the share of assumed numbers."""
    return [
        *_describe_weight(sheet),
        *_describe_push(sheet),
        *_describe_stability(sheet),
        *_describe_helium(sheet),
        f'{sheet.assumed_count} of the {len(sheet.numbers)} numbers in its file are assumed, '
        'neither measured nor published.',
    ]


def _describe_weight(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    ballast = f.get('ballast')
    if ballast is not None:
        yield (
            f'Add {ballast.value_with_unit} of ballast to make it '
            f'{f["heaviness"].value_with_unit} heavier than air; then measure its actual '
            'weight in a hover with lta vehicle trim.'
        )
    if 'cg_x' in f and 'lean' in f and (f['lean'].value or 0.0) > 1.0:
        yield (
            f'At rest it tilts by {f["lean"].value_with_unit}, because its centre of '
            f'gravity is {_format_side(f["cg_x"], "ahead of", "behind")} the hull centre '
            f'and {_format_side(f["cg_y"], "to the left", "to the right")} of it.'
        )


def _format_side(figure: DerivedFigure, positive: str, negative: str) -> str:
    """Return a length with the side that its sign denotes."""
    words = negative if (figure.value or 0.0) < 0.0 else positive
    return f'{figure.value_with_unit.removeprefix(MINUS)} {words}'


def _describe_push(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    up, rotors = f['push_up'], len(sheet.vehicle.rotors)
    count = MANY[rotors] if rotors < len(MANY) else str(rotors)
    if up.value is not None and up.note:
        able = up.note if up.note.startswith('could') else f'is {up.note}'
        yield f'With its {count} rotor{"s" if rotors != 1 else ""} it {able}.'
    level = f['level_speed']
    if level.value:
        climb = f.get('climb_speed')
        more = f' and its top climb rate {climb.value_with_unit}' if climb and climb.value else ''
        yield f'Its top speed in level flight is {level.value_with_unit}{more}.'


def _describe_stability(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    if 'swing_pitch' not in f:
        yield 'It has no righting moment when tilted; a controller must stabilise it.'
        return
    half = f['damping_pitch'].note
    yield (
        f'After a tilt, it oscillates with a period of {f["swing_pitch"].value_with_unit}; {half}.'
    )
    tumble, level = f['tumble_speed'], f['level_speed']
    if tumble.value is not None and not math.isinf(tumble.value):
        yield f'The hull can tumble above {tumble.value_with_unit} ({tumble.note}).'
    lean = f.get('push_lean')
    if lean is not None and (lean.value or 0.0) >= 0.5 and level.value:
        yield f'At full forward thrust it tilts by {lean.value_with_unit}.'


def _describe_helium(sheet: VehicleSheet) -> Iterator[str]:
    f = sheet.by_key
    if 'leak_low' not in f:
        return
    yield (
        f'By helium leakage it would lose {f["leak_low"].value_with_unit} to '
        f'{f["leak_high"].value_with_unit} of lift (assumed: a film like that of airships, '
        'because no value for this film was found).'
    )
    loss = f['hover_loss']
    if loss.value is not None:
        yield f'It can hover until {loss.value_with_unit} of lift are lost: {loss.note}.'
    if 'gains_loss' in f:
        held = f['gains_loss']
        yield (
            f'Its controller stays stable until {held.value_with_unit} of lift are lost: '
            f'{held.note}.'
        )

"""
The effects as a page: `./lta effects --markdown > docs/effects.md`.

A test holds the page in docs/ against this; the equations stand at the top of each effect's file.
"""

from collections.abc import Iterator
import re

from lta_model.effects import select_built_in
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    BodyEffect,
    Effect,
    EffectParameter,
    InertiaEffect,
    MeasurementEffect,
    WrenchEffect,
)
from lta_model.effects.summary import describe_effect

HEAD = """# Effects

Generated from `lta_model.effects` by `./lta effects --markdown > docs/effects.md`.

A vehicle is the sum of these. Each is one file in `src/lta_model/lta_model/effects/` with its
equations, what it leaves out and its sources. A vehicle file switches it on under `effects:` by
giving a parameter a value other than its null; at its null values it changes nothing, to the last
bit. `./lta effects NAME` tells the source of every bound. `name_1..` stands for one a rotor.
"""

# What each kind does, in the order of a command's way through the vehicle.
KINDS: dict[type, tuple[str, str]] = {
    AirEffect: ('Air', 'Wind at the hull; the sum is what every other effect flies in.'),
    ActuatorEffect: ('Actuators', 'From a duty to a thrust, rotor by rotor, in this order.'),
    WrenchEffect: ('Force and moment', 'On the hull, summed.'),
    InertiaEffect: ('Air that moves along', 'Added to the mass matrix.'),
    BodyEffect: ('Mass and balance', 'What the vehicle weighs and displaces; applied first.'),
    MeasurementEffect: ('Measurement', 'What sensors, tracker and clocks make of the truth.'),
}


def _format_parameter(parameter: EffectParameter, name: str) -> str:
    """Return a parameter with its unit, null value and bounds."""
    unit = '' if parameter.unit == '1' else f' {parameter.unit}'
    null = f', null {parameter.null:g}' if parameter.null else ''
    return f'`{name}` {parameter.low:g} to {parameter.high:g}{unit}{null}'


def format_parameters(effect: Effect) -> Iterator[str]:
    """Return the parameters in words, alike ones together."""
    if isinstance(effect, ActuatorEffect):
        yield from (_format_parameter(known, known.name) for known in effect.shared)
        yield from (
            f'{_format_parameter(known, known.name)} (each rotor)' for known in effect.each
        )
        return
    groups: dict[tuple[object, ...], list[str]] = {}
    for known in effect.parameters:
        stem = re.sub(r'_\d+$', '_1..', known.name)
        key = (known.unit, known.null, known.low, known.high)
        names = groups.setdefault(key, [])
        if stem not in names:
            names.append(stem)
    for (unit, null, low, high), names in groups.items():
        like = EffectParameter('', str(unit), float(null), float(low), float(high), 1.0, '')  # type: ignore[arg-type]
        yield _format_parameter(like, '`, `'.join(names))


def render_page() -> str:
    """Return the page, a table for each kind; what others installed is not in it."""
    texts = [HEAD]
    for kind, (title, about) in KINDS.items():
        rows = [
            f'| `{name}` | {describe_effect(effect)} | {"; ".join(format_parameters(effect))} |\n'
            for name, effect in select_built_in().items()
            if type(effect) is kind
        ]
        table = '| effect | what | parameters |\n|---|---|---|\n' + ''.join(rows)
        texts.append(f'\n## {title}\n{about}\n\n{table}')
    return ''.join(texts)

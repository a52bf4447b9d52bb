"""
The effects as a page: `./lta effects --markdown > docs/effects.md`.

A test holds the page in docs/ against this; the equations stand at the top of each effect's file.
"""

from collections.abc import Iterator
import re

from lta_model.effects import built_in
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    BodyEffect,
    Effect,
    InertiaEffect,
    MeasurementEffect,
    Parameter,
    WrenchEffect,
)
from lta_model.effects.summary import summary

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


def _told(known: Parameter, name: str) -> str:
    """Return a parameter with its unit, null value and bounds."""
    unit = '' if known.unit == '1' else f' {known.unit}'
    null = f', null {known.null:g}' if known.null else ''
    return f'`{name}` {known.low:g} to {known.high:g}{unit}{null}'


def parameters(effect: Effect) -> Iterator[str]:
    """Return the parameters in words, alike ones together."""
    if isinstance(effect, ActuatorEffect):
        yield from (_told(known, known.name) for known in effect.shared)
        yield from (f'{_told(known, known.name)} (each rotor)' for known in effect.each)
        return
    groups: dict[tuple[object, ...], list[str]] = {}
    for known in effect.parameters:
        stem = re.sub(r'_\d+$', '_1..', known.name)
        key = (known.unit, known.null, known.low, known.high)
        names = groups.setdefault(key, [])
        if stem not in names:
            names.append(stem)
    for (unit, null, low, high), names in groups.items():
        like = Parameter('', str(unit), float(null), float(low), float(high), 1.0, '')  # type: ignore[arg-type]
        yield _told(like, '`, `'.join(names))


def page() -> str:
    """Return the page, a table for each kind; what others installed is not in it."""
    texts = [HEAD]
    for kind, (title, about) in KINDS.items():
        rows = [
            f'| `{name}` | {summary(effect)} | {"; ".join(parameters(effect))} |\n'
            for name, effect in built_in().items()
            if type(effect) is kind
        ]
        table = '| effect | what | parameters |\n|---|---|---|\n' + ''.join(rows)
        texts.append(f'\n## {title}\n{about}\n\n{table}')
    return ''.join(texts)

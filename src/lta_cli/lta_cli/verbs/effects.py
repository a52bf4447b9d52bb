"""lta effects: list the effects of the model."""

from typing import Annotated

from lta_analysis.console import plain_console
from lta_model.effects import EFFECTS, get_effect
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    BodyEffect,
    describe_effect,
    InertiaEffect,
    MeasurementEffect,
    WrenchEffect,
)
from rich.table import Table
import typer

KINDS: dict[type, tuple[str, str]] = {
    AirEffect: ('Air', 'Wind at the hull. All other effects use the sum of these winds.'),
    ActuatorEffect: (
        'Actuators',
        'How a duty becomes the thrust of a rotor; applied in this order.',
    ),
    WrenchEffect: ('Force and moment', 'Forces and moments on the hull, which are summed.'),
    InertiaEffect: ('Added mass', 'Terms that are added to the mass matrix.'),
    BodyEffect: (
        'Mass and balance',
        'Changes of the mass and the displaced volume; applied before all others.',
    ),
    MeasurementEffect: ('Measurement', 'Errors of sensors, motion tracker and clocks.'),
}


def effects(
    name: Annotated[str, typer.Argument(help='Effect to show; all by default.')] = '',
) -> None:
    """
    List the effects of the model: unit, bounds and source of every parameter.

    A vehicle file enables an effect under `effects:`. Its equations are in the docstring of its
    function in src/lta_model/lta_model/effects/.

    Example: lta effects ground_effect
    """
    if name:
        print_effect(name)
    else:
        print_all_effects()


def print_all_effects() -> None:
    """Print one line for each effect, grouped by kind."""
    console = plain_console()
    for kind, (title, about) in KINDS.items():
        table = Table(title=f'{title}: {about}', title_justify='left', box=None)
        table.add_column('effect', no_wrap=True)
        table.add_column('what')
        for name, effect in EFFECTS.items():
            # Each kind of effect is a class of its own
            if type(effect) is kind:
                table.add_row(name, describe_effect(effect))
        console.print(table)
        console.print()


def print_effect(name: str) -> None:
    """Print one effect with all its parameters."""
    console, effect = plain_console(), get_effect(name)
    console.print(f'{name}: {describe_effect(effect)}.\n', markup=False)
    table = Table(box=None)
    for column in ('parameter', 'unit', 'null', 'from', 'to', 'spread', 'source'):
        table.add_column(column, overflow='fold')
    for parameter in effect.parameters:
        numbers = (parameter.null, parameter.low, parameter.high, parameter.spread)
        table.add_row(
            parameter.name, parameter.unit, *(f'{x:g}' for x in numbers), parameter.source
        )
    console.print(table)

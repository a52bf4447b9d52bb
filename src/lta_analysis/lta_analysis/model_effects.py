# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""List the effects of the model, and write the skeleton of one's own: `lta effects`."""

from pathlib import Path
from typing import final

from lta_analysis.console import print_lines
from lta_config.command_line import relative_path
from lta_model.effects import EFFECTS, get_effect
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    BodyEffect,
    describe_effect,
    Effect,
    InertiaEffect,
    MeasurementEffect,
    WrenchEffect,
)
from lta_report.request import Action, argument, Folder, option, Outcome
from rich.console import Console
from rich.table import Table

EFFECT_KINDS: dict[type, tuple[str, str]] = {
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


@final
class EffectListRequest(Action, command='effects'):
    """
    List the effects of the model: unit, bounds and source of every parameter.

    A vehicle file enables an effect under `effects:`. Its equations are in the docstring of its
    function in src/lta_model/lta_model/effects/.

    Example: lta effects ground_effect
    """

    name: str = argument('Effect to show; all by default.', default='')

    def run(self, console: Console) -> Outcome[dict[str, Effect]]:
        """Print one line for each effect, or one with all its parameters; return them by name."""
        if self.name:
            effect = get_effect(self.name)
            print_effect(self.name, effect, console)
            return Outcome({self.name: effect})
        for kind, (title, about) in EFFECT_KINDS.items():
            table = Table(title=f'{title}: {about}', title_justify='left', box=None)
            table.add_column('effect', no_wrap=True)
            table.add_column('what')
            for name, effect in EFFECTS.items():
                # Each kind of effect is a class of its own
                if type(effect) is kind:
                    table.add_row(name, describe_effect(effect))
            console.print(table)
            console.print()
        return Outcome(dict(EFFECTS))


def print_effect(name: str, effect: Effect, console: Console) -> None:
    """Print one effect with all its parameters."""
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


@final
class EffectSkeletonRequest(Action, command='effects new'):
    """
    Write the skeleton of an effect: a Python file, and the package that installs it.

    Replace its example by the equations of the cause, such as of a force that "lta discover"
    names. After "pip install", "lta effects" lists it, and vehicle files can use it.

    Example: lta effects new guide_rope
    """

    name: str = argument('Name of the new effect, for example guide_rope.')
    out: Folder | None = option('Folder to write; NAME by default.', default=None)

    def run(self, console: Console) -> Outcome[Path]:
        """Write the files, and return their folder."""
        from lta_vehicle.effect_skeleton import write_skeleton

        folder = self.out or Path(self.name)
        files = write_skeleton(self.name, folder)
        print_lines(
            console,
            *(f'File {path}' for path in files),
            'Enter equations, bounds and sources, then run: .venv/bin/pip install '
            f'{relative_path(folder)}, and lta effects {self.name}',
        )
        return Outcome(folder)

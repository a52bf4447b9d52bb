"""Build the table from which a shell completes: every command, option, setting and effect."""

from collections.abc import Iterator
from typing import Any, get_args, get_origin, Literal

from lta_cli.app import build_app
from lta_control.strategies import STRATEGIES
from lta_flight.flight_spec import SETTINGS
from lta_graph.launches import LAUNCHES
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import describe_effect
from pydantic import BaseModel
from typer.main import get_command

# What a value is, by command and name of the option or argument ('*': every command): the kind of
# a shipped file (see `lta_config.files.FOLDERS`), or one of `lta_cli.completion.LISTS`
VALUES = {
    '*': {
        '--vehicle': 'vehicle',
        'VEHICLE': 'vehicle',
        '[OTHER]': 'vehicle',
        '--from': 'vehicle',
        '--beside': 'vehicle',
        '--scenario': 'scenario',
        '--strategy': 'strategy',
        '--gains': 'gains',
        '--mount': 'mount',
        '--mapping': 'import mapping',
        '--cell': 'cell',
        '--topic': 'topic',
        '--topics': 'topic',
        'CHANNEL...': 'topic',
        'TUNNEL': 'tunnel',
        'PLAN': 'floor plan',
    },
    'lta simulate': {'--set': 'flight path'},
    'lta vehicle diff': {'--set': 'vehicle path'},
    'lta vehicle set': {'PATH=VALUE...': 'vehicle path'},
    'lta bag plot': {'--from': ''},
    'lta tune': {'VEHICLE': 'vehicle'},
    'lta wind': {'VEHICLES': 'vehicle'},
    'lta mission': {'NAME': 'mission'},
    'lta sweep': {'FILE': 'sweep'},
    'lta platforms': {'FILE': 'comparison'},
    'lta launch': {'FILE': 'launch', '[NAME:=VALUE]...': 'launch argument'},
    'lta cells': {'TABLE': 'cell table'},
    'lta reproduce': {'NAMES': 'row of the paper'},
    'lta effects': {'NAME': 'effect or try'},
    'lta effects try': {'NAME': 'effect'},
    'lta tests between': {'FIRST': 'effect', 'SECOND': 'effect'},
}


def build_table() -> dict[str, Any]:
    """Return the table, in types of JSON."""
    return {
        'commands': describe_command(get_command(build_app()), 'lta')['commands'],
        'settings': dict(
            setting for root, model in SETTINGS.items() for setting in list_settings(model, root)
        ),
        'strategies': list(STRATEGIES),
        'launches': list(LAUNCHES),
        'effects': {name: describe_effect(effect) for name, effect in EFFECTS.items()},
        'effect parameters': {
            f'effects.{name}.{parameter.name}': parameter.unit
            for name, effect in EFFECTS.items()
            for parameter in effect.parameters
        },
    }


def describe_command(command: Any, words: str) -> dict[str, Any]:  # noqa: ANN401 - Typer's
    """Return the first sentence of a command, and its members or its parameters."""
    entry: dict[str, Any] = {'help': ' '.join((command.help or '').split('\n\n')[0].split())}
    if hasattr(command, 'commands'):
        entry['commands'] = {
            name: describe_command(command.commands[name], f'{words} {name}')
            for name in command.list_commands(None)
        }
    else:
        entry['parameters'] = [
            describe_parameter(each, words) for each in command.params if each.name != 'help'
        ]
    return entry


def describe_parameter(parameter: Any, words: str) -> dict[str, Any]:  # noqa: ANN401 - Typer's
    """Return an option or argument: its names, and what its values are."""
    is_option = parameter.opts[0].startswith('-')
    name = parameter.opts[0] if is_option else parameter.metavar or parameter.name.upper()
    values = {**VALUES['*'], **VALUES.get(words, {})}
    entry = {
        'name': parameter.name,
        'options': [*parameter.opts, *parameter.secondary_opts] if is_option else [],
        'help': ' '.join((parameter.help or '').split()),
        'flag': bool(getattr(parameter, 'is_flag', False)),
        'many': parameter.nargs == -1 or bool(getattr(parameter, 'multiple', False)),
        'count': parameter.nargs if parameter.nargs > 1 else 0,
        'values': list_choices(parameter.type_descriptor.annotation) or values.get(name, ''),
    }
    return {key: value for key, value in entry.items() if value}


def list_choices(kind: Any) -> list[str]:  # noqa: ANN401 - any annotation
    """Return the choices of an annotation such as `Literal['a', 'b'] | None`."""
    if get_origin(kind) is Literal:
        return [str(choice) for choice in get_args(kind)]
    return [choice for part in get_args(kind) for choice in list_choices(part)]


def list_settings(model: type[BaseModel], root: str) -> Iterator[tuple[str, str]]:
    """Yield path and description of every setting."""
    for name, field in model.model_fields.items():
        inner = field.annotation
        if isinstance(inner, type) and issubclass(inner, BaseModel):
            yield from list_settings(inner, f'{root}.{name}')
        else:
            yield f'{root}.{name}', field.description or ''

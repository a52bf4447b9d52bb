"""
Complete a command line for a shell: commands, options, names, topics and paths of parameters.

The table of commands is in the cache, since importing the commands takes seconds; it is written
again once the code has changed. Typer speaks with bash, zsh and fish; `lta --install-completion`
tells them to ask.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
import hashlib
from importlib.util import find_spec
import inspect
import json
import os
from pathlib import Path
from typing import Annotated, Any, Final

from lta_config.files import find_file, FOLDERS, list_shipped_names, load_yaml
from lta_config.machine import find_cache_folder
import typer
from typer.core import TyperGroup

# The packages that declare what is in the table of commands
PACKAGES: Final = (
    'lta_cli', 'lta_config', 'lta_control', 'lta_data', 'lta_energy', 'lta_flight', 'lta_graph',
    'lta_model', 'lta_studies', 'lta_vlc',
)  # fmt: skip
# Vehicle and scenario of a command line that names none
DEFAULTS: Final = {'vehicle': 'gtmab', 'scenario': 'lamp_room'}
Values = Iterator[tuple[str, str]]  # with a description, or ''
Line = Mapping[str, Any]  # the words of the command line, by parameter


def complete() -> None:
    """Answer the shell, which passes the line in the environment, and exit."""
    build_app(load_table())(prog_name='lta')


def load_table() -> dict[str, Any]:
    """Return the table of commands from the cache; write it if the code has changed since."""
    path = find_cache_folder('completion') / 'commands.json'
    code = compute_code_digest()
    with suppress(OSError, ValueError, KeyError, TypeError):
        table: dict[str, Any] = json.loads(path.read_text(encoding='utf-8'))
        if table['code'] == code:
            return table
    from lta_cli.reference.completion import build_table  # imports every command

    table = build_table() | {'code': code}
    # Several shells may ask at once: each writes a file of its own
    part = path.with_name(f'.{path.name}.{os.getpid()}')
    with suppress(OSError):
        part.write_text(json.dumps(table), encoding='utf-8')
        part.replace(path)
    return table


def compute_code_digest() -> str:
    """Return a digest of the sizes and times of the files that declare the commands."""
    digest = hashlib.sha256()
    # Finding a package does not import it
    for spec in filter(None, map(find_spec, PACKAGES)):
        for folder in spec.submodule_search_locations or ():
            for path in sorted(Path(folder).rglob('*.py')):
                status = path.stat()
                digest.update(f'{path} {status.st_size} {status.st_mtime_ns}\n'.encode())
    return digest.hexdigest()


class TwoWordGroup(TyperGroup):
    """A command group with commands of two words, such as `effects try`."""

    def list_commands(self, ctx: object) -> list[str]:
        """Return the commands of one word; `lta effects` completes the second word."""
        del ctx
        return [name for name in self.commands if ' ' not in name]

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:  # noqa: ANN401 - as in Click
        """Return name and command of the first words, and the other words."""
        both = ' '.join(args[:2])
        words = [both, *args[2:]] if both in self.commands else args
        return super().resolve_command(ctx, words)


def build_app(table: Mapping[str, Any]) -> typer.Typer:
    """Return an app with the commands of the table, which cannot run."""
    app = typer.Typer(name='lta', add_completion=True, cls=TwoWordGroup)
    app.callback()(lambda: None)
    add_commands(app, table['commands'], table)
    return app


def add_commands(app: typer.Typer, commands: Mapping[str, Any], table: Mapping[str, Any]) -> None:
    """Add commands to an app."""
    for name, entry in commands.items():
        if 'commands' in entry:
            group = typer.Typer(help=entry['help'])
            group.callback()(lambda: None)
            add_commands(group, entry['commands'], table)
            app.add_typer(group, name=name)
        else:
            app.command(name, help=entry['help'])(build_stub(entry['parameters'], table))


def build_stub(parameters: list[dict[str, Any]], table: Mapping[str, Any]) -> Callable[..., None]:
    """Return a function with the parameters of a command, which does nothing."""
    names = [each['name'] for each in parameters if 'options' not in each]
    kinds = {each['name']: annotate_parameter(each, names, table) for each in parameters}

    def stub(**_: object) -> None:
        """Do nothing."""

    stub.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind)
            for name, kind in kinds.items()
        ]
    )
    stub.__annotations__ = kinds
    return stub


def annotate_parameter(
    parameter: Mapping[str, Any], arguments: list[str], table: Mapping[str, Any]
) -> Any:  # noqa: ANN401 - any annotation
    """
    Return the annotation of an option or argument as Typer reads it.

    `arguments` are the names of the command's arguments, in order.
    """
    shared: dict[str, Any] = {
        'autocompletion': build_completer(parameter.get('values', ''), arguments, table),
        'help': parameter.get('help', ''),
    }
    kind: Any = bool if parameter.get('flag') else str
    if count := parameter.get('count'):
        kind = tuple[(str,) * count]  # type: ignore[misc]
    kind = list[kind] if parameter.get('many') else kind
    options = parameter.get('options')
    if not options:
        return Annotated[kind | None, typer.Argument(**shared)]
    # Both names of a switch in one word: --page/--no-page
    names = ['/'.join(options)] if parameter.get('flag') else options
    return Annotated[kind | None, typer.Option(*names, **shared)]


def build_completer(
    values: str | list[str], arguments: list[str], table: Mapping[str, Any]
) -> Callable[[typer.Context, str], list[tuple[str, str]]]:
    """Return the function with which Typer completes a value; the shell completes files."""

    def find(context: typer.Context, incomplete: str) -> list[tuple[str, str]]:
        # Click does not assign arguments while an option lacks its value: they are left over
        line = dict(zip(arguments, context.args, strict=False))
        line |= {key: value for key, value in context.params.items() if value}
        try:
            candidates = list_values(values, line, table)
            return [(name, about) for name, about in candidates if name.startswith(incomplete)]
        except Exception:
            return []  # a file that does not exist or has other contents: no traceback in a prompt

    return find


def list_values(values: str | list[str], line: Line, table: Mapping[str, Any]) -> Values:
    """Yield the possible values of a parameter with their descriptions."""
    if isinstance(values, list):
        yield from ((value, '') for value in values)
    elif values in FOLDERS:
        for name in list_shipped_names(FOLDERS[values]):
            yield name, ''
    elif values:
        yield from LISTS[values](line, table)


def list_strategies(line: Line, table: Mapping[str, Any]) -> Values:
    """Yield the registered strategies."""
    del line
    yield from ((name, '') for name in table['strategies'])


def list_launches(line: Line, table: Mapping[str, Any]) -> Values:
    """Yield the shipped launches."""
    del line
    yield from ((name, '') for name in table['launches'])


def list_effects(line: Line, table: Mapping[str, Any]) -> Values:
    """Yield the effects with their descriptions."""
    del line
    yield from table['effects'].items()


def list_effects_and_try(line: Line, table: Mapping[str, Any]) -> Values:
    """Yield what may follow `lta effects`: an effect, or `try`."""
    yield 'try', table['commands']['effects try']['help']
    yield from list_effects(line, table)


def list_flight_paths(line: Line, table: Mapping[str, Any]) -> Values:
    """Yield the paths of `lta simulate --set`: of its vehicle, its scenario and the settings."""
    for root in ('vehicle', 'scenario'):
        content = load_yaml(find_file(root, line.get(root, DEFAULTS[root])))
        for path, value in list_paths(content):
            yield f'{root}.{path}=', value
    for path, unit in table['effect parameters'].items():
        yield f'vehicle.{path}=', unit
    for path, about in table['settings'].items():
        yield f'{path}=', about


def list_vehicle_paths(line: Line, table: Mapping[str, Any]) -> Values:
    """Yield the paths of a vehicle file."""
    name = line.get('other') or line.get('name') or line.get('file')
    if name:
        for path, value in list_paths(load_yaml(find_file('vehicle', str(name)))):
            yield f'{path}=', value
    for path, unit in table['effect parameters'].items():
        yield f'{path}=', unit


def list_paths(content: object, path: str = '') -> Values:
    """Yield the path of every number and switch of a file, with its value as text."""
    if isinstance(content, Mapping) and 'value' in content:
        yield path, f'{content["value"]} {content.get("unit", "")}'.strip()
    elif isinstance(content, Mapping):
        for key, value in content.items():
            yield from list_paths(value, f'{path}.{key}' if path else str(key))
    elif isinstance(content, bool | int | float) and '.' in path:
        yield path, str(content)


def list_topics(line: Line, table: Mapping[str, Any]) -> Values:
    """Yield the topics of a bag, without the name of its robot."""
    from lta_data.bag.bag_folder import find_bag, read_topic_types  # loads numpy

    del table
    bag = next((Path(str(line[key])) for key in ('bag', 'a') if key in line), None)
    if bag is None:
        return
    for name, kind in sorted(read_topic_types(find_bag(bag)).items()):
        # As `lta bag plot` calls it: /lta1/odom is odom, /clock is /clock
        yield (name.split('/', 2)[2] if name.count('/') > 1 else name), kind


def list_launch_arguments(line: Line, table: Mapping[str, Any]) -> Values:
    """Yield the arguments of a shipped launch; a file of the user is not run for a prompt."""
    from lta_graph.launches import LAUNCHES

    del table
    if launch := LAUNCHES.get(str(line.get('file', ''))):
        for item in launch.list_arguments():
            yield f'{item.name}:=', item.description


LISTS: Final[dict[str, Callable[[Line, Mapping[str, Any]], Values]]] = {
    'strategy': list_strategies,
    'effect': list_effects,
    'effect or try': list_effects_and_try,
    'topic': list_topics,
    'flight path': list_flight_paths,
    'vehicle path': list_vehicle_paths,
    'launch': list_launches,
    'launch argument': list_launch_arguments,
}

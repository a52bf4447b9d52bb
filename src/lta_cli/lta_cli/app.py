# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build the `lta` command line from its verbs, one file each in `verbs/`.

Only the requested verb is imported, because importing all of them takes seconds. The list of verbs
is built from their docstrings without importing them.
"""

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
import errno
from importlib import import_module
from importlib.util import find_spec
import inspect
import os
from pathlib import Path
import re
import sys
from typing import Annotated, Any, Final, final

from lta_analysis import FUNCTIONS
from lta_cli.without_ros import (
    ANYTHING,
    is_graph_installed,
    is_ros_module,
    missing_ros_error,
    refuse_without_ros,
    WITHOUT_GRAPH,
)
from lta_config.atomic_file import release_folders
from lta_config.errors import BadInput, check_printable, to_one_line
from lta_config.limits import describe_shortage
from lta_config.version import VERSION
import typer
from typer.core import TyperGroup

SHOWN_NEAR_BYTES: Final = 40  # characters around bytes that are not UTF-8, to find them
STOPPED = 130  # exit status after Ctrl-C, as in shells and Typer: 128 + SIGINT
# Errors of a path or disk that the user can fix; they are reported in one sentence, not as a
# traceback, where the verb has no better message.
USER_ERRORS: Final = {
    errno.EACCES, errno.EBUSY, errno.EDQUOT, errno.EIO, errno.ENAMETOOLONG, errno.ENOSPC,
    errno.EPERM, errno.EROFS, errno.ESTALE,
}  # fmt: skip
EPILOG: Final = (
    'Results go to runs/<time>-<name>/. "lta VERB --help" shows details.\n\n'
    'Exit status 0: done. 1: the run failed. 2: bad input, one sentence on stderr.'
)


@final
@dataclass(frozen=True, slots=True)
class Verb:
    """A verb: its file in `verbs/`, its function or request, and its Click context settings."""

    file: str
    name: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    several: tuple[str, ...] = ()  # options that take several values: --train A B
    needs_graph: bool = False  # it runs nodes, so it needs rclpy

    def load(self) -> Callable[..., None]:
        """Import the verb and return its function."""
        verb: Any = getattr(import_module(self.module), self.name)
        if not isinstance(verb, type):
            function: Callable[..., None] = verb
            return function
        from lta_cli.request_command import build_command  # imports pydantic

        command: Callable[..., None] = build_command(verb)
        return command

    @property
    def module(self) -> str:
        """Return the module of `verbs/`, or of a request elsewhere."""
        return self.file if self.file.startswith('lta_') else f'lta_cli.verbs.{self.file}'

    def read_docstring(self) -> str:
        """Return the verb's docstring without importing it."""
        package, _, rest = self.module.partition('.')
        spec = find_spec(package)  # of a package without parents, so that nothing is imported
        folder = Path(spec.origin if spec and spec.origin else '').parent
        text = (folder / f'{rest.replace(".", "/")}.py').read_text(encoding='utf-8')
        # Parsing takes a millisecond; importing the verb may take a second
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == self.name:
                return ast.get_docstring(node) or ''
        raise LookupError(f'{self.module} has no {self.name}')


@final
@dataclass(frozen=True, slots=True)
class VerbGroup:
    """Verbs that share a first word, as in `lta bag info`."""

    about: str
    verbs: Mapping[str, Verb]


def call(name: str, **settings: Any) -> Verb:
    """Return the verb of a request, by the name of its function in `lta_analysis`."""
    module, _, request = FUNCTIONS[name].partition(':')
    return Verb(module, request, **settings)


VEHICLE_VERBS: Final = VerbGroup(
    'Create, inspect, compare and check vehicle files, and estimate weight from a flight.',
    {
        'new': call('vehicle_new'),
        'show': call('vehicle_show'),
        'check': call('vehicle_check'),
        'set': call('vehicle_set'),
        'diff': call('vehicle_diff'),
        'trim': call('vehicle_trim'),
        'urdf': call('vehicle_urdf'),
    },
)
BAG_VERBS: Final = VerbGroup(
    'Inspect, check, plot, repair and export recordings.',
    {
        'info': call('bag_info'),
        'check': call('bag_check'),
        'plot': call('bag_plot'),
        'upgrade': call('bag_upgrade'),
        'export': call('bag_export'),
    },
)
LIGHT_VERBS: Final = VerbGroup(
    'Plan lamps, and study the light that a drone receives.',
    {
        'link': call('light_link'),
        'plan': call('light_plan'),
        'calibrate': call('light_calibrate'),
    },
)
ENERGY_VERBS: Final = VerbGroup(
    'Simulate energy use and solar charging; compare with published values and a multirotor.',
    {
        'budget': call('energy_budget'),
        'mounting': call('energy_mounting'),
        'breakeven': call('energy_breakeven'),
    },
)
TESTS_VERBS: Final = VerbGroup(
    'Plan and fly the tests that calibrate a vehicle, read their logs, tell two effects apart.',
    {
        'plan': call('tests_plan'),
        'fly': Verb(
            'tests_fly', 'TestsFlyRequest', {'allow_interspersed_args': True}, needs_graph=True
        ),
        'read': call('tests_read'),
        'between': call('tests_between'),
    },
)
CFD_VERBS: Final = VerbGroup(
    'Compute drag and rotor slipstreams from the shape of a vehicle (virtual wind tunnel).',
    {
        'run': call('cfd_run'),
        'refit': call('cfd_refit'),
    },
)
HARDWARE_VERBS: Final = VerbGroup(
    'Check connected drones and light boards, test one motor.',
    {
        'check': Verb('hardware', 'DeviceCheckRequest'),
        'bench': Verb('hardware', 'MotorBenchRequest'),
    },
)
# In the order of `lta --help`, which has a frame for each family
FAMILIES: Final[Mapping[str, Mapping[str, Verb | VerbGroup]]] = {
    'Fly': {
        'fly': call('fly', needs_graph=True),
        'simulate': call('simulate', several=('--commands',)),
        'replay': call('replay', needs_graph=True),
        'launch': Verb('launch', 'launch', {'allow_interspersed_args': True}, needs_graph=True),
        'call': Verb('call', 'call', needs_graph=True),
        'run': Verb(
            'run', 'run', {'ignore_unknown_options': True, 'allow_interspersed_args': False}
        ),
        'mission': call('mission'),
        'sweep': call('sweep'),
    },
    'Analyse': {
        'import': call('import_log'),
        'bag': BAG_VERBS,
        'report': call('report'),
        'compare': call('compare'),
    },
    'Learn': {
        'tests': TESTS_VERBS,
        'calibrate': call('calibrate', several=('--train', '--confirm')),
        'discover': call('discover', several=('--train', '--confirm', '--holdout')),
        'effects': call('effects'),
        # Not a group: `lta effects NAME` shows an effect
        'effects new': call('effects_new'),
    },
    'Design': {
        'vehicle': VEHICLE_VERBS,
        'tune': call('tune'),
        'wind': call('wind'),
        'platforms': call('platforms'),
        'light': LIGHT_VERBS,
        'energy': ENERGY_VERBS,
        'cells': call('cells'),
        'cfd': CFD_VERBS,
    },
    'Hardware': {'hardware': HARDWARE_VERBS},
    'Tools': {
        'doctor': Verb('doctor', 'doctor'),
        'reproduce': call('reproduce'),
    },
}
FAMILY: Final = {name: family for family, verbs in FAMILIES.items() for name in verbs}
VERBS: Final = {name: verb for verbs in FAMILIES.values() for name, verb in verbs.items()}


class OrderedGroup(TyperGroup):
    """A command group that lists verbs in the order of `VERBS`; Typer would put groups last."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of the registered verbs; those of one word to a shell."""
        shell = ctx is not None and ctx.resilient_parsing
        return [name for name in VERBS if name in self.commands and not (shell and ' ' in name)]

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return name and command of the first words, and the other words."""
        return super().resolve_command(ctx, join_verb(args))


def build_app(words: Sequence[str] | None = None) -> typer.Typer:
    """
    Return the app with the verb that the command line names.

    If the words name no verb, all verbs are listed but not imported. If `words` is None, all are
    imported.
    """
    app = typer.Typer(
        name='lta',
        cls=OrderedGroup,
        epilog=EPILOG if is_graph_installed() else f'{EPILOG}\n\n{WITHOUT_GRAPH}',
        no_args_is_help=True,
        rich_markup_mode='rich',
        # Plain tracebacks can be copied into a report
        pretty_exceptions_enable=False,
    )
    # A callback makes Typer keep the verb as a subcommand, even if it is the only one
    app.callback()(root_options)
    add_verbs(app, VERBS, words)
    return app


def add_verbs(
    app: typer.Typer, verbs: Mapping[str, Verb | VerbGroup], words: Sequence[str] | None
) -> None:
    """Add the named verb, or all verbs, to an app."""
    panels = FAMILY if verbs is VERBS else {}  # a group may have a verb of the same name
    if words is None:
        for name, verb in verbs.items():
            add_verb(app, name, verb, None)
    # The usual case: only this verb is imported
    elif words and words[0] in verbs:
        add_verb(app, words[0], verbs[words[0]], words[1:])
    else:
        for name, verb in verbs.items():
            if isinstance(verb, Verb) and verb.needs_graph and not is_graph_installed():
                continue
            text = (
                verb.about
                if isinstance(verb, VerbGroup)
                else unwrap_paragraphs(verb.read_docstring())
            )
            # A placeholder that shows the help text but cannot run
            app.command(
                name, context_settings=ANYTHING, help=text, rich_help_panel=panels.get(name)
            )(require_verb)


def add_verb(
    app: typer.Typer, name: str, verb: Verb | VerbGroup, words: Sequence[str] | None
) -> None:
    """Add a verb or a verb group to an app."""
    if isinstance(verb, VerbGroup):
        group = typer.Typer(help=verb.about, no_args_is_help=True)
        group.callback()(lambda: None)  # without it, Typer merges a single verb into its group
        add_verbs(group, verb.verbs, words)
        app.add_typer(group, name=name)
        return
    if verb.needs_graph and not is_graph_installed():
        # Hidden: a list of commands shows those that work here
        refuse = app.command(name, context_settings=ANYTHING, hidden=True, add_help_option=False)
        refuse(refuse_without_ros)
        return
    function = verb.load()
    app.command(name, context_settings=dict(verb.settings), help=format_help(function))(function)


def require_verb(context: typer.Context) -> None:
    """Refuse options before the verb: the verb was listed but not imported."""
    raise BadInput(f"Put the command before its options: '{context.command_path} ...'.")


def join_verb(words: Sequence[str]) -> list[str]:
    """Return the words with a verb of two words as one: 'effects new'."""
    both = ' '.join(words[:2])
    return [both, *words[2:]] if both in VERBS else [*words]


def repeat_options(words: Sequence[str]) -> list[str]:
    """Expand `--train A B` to `--train A --train B`, the form that Click accepts."""
    verb = VERBS.get(words[0]) if words else None
    if isinstance(verb, VerbGroup):
        # In a group, the second word names the verb
        verb = verb.verbs.get(words[1]) if len(words) > 1 else None
    several = verb.several if isinstance(verb, Verb) else ()
    out: list[str] = []
    for k, word in enumerate(words):
        # The option that precedes this word
        option = next((w for w in reversed(words[:k]) if w.startswith('-')), '')
        # The first value follows its option directly; repeat the option before each further value
        if option in several and not word.startswith('-') and words[k - 1] != option:
            out.append(option)
        out.append(word)
    return out


def format_help(does: object) -> str:
    """Return the docstring of a function as help text."""
    return unwrap_paragraphs(inspect.getdoc(does) or '')


def unwrap_paragraphs(text: str) -> str:
    """Remove the line breaks within paragraphs, so that the terminal can wrap the text."""
    # Empty lines separate paragraphs
    return '\n\n'.join(' '.join(paragraph.split()) for paragraph in text.split('\n\n'))


def print_version(requested: bool) -> None:
    """Print the version and exit, if `--version` was given."""
    if requested:
        sys.stdout.write(f'lta {VERSION}\n')
        # Is handled in `run_command_line`; nothing else runs
        raise typer.Exit


def root_options(
    version: Annotated[
        bool,
        typer.Option('--version', callback=print_version, is_eager=True, help='Show the version.'),
    ] = False,
) -> None:
    """Simulate, fly, record and understand lighter-than-air micro-drones."""


def complete() -> None:
    """Answer a shell that asks, in the environment, how a line may go on; exit."""
    line = os.environ.get('COMP_WORDS') or os.environ.get('_TYPER_COMPLETE_ARGS') or ''
    # Only the verb that the line names is imported
    build_app(join_verb(line.split()[1:]))(prog_name='lta')


def run_command_line(loaded: Callable[[], None] = lambda: None) -> int:
    """
    Run the command line and return its exit status.

    Errors that the user can fix are reported as one sentence on stderr. `loaded` is called after
    the imports, before the verb runs.
    """
    try:
        for word in sys.argv[1:]:
            check_printable(word)
        words = join_verb(repeat_options(sys.argv[1:]))
        app = build_app(words)
        loaded()
        # Without standalone mode, Click returns or raises instead of calling sys.exit
        return app(words, prog_name='lta', standalone_mode=False) or 0
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        return 2
    except KeyboardInterrupt:
        return STOPPED
    except typer.Exit as leave:
        # Verbs set statuses other than 0 and 2 this way
        return leave.exit_code
    except Exception as error:
        text = describe_error(error)
        # Other errors are defects and keep their traceback
        if text is None:
            raise
        if not text:  # called without a verb: Typer has already shown the help
            return 0
        sys.stderr.write(f'{text}\n')
        return 2
    finally:
        release_folders()


def describe_error(error: Exception) -> str | None:
    """Return the sentence for an error that the user can fix; None for any other."""
    # Click's usage errors are vendored by Typer; only this method identifies them.
    if (message := getattr(error, 'format_message', None)) is not None:
        # Pydantic, which checks values for Typer, says first what it calls a wrong one
        text = ' '.join(message().split()).rstrip('.').replace('Value error, ', '')
        wrong = r"Invalid value for '(\S+)': Input should be (.+?)(?:, (?:unable to|got) .*)?$"
        text = re.sub(wrong, r'\1 must be \2', text)
        return f'{text}; see --help.' if text else ''
    if isinstance(error, ModuleNotFoundError) and is_ros_module(error.name):
        return str(missing_ros_error(error))
    if isinstance(error, UnicodeEncodeError):
        # A folder above the given path, or a file in it
        near = to_one_line(
            error.object[max(0, error.start - SHOWN_NEAR_BYTES) : error.end + SHOWN_NEAR_BYTES]
        )
        return f"The name of a file or folder is not UTF-8 ('{near}'); rename it."
    if isinstance(error, OSError) and error.filename and error.errno in USER_ERRORS:
        return f"Cannot read or write '{error.filename}': {error.strerror}."
    return describe_shortage(error)

"""
The `lta` command, put together from its verbs: one file a verb in `verbs/`.

Only the verb that is asked for is loaded: all of them take a second.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
import inspect
import sys
from typing import Annotated, Any, Final, final

from lta_analysis.without_ros import ANYTHING, is_of_ros, lacking, refuse
from lta_config.errors import BadInput
from lta_config.version import VERSION
import typer
from typer.core import TyperGroup

STOPPED = 130  # the shell's own status after Ctrl-C, and Typer's
EPILOG: Final = (
    'Results go to runs/<time>-<name>/. "lta VERB --help" tells all of a verb.\n\n'
    'Exit status 0: done. 1: the run failed. 2: bad input, one sentence on stderr.'
)


@final
@dataclass(frozen=True, slots=True)
class Verb:
    """Where a verb is: its file in `verbs/`, the function or group in it, and its settings."""

    file: str
    name: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    several: tuple[str, ...] = ()  # options that take several values: --train A B

    def load(self) -> Any:  # noqa: ANN401 - a function, or a group of them
        """Return what the verb does."""
        return getattr(import_module(f'lta_analysis.verbs.{self.file}'), self.name)


@final
@dataclass(frozen=True, slots=True)
class Group:
    """Verbs behind one word."""

    about: str
    verbs: Mapping[str, Verb]


BAG: Final = Group(
    'Look at recordings, check and mend them, turn them into other files.',
    {
        'info': Verb('bag_info', 'info'),
        'check': Verb('bag_check', 'check'),
        'plot': Verb('bag_plot', 'plot'),
        'recover': Verb('bag_recover', 'recover'),
        'export': Verb('bag_export', 'export'),
    },
)
LIGHT: Final = Group(
    'Study the light: where lamps go, and how drones find their way by them.',
    {
        'link': Verb('light_link', 'link'),
        'plan': Verb('light_plan', 'plan'),
        'evaluate': Verb('light_evaluate', 'evaluate', several=('--sets',)),
        'bearing': Verb('light_bearing', 'bearing'),
        'study': Verb('light_study', 'light_study'),
    },
)
ENERGY: Final = Group(
    'What flights cost and panels bring, beside the paper and a multirotor.',
    {
        'budget': Verb('energy_budget', 'budget'),
        'hover': Verb('energy_hover', 'hover'),
        'mounting': Verb('energy_mounting', 'mounting'),
        'breakeven': Verb('energy_breakeven', 'breakeven'),
    },
)
CFD: Final = Group(
    'The wind tunnel: drag and rotor columns from the shape of a vehicle, without a flight.',
    {
        'run': Verb('cfd_run', 'run'),
        'validate': Verb('cfd_validate', 'validate'),
        'refit': Verb('cfd_refit', 'refit'),
    },
)
HARDWARE: Final = Group(
    'Look at real drones and light boards, turn one motor, put a board on a turntable.',
    {
        'check': Verb('hardware_check', 'check'),
        'bench': Verb('hardware_bench', 'bench'),
        'light': Verb('hardware_light', 'light'),
    },
)
VERBS: Final[dict[str, Verb | Group]] = {
    'fly': Verb('fly', 'fly'),
    'simulate': Verb('simulate', 'simulate'),
    'replay': Verb('replay', 'replay'),
    'launch': Verb('launch', 'launch', {'allow_interspersed_args': True}),
    'call': Verb('call', 'call'),
    'run': Verb('run', 'run', {'ignore_unknown_options': True, 'allow_interspersed_args': False}),
    'mission': Verb('mission', 'mission'),
    'sweep': Verb('sweep', 'sweep'),
    'tune': Verb('tune', 'tune'),
    'wind': Verb('wind', 'wind'),
    'platforms': Verb('platforms', 'platforms'),
    'vehicle': Verb('vehicle', 'vehicle'),
    'cells': Verb('cells', 'cells'),
    'cfd': CFD,
    'light': LIGHT,
    'energy': ENERGY,
    'bag': BAG,
    'hardware': HARDWARE,
    'compare': Verb('compare', 'compare'),
    'discover': Verb('discover', 'discover', several=('--train', '--confirm', '--holdout')),
    'challenge': Verb('challenge', 'challenge'),
    'import': Verb('import_', 'import_'),
    'report': Verb('report', 'report'),
    'reproduce': Verb('reproduce', 'reproduce'),
    'effects': Verb('effects', 'effects'),
    'doctor': Verb('doctor', 'doctor'),
}


class InOrder(TyperGroup):
    """Verbs in the order of `VERBS`; Typer puts those with words behind them last."""

    def list_commands(self, ctx: object) -> list[str]:
        """Return their names."""
        del ctx
        return [name for name in VERBS if name in self.commands]


def put_together(words: Sequence[str]) -> typer.Typer:
    """Return the command with the verb that some words ask for, or with all where none is."""
    app = typer.Typer(
        name='lta',
        cls=InOrder,
        epilog=EPILOG,
        no_args_is_help=True,
        add_completion=False,
        rich_markup_mode='rich',
        pretty_exceptions_enable=False,
    )
    app.callback()(options)
    for name in asked(VERBS, words):
        add(app, name, VERBS[name], words[1:])
    return app


def asked(known: Mapping[str, object], words: Sequence[str]) -> list[str]:
    """Return the first word if it is known, else all that are."""
    return [words[0]] if words and words[0] in known else list(known)


def add(app: typer.Typer, name: str, verb: Verb | Group, words: Sequence[str]) -> None:
    """Add a verb, or those behind its word, to the command."""
    if isinstance(verb, Group):
        group = typer.Typer(help=verb.about, no_args_is_help=True)
        group.callback()(lambda: None)  # one verb alone would stand for its group
        for inner in asked(verb.verbs, words):
            add(group, inner, verb.verbs[inner], ())
        app.add_typer(group, name=name)
        return
    try:
        found = verb.load()
    except ModuleNotFoundError as missing:
        if not is_of_ros(missing.name):
            raise
        app.command(name, context_settings=ANYTHING, help=flowing(refuse))(refuse)
        return
    if isinstance(found, typer.Typer):
        for command in found.registered_commands:
            command.help = flowing(command.callback)
        app.add_typer(found, name=name)
        return
    app.command(name, context_settings=dict(verb.settings), help=flowing(found))(found)


def repeated(words: Sequence[str]) -> list[str]:
    """Return a command line with `--train A B` as `--train A --train B`, as Click takes it."""
    verb = VERBS.get(words[0]) if words else None
    if isinstance(verb, Group):
        verb = verb.verbs.get(words[1]) if len(words) > 1 else None
    several = verb.several if isinstance(verb, Verb) else ()
    out: list[str] = []
    for k, word in enumerate(words):
        option = next((w for w in reversed(words[:k]) if w.startswith('-')), '')
        if option in several and not word.startswith('-') and words[k - 1] != option:
            out.append(option)
        out.append(word)
    return out


def flowing(does: object) -> str:
    """Return a docstring's paragraphs without the line breaks, ragged on any other width."""
    paragraphs = (inspect.getdoc(does) or '').split('\n\n')
    return '\n\n'.join(' '.join(text.split()) for text in paragraphs)


def tell_version(wanted: bool) -> None:
    """Print the version and leave, if that is wanted."""
    if wanted:
        sys.stdout.write(f'lta {VERSION}\n')
        raise typer.Exit


def options(
    version: Annotated[
        bool,
        typer.Option('--version', callback=tell_version, is_eager=True, help='Tell the version.'),
    ] = False,
) -> None:
    """Simulate, fly, record and understand lighter-than-air micro-drones."""


def status() -> int:
    """Run the command line and return its exit status; what the user can mend is one sentence."""
    try:
        words = repeated(sys.argv[1:])
        return put_together(words)(words, standalone_mode=False) or 0
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        return 2
    except KeyboardInterrupt:
        return STOPPED
    except typer.Exit as leave:
        return leave.exit_code
    except ModuleNotFoundError as missing:
        if not is_of_ros(missing.name):
            raise
        sys.stderr.write(f'{lacking(missing)}\n')
        return 2
    except Exception as error:
        # Typer's own complaints about the command line are private to it but for this method.
        complaint = getattr(error, 'format_message', None)
        if complaint is None:
            raise
        text = ' '.join(complaint().split()).rstrip('.')
        if not text:  # called without a verb: the help has been shown
            return 0
        sys.stderr.write(f'{text}; see --help.\n')
        return 2

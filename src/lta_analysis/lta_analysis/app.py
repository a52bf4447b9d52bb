"""The verbs of the `lta` command, put together; one file a verb in `verbs/`."""

from importlib.metadata import version
import inspect
import sys
from typing import Annotated

from lta_analysis.verbs.bag import bag
from lta_analysis.verbs.doctor import doctor
from lta_analysis.verbs.effects import effects
from lta_analysis.verbs.fly import fly
from lta_analysis.verbs.import_ import import_
from lta_analysis.verbs.launch import launch
from lta_analysis.verbs.platforms import platforms
from lta_analysis.verbs.replay import replay
from lta_analysis.verbs.report import report
from lta_analysis.verbs.run import run
from lta_analysis.verbs.simulate import simulate
from lta_analysis.verbs.sweep import sweep
from lta_analysis.verbs.tune import tune
from lta_analysis.verbs.vehicle import vehicle
from lta_analysis.verbs.wind import wind
from lta_config.errors import BadInput
import typer

STOPPED = 130  # the shell's own status after Ctrl-C, and Typer's

app = typer.Typer(
    name='lta',
    epilog='Results go to runs/<time>-<name>/. "lta VERB --help" tells all of a verb.\n\n'
    'Exit status 0: done. 1: the run failed. 2: bad input, one sentence on stderr.',
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode='rich',
    pretty_exceptions_enable=False,
)
app.command()(fly)
app.command()(simulate)
app.command()(sweep)
app.command()(wind)
app.command()(platforms)
app.command()(tune)
app.command(context_settings={'allow_interspersed_args': True})(launch)
app.command(context_settings={'ignore_unknown_options': True, 'allow_interspersed_args': False})(
    run
)
app.command()(replay)
app.add_typer(bag, name='bag')
app.add_typer(vehicle, name='vehicle')
app.command()(report)
app.command('import')(import_)
app.command()(effects)
app.command()(doctor)
for command in (
    *app.registered_commands,
    *bag.registered_commands,
    *vehicle.registered_commands,
):
    # Typer keeps the line breaks of a docstring, which are ragged on any other width.
    paragraphs = (inspect.getdoc(command.callback) or '').split('\n\n')
    command.help = '\n\n'.join(' '.join(text.split()) for text in paragraphs)


def tell_version(wanted: bool) -> None:
    """Print the version and leave, if that is wanted."""
    if wanted:
        sys.stdout.write(f'lta {version("lta-analysis")}\n')
        raise typer.Exit


@app.callback()
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
        return app(standalone_mode=False) or 0
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        return 2
    except KeyboardInterrupt:
        return STOPPED
    except typer.Exit as leave:
        return leave.exit_code
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

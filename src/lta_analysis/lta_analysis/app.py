"""The verbs of the `lta` command, put together; one file a verb in `verbs/`."""

import sys

from lta_analysis.verbs.bag import bag
from lta_analysis.verbs.doctor import doctor
from lta_analysis.verbs.fly import fly
from lta_analysis.verbs.launch import launch
from lta_analysis.verbs.report import report
from lta_analysis.verbs.run import run
from lta_config.errors import BadInput
import typer

STOPPED = 130  # the shell's own status after Ctrl-C, and Typer's

app = typer.Typer(
    name='lta',
    help='Simulate, fly, record and understand lighter-than-air micro-drones.',
    epilog='Results go to runs/<time>-<name>/. "lta VERB --help" tells all of a verb.',
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode='rich',
    pretty_exceptions_enable=False,
)
app.command()(fly)
app.command(context_settings={'allow_interspersed_args': True})(launch)
app.command(context_settings={'ignore_unknown_options': True, 'allow_interspersed_args': False})(
    run
)
app.add_typer(bag, name='bag')
app.command()(report)
app.command()(doctor)


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
        sys.stderr.write(f'{text}; see --help.\n' if text else '')
        return 2

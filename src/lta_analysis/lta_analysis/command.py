"""
The `lta` command: one file a verb in `verbs/`.

Exit status 0 done, 1 the run failed, 2 bad input (one sentence on stderr), 130 Ctrl-C.
"""

import sys

from lta_analysis.verbs.bag import bag
from lta_analysis.verbs.doctor import doctor
from lta_analysis.verbs.fly import fly
from lta_analysis.verbs.launch import launch
from lta_analysis.verbs.run import run
from lta_config.errors import BadInput
import typer

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
app.command()(doctor)


def main() -> None:
    """Run the command line and leave with its status."""
    try:
        status = app(standalone_mode=False)
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        status = 2
    except typer.Abort:
        status = 130
    except KeyboardInterrupt:
        sys.stderr.write('Stopped.\n')
        status = 130
    except typer.Exit as leave:
        status = leave.exit_code
    except Exception as error:
        # Typer's own complaints about the command line know how to show themselves.
        show = getattr(error, 'show', None)
        if show is None:
            raise
        show()
        status = 2
    sys.exit(status or 0)

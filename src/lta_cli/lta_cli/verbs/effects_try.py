"""lta effects try: hide an effect in simulated flights, and find it."""

from typing import Annotated

from lta_cli.options.study_command import report_command, StudyRun
from lta_discovery.demo.demo import discover_hidden_effect
from lta_discovery.demo.trial_effect import choose_trial_effect
from lta_discovery.progress import DiscoverProgress
from lta_report.report import Report
import typer


@report_command('effects-try')
def try_(
    run: StudyRun,
    name: Annotated[
        str, typer.Argument(help='Effect, or one of its parameters, such as cg_offset.x.')
    ],
    seed: Annotated[int, typer.Option(help='Random seed.', min=0, max=2**20)] = 1,
) -> Report:
    """
    Hide an effect in simulated flights that excite it, and discover it.

    Three flights with changing height, heading and speed and shaken motors. Of an effect with
    several parameters, one that such flights show well is hidden, at a size that they show. Page,
    files and terminal are those of "lta discover". Says why if an effect cannot be tried.

    Example: lta effects try motor_deadband
    """
    hidden = choose_trial_effect(name)
    with DiscoverProgress(run.console) as progress:
        return discover_hidden_effect(hidden, seed, run.folder, progress.show_stage)

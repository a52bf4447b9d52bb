"""lta effects try: hide an effect in simulated flights, and find it."""

from typing import Annotated

from lta_challenge.effect_trial import choose_trial_effect
from lta_cli.options.common_options import check_picture_output, Json, Out, Pictures, plain_console
from lta_cli.verbs.discover import show_result
from lta_discovery.demo.demo import discover_hidden_effect
from lta_discovery.progress import DiscoverProgress
from lta_report.results_folder import check_creatable, resolve_folder
import typer


def try_(
    name: Annotated[
        str, typer.Argument(help='Effect, or one of its parameters, such as cg_offset.x.')
    ],
    seed: Annotated[int, typer.Option(help='Random seed of the flights.', min=0, max=2**20)] = 1,
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Hide an effect in simulated flights that excite it, and discover it.

    Three flights with changing height, heading and speed and shaken motors. Of an effect with
    several parameters, one that such flights show well is hidden, at a size that they show. Page,
    files and terminal are those of "lta discover". Says why if an effect cannot be tried.

    Example: lta effects try motor_deadband
    """
    console = plain_console(stderr=json)
    check_picture_output(pictures)
    hidden = choose_trial_effect(name)
    folder = resolve_folder(out, f'effects-{name}')
    check_creatable(folder)
    with DiscoverProgress(console) as progress:
        result = discover_hidden_effect(hidden, seed, folder, progress.show_stage)
    show_result(result, hidden, folder, console, pictures, json=json)

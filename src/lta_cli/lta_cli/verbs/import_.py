"""lta import: convert logs of other systems to bags."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated, get_args, TYPE_CHECKING

from lta_analysis.console import plain_console
from lta_cli.options.common_options import Json, Out, print_json
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_config.files import list_shipped_names
from lta_config.schema.import_file import Format
from lta_config.topics import is_name
from lta_report.formatting import format_count
from lta_report.results_folder import resolve_folder
from rich.console import Console
import typer

if TYPE_CHECKING:
    from lta_data.importers.run import ImportedLog


def import_(
    sources: Annotated[
        list[Path], typer.Argument(help='Log files or bag folders to import.', metavar='SOURCE...')
    ],
    mapping: Annotated[
        str | None,
        typer.Option(
            help='Mapping that defines meaning, unit and axes of each column: a file, or one of '
            f'{", ".join(list_shipped_names("imports"))}. '
            'By default, the shipped mapping that fits the columns, if only one does.'
        ),
    ] = None,
    format: Annotated[
        str | None,
        typer.Option(help=f'File format: {", ".join(get_args(Format))}; detected by default.'),
    ] = None,
    out: Out = None,
    robot: Annotated[str, typer.Option(help='Namespace of the topics in the new bag.')] = 'lta1',
    vehicle: Annotated[
        str | None,
        typer.Option(
            help='Flown vehicle, name or file; stored in the bag. A draft names commands after '
            'its rotors.'
        ),
    ] = None,
    draft: Annotated[
        bool,
        typer.Option(
            '--draft', help='Propose a mapping from the columns of a log, instead of importing it.'
        ),
    ] = False,
    set: Annotated[
        list[str] | None,
        typer.Option(
            '--set',
            metavar='KEY=VALUE',
            help='Decide a question of --draft, such as time.rate=60. Repeatable.',
        ),
    ] = None,
    json: Json = False,
) -> None:
    """
    Convert logs to bags: CSV, MATLAB, NumPy, Parquet, ROS 1 and 2, PX4, ArduPilot, Crazyflie.

    Only units and axes are converted: nothing is smoothed, resampled or filled in. Anomalies (time
    that stops or runs backwards, cells without a number) are kept and reported. The bag stores the
    name and SHA-256 of its source, the whole mapping, and whether the data are measured or
    simulated.

    A mapping defines the meaning, unit and axes of each column: docs/import.md. One source becomes
    FOLDER/bag, several become FOLDER/NAME/bag; if one cannot be imported, none is.

    With --draft, columns, units, axes and rates are proposed from names and physics, with reasons
    and a picture, and written to FOLDER/mapping.yaml. Where two readings fit, the command asks;
    without a terminal it prints both with the --set that decides, and ends with status 2.

    Example: lta import --draft flight.csv --out runs/lab

    Example: lta import data_1.csv --vehicle rgblimp

    Example: lta import flight.bag --mapping my_tracker.yaml --out runs/lab/flight

    Example: lta import log00 log01 --json
    """
    # Import here: the format readers load slowly, and building the help does not need them.
    from lta_data.importers.run import import_logs, ImportProgress, ImportRequest

    console = plain_console(stderr=json)
    if draft:
        # Import here: drafting needs the whole importer and the report.
        from lta_cli.options.draft_command import run_draft
        from lta_data.importers.draft.choices import parse_answers

        try:
            answers = parse_answers(set or [])
        except ValueError as error:
            raise BadInput(f'--set {error}.') from None
        run_draft(sources, answers, vehicle, out, console, json)
        return
    if set:
        raise BadInput('--set decides a question of --draft; add --draft, or remove --set.')
    # The robot becomes a ROS namespace
    if not is_name(robot):
        raise BadInput(
            f"--robot '{robot}' is not a valid ROS namespace; use a letter, followed by letters, "
            'digits or _.'
        )
    # A name such as '.csv' has an empty stem
    name = sources[0].name.split('.')[0] or 'log'
    target = resolve_folder(out, name)
    order = ImportRequest(sources, mapping, format, robot, vehicle)
    with ImportProgress(console, len(sources)) as progress:
        done = import_logs(order, target, progress)
    # One entry per source, also for a single source
    if json:
        print_json([asdict(one) for one in done])
        return
    for one in done:
        _print_import(one, console)


def _print_import(one: 'ImportedLog', console: Console) -> None:
    """Print a summary of one imported log."""
    form = f'{one.format}, mapping {one.mapping}' if one.mapping else one.format
    console.print(
        f'{one.source} ({form}; {one.data})', style='bold', highlight=False, markup=False
    )
    for topic, count in one.topics.items():
        console.print(
            f'  {topic}: {format_count(count, "message")}', highlight=False, markup=False
        )
    for note in one.notes:
        console.print(f'  {note}', style='yellow', highlight=False, markup=False, soft_wrap=True)
    console.print(
        f'Bag {relative_path(Path(one.bag))}', highlight=False, markup=False, soft_wrap=True
    )
    place = relative_path(Path(one.bag))
    for purpose, verb in (('See it', 'info'), ('Check units, axes and clocks', 'check')):
        line = f'{purpose}: {format_lta_command("bag", verb, place)}'
        console.print(line, style='dim', highlight=False, markup=False, soft_wrap=True)

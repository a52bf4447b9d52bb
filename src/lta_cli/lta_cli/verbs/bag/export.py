"""lta bag export: export a recording to Parquet, CSV or MATLAB."""

from pathlib import Path
from typing import Annotated, final

from lta_analysis.console import plain_console
from lta_cli.options.common_options import folder_option, print_json, RobotOption
from lta_data.bag.recorded_flight import open_flight
from lta_data.export.run import EXPORT_FORMATS, export_recording, ExportRequest, ExportResult
from lta_report.progress_bar import ProgressBar
from lta_report.results_folder import resolve_folder
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn
import typer


@final
class ExportProgress(ProgressBar):
    """Progress bar of an export, with the current topic."""

    def __init__(self, console: Console) -> None:
        columns = (
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn('{task.description}'),
        )
        super().__init__(console, *columns, begin='reading')

    def show_topic(self, topic: str, done: int, total: int) -> None:
        """Show the topic that is being written."""
        self.update_bar(description=topic, completed=done, total=total)


def export(
    bag: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    form: Annotated[
        str,
        typer.Option(
            '--format', help=f'Format of the exported files: {", ".join(EXPORT_FORMATS)}.'
        ),
    ] = 'parquet',
    topics: Annotated[
        str,
        typer.Option(
            help='Topics to export, separated by commas, such as odom,motors; all by default.'
        ),
    ] = '',
    out: Annotated[
        Path | None,
        folder_option('Folder for the files, new or empty; runs/<time>-export by default.'),
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(
            help='Resample all topics to this rate and write them as one table.', metavar='HZ'
        ),
    ] = None,
    method: Annotated[
        str,
        typer.Option(help='Interpolation for --rate: previous (hold the last value) or linear.'),
    ] = 'previous',
    robot: RobotOption = None,
    json: Annotated[
        bool, typer.Option('--json', help='Print the list of written files as JSON.')
    ] = False,
) -> None:
    """
    Export a recording to Parquet, CSV or MATLAB, one file per topic, with units.

    Each file has stamp_ns and time (seconds since the start of the flight), then the message
    fields by path; quaternions are followed by yaw, pitch and roll. Photodiode blocks give one row
    per sample, lamp peaks one row per beacon and diode. With --rate, all topics are resampled into
    one table; gaps longer than three periods of a topic stay empty.

    Units are stored in the field metadata of Parquet files, in units.csv next to CSV files, and in
    the struct "units" of MATLAB files. In MATLAB each topic is a struct of its message fields.
    Topics that cannot be decoded are left out and reported.

    Example: lta bag export runs/20261120-lamp_room-1/bag --format csv --topics odom,motors

    Example: lta bag export runs/20261120-lamp_room-1/bag --format mat --rate 50 --method linear
    """
    # With --json, stdout holds JSON only
    console = plain_console(stderr=json)
    flight = open_flight(bag, robot)
    # An empty tuple means all topics
    names = tuple(name.strip() for name in topics.split(',') if name.strip())
    target = resolve_folder(out, 'export')
    with ExportProgress(console) as progress:
        done = export_recording(flight, ExportRequest(form, names, rate, method), target, progress)
    if json:
        print_json(export_to_dict(done, target))
    for file in done.files:
        console.print(
            f'{file.topic}: {file.rows} rows, {file.columns} columns',
            highlight=False, markup=False,
        )  # fmt: skip
    for remark in done.remarks:
        console.print(remark, style='yellow', highlight=False, markup=False, soft_wrap=True)
    console.print(f'Files {target}', highlight=False, markup=False, soft_wrap=True)


def export_to_dict(done: ExportResult, target: Path) -> dict[str, object]:
    """Return the content of --json."""
    files = [
        {'topic': each.topic, 'file': str(each.file), 'rows': each.rows, 'columns': each.columns}
        for each in done.files
    ]
    return {'folder': str(target), 'files': files, 'remarks': done.remarks}

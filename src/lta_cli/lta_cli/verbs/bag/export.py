"""lta bag export: a recording for other programs."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.json_option import print_json
from lta_cli.options.out_option import parse_folder
from lta_cli.options.plain_console import plain_console
from lta_data.bag.recording import open_recording
from lta_data.export.progress import ExportProgress
from lta_data.export.run import export_recording, ExportRequest, ExportResult, FORMATS
from lta_report.results_folder import resolve_folder
import typer


def export(
    bag: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    form: Annotated[
        str, typer.Option('--format', help=f'Format of the files: {", ".join(FORMATS)}.')
    ] = 'parquet',
    topics: Annotated[
        str, typer.Option(help='Names with commas between, as odom,motors; all by default.')
    ] = '',
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the files, new or empty; runs/<time>-export by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
    rate: Annotated[
        float | None, typer.Option(help='All in one table on an even clock.', metavar='HZ')
    ] = None,
    method: Annotated[
        str,
        typer.Option(help='Values on that clock: previous (as last said) or linear (between).'),
    ] = 'previous',
    robot: Annotated[
        str | None, typer.Option(help='Robot to export; needed where the bag holds several.')
    ] = None,
    json: Annotated[bool, typer.Option('--json', help='Print what was written as JSON.')] = False,
) -> None:
    """
    Write a recording as Parquet, CSV or MATLAB files, one a topic, with the unit of each column.

    Each file has stamp_ns and time, in s since the start of the flight, then the fields of the
    message by path; a quaternion's yaw, pitch and roll stand behind it. Blocks of the photodiodes
    become one row a sampling instant, point clouds one row a point. With --rate all topics stand
    in one table, with nothing where a topic was silent for three of its periods.

    Units stand in the metadata of Parquet's fields, in units.csv beside CSV files, and in the
    struct "units" of MATLAB files, whose topic is a struct with the fields of the message. A topic
    that cannot be decoded is left out and named.

    Example: lta bag export runs/20261120-lamp_room-1/bag --format csv --topics odom,motors

    Example: lta bag export runs/20261120-lamp_room-1/bag --format mat --rate 50 --method linear
    """
    console = plain_console(stderr=json)
    recording = open_recording(bag, robot)
    names = tuple(name.strip() for name in topics.split(',') if name.strip())
    target = resolve_folder(out, 'export')
    with ExportProgress(console) as progress:
        done = export_recording(
            recording, ExportRequest(form, names, rate, method), target, progress
        )
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
    """Return what --json prints."""
    files = [
        {'topic': each.topic, 'file': str(each.file), 'rows': each.rows, 'columns': each.columns}
        for each in done.files
    ]
    return {'folder': str(target), 'files': files, 'remarks': done.remarks}

"""lta light plan: place lamps on a floor plan, assign frequencies and compute coverage."""

from pathlib import Path
import sys
from typing import Annotated

from lta_bridge.bag.writer import prepare_empty_folder
from lta_cli.options.output_options import Json, Out
from lta_cli.options.plain_console import plain_console
from lta_config.command_line import format_lta_command, relative_path
from lta_report.browser import find_chromium
from lta_report.progress_bar import ProgressBar
from lta_report.results_folder import (
    check_creatable,
    format_page_line,
    resolve_folder,
    stage_results,
    write_json,
)
from lta_report.screenshots import write_pictures
from lta_studies.light.plan.floor import build_floor
from lta_studies.light.plan.gaps import find_gaps
from lta_studies.light.plan.handover import plan_handover
from lta_studies.light.plan.inputs import load_inputs
from lta_studies.light.plan.json_output import encode_layout
from lta_studies.light.plan.layout import LampLayout
from lta_studies.light.plan.mounts import list_mounts
from lta_studies.light.plan.page import format_headline, format_percent, write_page
from lta_studies.light.plan.planner import plan_layout
from lta_studies.light.plan.scenario_file import format_scenario
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
import typer


def plan(
    name: Annotated[
        str, typer.Argument(metavar='PLAN', help='Floor plan: a shipped name or a file.')
    ] = 'warehouse',
    vehicle: Annotated[
        str, typer.Option(help='Vehicle that carries the photodiodes, name or file.')
    ] = 'gtmab',
    overlap: Annotated[
        int,
        typer.Option(
            help='Number of lamps that the drone must detect at every point; 2 allows hand-over '
            'between lamps.',
            min=1,
            max=4,
        ),
    ] = 1,
    lamps: Annotated[
        int | None, typer.Option(help='Maximum number of lamps; unlimited by default.', min=1)
    ] = None,
    margin: Annotated[
        float,
        typer.Option(
            help="Required signal-to-noise ratio, as a multiple of the demodulator's threshold.",
            min=1.0,
            max=1000.0,
        ),
    ] = 2.0,
    cell: Annotated[
        float, typer.Option(help='Cell size of the floor grid in metres.', min=0.1, max=10.0)
    ] = 0.5,
    changes: Annotated[
        list[str] | None,
        typer.Option('--set', metavar='PATH=VALUE', help='Override a parameter; repeatable.'),
    ] = None,
    out: Out = None,
    pictures: Annotated[
        Path | None,
        typer.Option(
            help='Write each figure as PNG to this folder; needs Chromium.', metavar='FOLDER'
        ),
    ] = None,
    json: Json = False,
) -> None:
    """
    Place lamps on a floor plan, so that the drone detects one anywhere, at any heading.

    A floor plan file defines the hall, its obstacles, the lamp type and possible lamp positions,
    and the altitude of the drone. The planner searches for the fewest lamps on a grid of positions
    and reports a lower bound. Each lamp gets a frequency away from mains, other lamps and their
    harmonics. Finally, coverage is checked with all lamps on.

    --set overrides a parameter: 'plan.lamp.height=4 m', 'demodulator.window=1',
    'vehicle.sensors.diodes.feedback=10 kohm'.

    Writes a page with coverage, gaps and hand-overs between lamps; plan.json (SI units); and
    scenario.yaml with the lamps and a route along them.

    Exit status 0: done, whatever the coverage. 2: bad input. 130: Ctrl-C.

    Example: lta light plan warehouse --overlap 2 --lamps 30
    """
    console = plain_console(stderr=json)
    if pictures is not None:
        find_chromium()  # raises BadInput before any work
        prepare_empty_folder(pictures)
    content, receiver = load_inputs(name, vehicle, margin, changes or ())
    floor = build_floor(content, receiver.vehicle, cell)
    # All possible lamp positions; the light of each is computed once
    mounts = list_mounts(content)
    target = resolve_folder(out, f'{content.name}-lamps')
    check_creatable(target)
    columns = (TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn())
    with ProgressBar(console, *columns, begin='light of each place', total=len(mounts)) as bar:
        found = plan_layout(
            content, receiver, floor, mounts, overlap, lamps,
            lambda: bar.update_bar(advance=1), lambda words: bar.update_bar(description=words),
        )  # fmt: skip
        bar.update_bar(description='hand-overs')
        # Needs the whole layout: each lamp must be received where the flight to the last one ends
        handover = plan_handover(found)
    told, scene = encode_layout(found, handover), format_scenario(found, handover)
    words = ['light', 'plan', name, '--vehicle', vehicle, '--overlap', str(overlap)]
    words += ['--margin', f'{margin:g}', '--cell', f'{cell:g}']
    words += [] if lamps is None else ['--lamps', str(lamps)]
    words += [word for change in changes or () for word in ('--set', change)]
    fly = format_lta_command(
        'fly', '--vehicle', vehicle, '--scenario', str(relative_path(target / 'scenario.yaml'))
    )
    # Write into a temporary folder that is renamed when complete
    with stage_results(target, 'report.html') as part:
        text = write_json(told, part / 'plan.json')
        (part / 'scenario.yaml').write_text(scene, encoding='utf-8')
        write_page(found, handover, format_lta_command(*words), scene, fly, part / 'report.html')
    if pictures is not None:
        write_pictures(target / 'report.html', pictures)
    if json:
        sys.stdout.write(text)
    print_plan(found, console)
    console.print(
        format_page_line(relative_path(target / 'report.html')), highlight=False, soft_wrap=True
    )


def print_plan(result: LampLayout, console: Console) -> None:
    """Print the lamps and the gaps."""
    console.print(format_headline(result), highlight=False)
    printed = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0))
    for column in ('lamp', 'x [m]', 'y [m]', 'z [m]', 'Hz', 'coverage [m²]'):
        printed.add_column(column, justify='left' if column == 'lamp' else 'right', no_wrap=True)
    for k, lamp in enumerate(result.lamps):
        # Number of covered cells times the cell area [m2]
        area = float(result.is_received[k].sum()) * result.floor.cell**2
        place = (f'{part:.1f}' for part in lamp.mount.position)
        printed.add_row(lamp.name, *place, f'{lamp.frequency:g}', f'{area:.0f}')
    console.print(printed)
    # Connected areas without enough lamps
    gaps = find_gaps(result)
    if gaps:
        lost = sum(gap.area for gap in gaps)
        first = gaps[0]
        console.print(
            f'{len(gaps)} gap{"s" if len(gaps) > 1 else ""} in the coverage, {lost:.1f} m² in '
            f'total; the largest at x {first.west:.1f} to {first.east:.1f} m, y '
            f'{first.south:.1f} to {first.north:.1f} m: {first.why}.',
            highlight=False, soft_wrap=True,
        )  # fmt: skip
    count = len(result.lamps)
    console.print(
        f'{count} lamps (at least {result.bound} are needed), one per '
        f'{result.floor.area / count:.0f} m² of floor; two or more lamps are detected on '
        f'{format_percent(float((result.received_count >= 2).mean()))} % of the floor.',
        highlight=False, soft_wrap=True,
    )  # fmt: skip

"""lta light plan: place lamps on a floor plan, assign frequencies and compute coverage."""

from functools import partial
from typing import Annotated

from lta_cli.options.common_options import VehicleOption
from lta_cli.options.study_command import study_command, StudyRun
from lta_config.command_line import format_lta_command, relative_path
from lta_report.report import Report
from lta_report.results_folder import resolve_folder
from lta_report.study import hash_inputs, Study
from lta_studies.light.plan.floor import build_floor
from lta_studies.light.plan.handover import plan_handover
from lta_studies.light.plan.inputs import load_inputs
from lta_studies.light.plan.mounts import list_mounts
from lta_studies.light.plan.planner import plan_layout
from lta_studies.light.plan.polygon import Array
from lta_studies.light.plan.reception import compute_group_light, GROUP, STORE
from lta_studies.light.plan.report import build_report, SCENARIO
import typer


@study_command('plan', quick={'cell': 1.0})
def plan(
    name: Annotated[
        str, typer.Argument(metavar='PLAN', help='Floor plan: a shipped name or a file.')
    ] = 'warehouse',
    vehicle: VehicleOption = 'gtmab',
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
    *,
    run: StudyRun,
) -> Report:
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
    content, receiver = load_inputs(name, vehicle, margin, changes or ())
    folder = run.open_folder(resolve_folder(None, f'{content.name}-lamps'))
    floor = build_floor(content, receiver.vehicle, cell)
    # All possible lamp positions; the light of each is computed once
    mounts = list_mounts(content)

    def measure_light(faintest: float) -> list[Array]:
        compute = partial(compute_group_light, content, receiver, floor, mounts, faintest)
        study = Study(compute, str, STORE, 'groups of lamps')
        inputs = (content, receiver.vehicle.file, receiver.demodulation, cell, faintest)
        groups = range(0, len(mounts), GROUP)
        return run.run_study(study, hash_inputs(*inputs), groups)

    layout = plan_layout(content, receiver, floor, mounts, overlap, lamps, measure_light)
    # Needs the whole layout: each lamp must be received where the flight to the last one ends
    handover = plan_handover(layout)
    fly = format_lta_command(
        'fly', '--vehicle', vehicle, '--scenario', str(relative_path(folder / SCENARIO))
    )
    return build_report(layout, handover, fly)

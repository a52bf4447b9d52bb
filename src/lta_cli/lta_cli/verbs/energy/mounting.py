"""lta energy mounting: compare positions of the solar panels."""

from functools import partial
from itertools import chain
from operator import attrgetter
from typing import Annotated

from lta_cli.options.common_options import VehicleOption
from lta_cli.options.study_command import study_command, StudyRun
from lta_config.command_line import format_lta_command, relative_path
from lta_config.files import find_file, load_yaml
from lta_report.report import Report
from lta_report.study import hash_inputs, Study
from lta_studies.energy.mounting.report import build_report
from lta_studies.energy.mounting.run import (
    compare_mounts,
    fly_mount,
    MountingRequest,
    STORE,
)
from lta_studies.energy.mounting.straight_flight import SCENE
from lta_studies.energy.mounting.verdict import find_best_mount
import typer

MOUNTS = ['side', 'bottom', 'top']


@study_command('mounting', quick={'seeds': 1})
def mounting(
    mount: Annotated[
        list[str] | None,
        typer.Option(
            help='Solar panel mount, name or file; repeat to compare several. Default: side, '
            'bottom and top.'
        ),
    ] = None,
    vehicle: VehicleOption = 'gtmab',
    misplaced: Annotated[
        float,
        typer.Option(help='Forward displacement of the panels in the misplaced variant, in cm; '
                     'negative: backward.',
                     min=-50.0, max=50.0),
    ] = 3.0,
    seeds: Annotated[
        int, typer.Option(help='Number of flights with each mount.', min=1, max=100)
    ] = 3,
    *,
    run: StudyRun,
) -> Report:  # fmt: skip
    """
    Compare solar panels mounted at the side, at the bottom and on top.

    A mount is a file in config/mounts: parts that replace a layer, some of them panels. Mass,
    balance, inertia, drag and shading follow from it. Each variant is released tilted, checked
    against a closed-form solution, and flown straight at 0.1 m/s with panels in place and
    misplaced. If the hull cannot carry a mount, all variants are compared in a fuller hull. The
    page also shows the effect of a centre of gravity above the centre of buoyancy.

    Writes a page, mounting.json (SI units) and a vehicle file for each variant.

    Exit status 0: done. 2: bad input.

    Example: lta energy mounting --seeds 1
    """
    names = list(dict.fromkeys(mount or MOUNTS))
    # cm to m; the raw file, because mounts replace one of its layers
    content = load_yaml(find_file('vehicle', vehicle))
    request = MountingRequest(content, names, misplaced / 100.0, seeds)
    vehicles = chain(*request.build_vehicles().values())
    scene = load_yaml(find_file('scenario', SCENE))
    identity = hash_inputs(scene, *(each.content for each in vehicles))
    flying = Study(fly_mount, attrgetter('key'), STORE, 'flights')
    study = compare_mounts(request, partial(run.run_study, flying, identity))
    best = relative_path(run.folder / f'{find_best_mount(study)}.yaml')
    commands = {
        'Compare with the vehicle': format_lta_command('vehicle', 'diff', vehicle, best),
        'Fly it': format_lta_command('simulate', '--vehicle', best),
    }
    return build_report(study, commands)

"""lta energy budget: measure the power of each task and compare it with the paper."""

from functools import partial
from typing import Annotated

from lta_cli.options.common_options import VehicleOption
from lta_cli.options.study_command import study_command, StudyRun
from lta_flight.flight_spec import load_spec
from lta_report.report import Report
from lta_report.study import hash_inputs, Study
from lta_studies.energy.budget.report import build_report
from lta_studies.energy.budget.run import measure_budget
from lta_studies.energy.budget.tasks import fly_task, LAMP_SCENE, SCENE, STORE
import typer


@study_command('budget', quick={'seeds': 1})
def budget(
    vehicle: VehicleOption = 'gtmab',
    multirotor: Annotated[
        str, typer.Option('--beside', help='Multirotor to compare with, name or file.')
    ] = 'multirotor',
    seeds: Annotated[
        int, typer.Option(help='Number of flights of each vehicle.', min=1, max=100)
    ] = 3,
    *,
    run: StudyRun,
) -> Report:
    """
    Measure the power of each task: standing, take-off, hovering, flying, finding a lamp.

    Simulated flights give the power of rotors and electronics separately, compared with the seed
    paper and a hovering multirotor. Where the paper differs, the study computes what would explain
    it: more weight, a draught, less efficient rotors. Rotor power by duty and voltage is compared
    with Bitcraze's bench measurements.

    Exit status 0: done. 2: bad input.

    Example: lta energy budget --seeds 1
    """
    scenes = [load_spec(vehicle, scene, 'bag', '') for scene in (SCENE, LAMP_SCENE)]
    specs = [*scenes, load_spec(multirotor, SCENE, 'bag', '')]
    identity = hash_inputs(*(spec.contents for spec in specs))
    study = Study(fly_task, str, STORE, 'flights')
    fly_all = partial(run.run_study, study, identity)
    return build_report(measure_budget(vehicle, multirotor, seeds, fly_all))

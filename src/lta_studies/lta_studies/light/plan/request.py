"""What `lta light plan` takes, and what it does in which order."""

from functools import partial
from typing import final

from lta_config.command_line import format_lta_command, relative_path
from lta_report.report import Report
from lta_report.request import argument, CHANGES, Changes, option, StudyRequest, StudyRun, VEHICLE
from lta_report.results_folder import resolve_folder
from lta_report.study import hash_inputs, Study
from lta_studies.light.plan.floor import build_floor
from lta_studies.light.plan.floor_plan import Array
from lta_studies.light.plan.layout import plan_handover
from lta_studies.light.plan.planner import list_mounts, plan_layout
from lta_studies.light.plan.reception import compute_group_light, GROUP, LIGHT_STORE
from lta_studies.light.plan.scenario_file import load_inputs


@final
class LampPlanRequest(StudyRequest, command='light plan', quick={'cell': 1.0}):
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

    name: str = argument(
        'Floor plan: a shipped name or a file.', default='warehouse', metavar='PLAN'
    )
    vehicle: str = VEHICLE
    overlap: int = option(
        'Number of lamps that the drone must detect at every point; 2 allows hand-over between '
        'lamps.',
        default=1, low=1, high=4,
    )  # fmt: skip
    lamps: int | None = option(
        'Maximum number of lamps; unlimited by default.', default=None, low=1
    )
    margin: float = option(
        "Required signal-to-noise ratio, as a multiple of the demodulator's threshold.",
        default=2.0, low=1.0, high=1000.0,
    )  # fmt: skip
    cell: float = option('Cell size of the floor grid in metres.', default=0.5, low=0.1, high=10.0)
    changes: Changes = CHANGES

    def run(self, run: StudyRun) -> Report:
        """Return the report of the plan."""
        from lta_studies.light.plan.report import build_report, SCENARIO_FILE

        content, receiver = load_inputs(self.name, self.vehicle, self.margin, self.changes)
        folder = run.open_folder(resolve_folder(None, f'{content.name}-lamps'))
        floor = build_floor(content, receiver.vehicle, self.cell)
        # All possible lamp positions; the light of each is computed once
        mounts = list_mounts(content)

        def measure_light(faintest: float) -> list[Array]:
            compute = partial(compute_group_light, content, receiver, floor, mounts, faintest)
            study = Study(compute, str, LIGHT_STORE, 'groups of lamps')
            inputs = (content, receiver.vehicle.file, receiver.demodulation, self.cell, faintest)
            return run.run_study(study, hash_inputs(*inputs), range(0, len(mounts), GROUP))

        layout = plan_layout(
            content, receiver, floor, mounts, self.overlap, self.lamps, measure_light
        )
        # Needs the whole layout: each lamp must be received where the flight to the last one ends
        handover = plan_handover(layout)
        place = str(relative_path(folder / SCENARIO_FILE))
        fly = format_lta_command('fly', '--vehicle', self.vehicle, '--scenario', place)
        return build_report(layout, handover, fly)

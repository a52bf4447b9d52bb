# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What `lta light plan` takes, and what it does in which order."""

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise
import math
from types import MappingProxyType
from typing import Any, final

from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import unknown_name_error
from lta_config.files import find_file, load_yaml, validate_content
from lta_config.parameter_override import replace_parameter
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.topics import load_topic_table
from lta_model.scenario import VERTICAL_TOLERANCE
from lta_model.vehicle import Vehicle
from lta_report.report import Report
from lta_report.request import argument, CHANGES, Changes, option, StudyRequest, StudyRun, VEHICLE
from lta_report.results_folder import resolve_folder
from lta_report.study import hash_inputs, Study
from lta_studies.light.plan.floor import Array, build_floor, FloorPlan
from lta_studies.light.plan.joint_snr import LightReceiver
from lta_studies.light.plan.layout import LampHandover, LampLayout, LayoutLamp, plan_handover
from lta_studies.light.plan.planner import list_mounts, plan_layout
from lta_studies.light.plan.reception import compute_group_light, GROUP, LIGHT_STORE
from lta_vlc.settings import DemodulationSettings


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


PLAN_ROOTS = ('plan', 'vehicle', 'demodulator')


def load_inputs(
    plan: str, vehicle: str, margin: float, changes: Mapping[str, Any] = MappingProxyType({})
) -> tuple[FloorPlan, LightReceiver]:
    """
    Load the hall and the receiver.

    `plan`, `vehicle`: shipped names or paths. `margin`: required SNR relative to the demodulator's
    threshold. `changes`: values by path, which starts with plan, vehicle or demodulator.
    Raise `BadInput` if a file or a change cannot be used.
    """
    files = {'plan': find_file('floor plan', plan), 'vehicle': find_file('vehicle', vehicle)}
    contents = {root: load_yaml(path) for root, path in files.items()}
    # The demodulator has no file of its own: --set changes its defaults.
    contents['demodulator'] = DemodulationSettings().model_dump()
    for path, value in changes.items():
        root, _, below = path.partition('.')
        if root not in PLAN_ROOTS or not below:
            raise unknown_name_error('parameter', path, [f'{name}. ...' for name in PLAN_ROOTS])
        contents[root] = replace_parameter(contents[root], below, value, root)
    hall = validate_content(FloorPlan, contents['plan'], str(files['plan']))
    receiver = Vehicle(validate_content(VehicleFile, contents['vehicle'], str(files['vehicle'])))
    settings = validate_content(DemodulationSettings, contents['demodulator'], 'The demodulator')
    return hall, LightReceiver(receiver, settings, load_topic_table().light, margin)


LEAST_GOAL_RADIUS = 1.0  # m, minimum goal radius around a lamp
ALTITUDE_TOLERANCE = 0.5  # m, half a hull: how exactly the altitude is held, with room to spare
ROUTE_SPEED = 0.2  # m/s along the route, determines the time limit


def format_scenario(layout: LampLayout, handover: LampHandover) -> str:
    """
    Return the scenario file of a layout.

    The room is the bounding box of the outline with its origin in the middle. Obstacles are left
    out, as the simulator does not support them.
    """
    plan = layout.plan
    low, high = plan.outline.corners.min(axis=0), plan.outline.corners.max(axis=0)
    # Scenarios have their origin at the centre of the floor, plans anywhere.
    middle = 0.5 * (low + high)
    x, y = middle if handover.start is None else handover.start
    ambient = plan.ambient
    lines = [
        f'# Laid out by "lta light plan {plan.name}".',
        '#',
        '# The room is the bounding box of the floor plan. Obstacles are left out: the simulator',
        '# does not model them. Map frame: origin at the centre of the floor, axes of the plan.',
        '#',
        f'# The lamps are placed for an altitude of {plan.altitude.si:g} m: fly it with',
        f'# --strategy homing --set mission.altitude={plan.altitude.si:g}',
        'schema: 1',
        f'name: {plan.name}_lamps',
        f'about: {len(layout.lamps)} lamps laid out in {plan.name}, and a route along them.',
        '',
        'room:',
        f'  size: {_format_lengths(*(high - low), plan.height.si)}',
        f'  albedo: {plan.albedo:g}',
        '  walls: solid',
        '',
        'air:',
        '  temperature: 20 degC',
        '  pressure: 1013.25 hPa',
        '  wind: {value: [0, 0, 0], unit: m/s}',
        '',
        'lamps:',
        *(line for lamp in layout.lamps for line in _format_lamp(layout, lamp, middle)),
        '',
        f'route: [{", ".join(layout.lamps[k].name for k in handover.route)}]',
        '',
        'ambient:',
        f'  steady: {ambient.steady.si:g} lx',
        f'  mains_amplitude: {ambient.mains_amplitude.si:g} lx',
        f'  mains_frequency: {ambient.mains_frequency.si:g} Hz',
        f'  efficacy: {ambient.efficacy.si:g} lm/W',
        '',
        'start:',
        f'  position: {_format_lengths(x - middle[0], y - middle[1])}',
        '  heading: 0 deg',
        '  heading_spread: 180 deg',
        '  charge: 95 %',
        '',
        'goal:',
        f'  radius: {_goal_radius(layout, handover):g} m',
        f'  vertical_tolerance: {_vertical_tolerance(layout):g} m',
        f'  time_limit: {_time_limit(handover):g} s',
    ]
    return '\n'.join(lines) + '\n'


def _format_lamp(layout: LampLayout, lamp: LayoutLamp, middle: Sequence[float]) -> list[str]:
    kind, (x, y, z) = layout.plan.lamp, lamp.mount.position
    facing = ', '.join(f'{part + 0.0:g}' for part in lamp.mount.axis)  # no -0
    return [
        f'  {lamp.name}:',
        f'    position: {_format_lengths(x - middle[0], y - middle[1], z)}',
        f'    facing: {{value: [{facing}], unit: "1"}}',
        f'    flux: {kind.flux.si:g} lm',
        f'    half_power: {math.degrees(kind.half_power.si):g} deg',
        f'    frequency: {lamp.frequency:g} Hz',
        f'    duty: {100.0 * kind.duty.si:g} %',
        f'    efficacy: {kind.efficacy.si:g} lm/W',
    ]


def _format_lengths(*numbers: float) -> str:
    return (
        f'{{value: [{", ".join(f"{round(float(number), 3):g}" for number in numbers)}], unit: m}}'
    )


def _goal_radius(layout: LampLayout, handover: LampHandover) -> float:
    """Return a goal radius that includes all arrivals, where the hull hides a lamp [m]."""
    ends = [
        math.dist(end, layout.lamps[k].mount.position[:2])
        for k in handover.route
        if (end := handover.arrivals[k]) is not None
    ]
    # At least 0.5 m beyond the farthest arrival, rounded up to half a metre
    return max([LEAST_GOAL_RADIUS, *(math.ceil(2.0 * end + 1.0) / 2.0 for end in ends)])


def _vertical_tolerance(layout: LampLayout) -> float:
    """Return a tolerance of height that includes the altitude of the plan [m]."""
    plan = layout.plan
    return max(
        VERTICAL_TOLERANCE.si,
        round(abs(plan.altitude.si - plan.lamp.height.si), 2) + ALTITUDE_TOLERANCE,
    )


def _time_limit(handover: LampHandover) -> float:
    """Return the time limit of the route, in whole minutes [s]."""
    places = [handover.start, *(handover.arrivals[k] for k in handover.route)]
    stops = [place for place in places if place is not None]
    way = sum(math.dist(a, b) for a, b in pairwise(stops))
    return 60.0 * max(math.ceil(way / ROUTE_SPEED / 60.0), 1)

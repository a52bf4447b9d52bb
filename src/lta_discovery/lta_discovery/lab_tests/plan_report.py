# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the printable list of the tests of an afternoon, each with a sketch."""

from collections.abc import Sequence
from html import escape
import math
from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import format_count
from lta_discovery.formatting import format_number, join_words
from lta_discovery.lab_tests.design import Kind, LabTest, rest_duties, step_duties
from lta_discovery.lab_tests.plan import LabPlan, PlannedTest
from lta_discovery.lab_tests.words import format_amplitude, name_parameters
from lta_model.vehicle import Vehicle
from lta_report.formatting import Tile
from lta_report.report import HtmlBlock, Report, TextSection, TextTable

FREE_FLIGHTS: Final = 2  # free flights: one teaches, one confirms
SHOWN: Final = 5  # things that a test teaches, as shown
PATH_CLEARANCE: Final = 1.0  # m; around the path of a test
BOX: Final = '\N{BALLOT BOX}'
SCALES: Final = (
    'Weigh the vehicle, without its gas, on scales to 0.1 g. Correct the masses of the parts in '
    "its file (lta vehicle set), or measured.mass where the file has it: that is with the gas's "
    'own mass. No flight shows it: all forces and masses can be scaled together.'
)
WRONG: Final[dict[Kind, str]] = {
    'float': (
        'A hand that lets go turns or pushes it: hold it between two fingertips. A draught looks '
        'like lift: switch off the ventilation. Then add ballast until it hovers by itself.'
    ),
    'swing': (
        'It turns about the vertical while it swings: release it without a twist, and repeat. It '
        'drifts into a wall: the ballast is not right. A tether changes the swing.'
    ),
    'step': (
        'It meets a wall before it is steady: take a smaller command rather than a shorter one. '
        'Start at rest, and let nobody correct on other axes.'
    ),
    'spin_down': (
        'It wobbles: turn it at its equator with both hands. A rotor that idles brakes it: switch '
        'the motors off.'
    ),
    'free_flight': (
        'A controller that holds everything still teaches little: fly climbs, turns and pushes. '
        'The first and the last second with a hand at the vehicle are cut.'
    ),
}
STEP_SIZE_ADVICE: Final = (
    'Steps of two sizes and in both directions show the law of the thrust: a force that goes by '
    'the square of the command, or is weaker in reverse, looks like another gain at one size.'
)
TEST_ADVICE: Final = (
    'Track position and attitude: motion capture, or a fixed camera that sees markers on the '
    'vehicle. Without a tracker, no flight calibrates the vehicle file; scales and ruler do.',
    'Log pose and commands with one clock, at 20 Hz or more, one file for each test, all with the '
    'same columns; also the commands of tests without any, as zeros.',
    'Keep the markers where they are: their frame is calibrated with everything else.',
)


def build_plan_report(plan: LabPlan, vehicle: Vehicle) -> Report:
    """Return the list of an afternoon."""
    needed = [one for one in plan.tests if one.is_needed]
    left = [one.test.name for one in plan.tests if not one.is_needed and not one.test.variant]
    flights = sum(_count_runs(one.test) for one in needed)
    seconds = sum(_count_runs(one.test) * one.test.seconds for one in needed)
    sections = [
        TextSection(
            'What can go wrong',
            [
                f'{_kind_title(kind)}: {WRONG[kind]}'
                for kind in dict.fromkeys(one.test.kind for one in needed)
            ],
            bullets=True,
            printed=True,
        ),
        TextSection('In every test', TEST_ADVICE, bullets=True, printed=True),
    ]
    notes = _list_notes(plan, vehicle, left)
    if notes:
        sections.append(TextSection('Notes', notes, bullets=True, printed=True))
    return Report(
        command='tests plan',
        subject=plan.vehicle,
        headline=(
            f'{format_count(flights, "log")} of a tracker with {seconds / 60.0:.0f} minutes of '
            f'motion calibrate {plan.vehicle}.'
        ),
        introduction=(
            'The list follows from the vehicle file: each test was rehearsed with its model, and '
            'is listed if its poses teach something that shorter tests do not.'
        ),
        tiles=[
            Tile('Logs', str(flights), '', 'one file each'),
            Tile('Motion', f'{seconds / 60.0:.1f}', 'min', 'without preparation'),
            Tile('Room', f'{_room_size(needed, vehicle):.1f}', 'm', 'longest side'),
        ],
        blocks=(
            _build_test_table(needed, plan, vehicle),
            HtmlBlock(draw_sketches([one.test for one in needed]), 'Sketches'),
            _build_reason_table(needed, vehicle),
            *sections,
        ),
        data=encode_plan(plan, vehicle),
        commands={
            'Read the logs': format_lta_command(
                'tests', 'read', 'FOLDER', '--vehicle', plan.vehicle
            )
        },
    )


def _count_runs(test: LabTest) -> int:
    """Return how often a test is flown."""
    return FREE_FLIGHTS if test.kind == 'free_flight' else 1


def _kind_title(kind: Kind) -> str:
    """Return the name of a kind of test."""
    return {'spin_down': 'Spin-down', 'free_flight': 'Free flight'}.get(kind, kind.capitalize())


def _test_duties(plan: LabPlan, vehicle: Vehicle, test: LabTest) -> Sequence[float]:
    """Return the duties of a step; none for a commanded wrench."""
    if plan.commands == 'wrench' or test.kind != 'step':
        return ()
    return step_duties(vehicle, test)


def _list_runs(tests: Sequence[PlannedTest]) -> list[tuple[str, PlannedTest]]:
    """Return each run with its title."""
    out = []
    for planned in tests:
        count = _count_runs(planned.test)
        name = planned.test.name
        out += [(f'{name} {k + 1}' if count > 1 else name, planned) for k in range(count)]
    return out


def _build_test_table(tests: Sequence[PlannedTest], plan: LabPlan, vehicle: Vehicle) -> TextTable:
    """Return what to do."""
    rows = [[f'{BOX} 1 weigh', 'on scales, without gas', '', '']]
    for number, (title, planned) in enumerate(_list_runs(tests), start=2):
        duties = _test_duties(plan, vehicle, planned.test)
        free = planned.test.kind == 'free_flight'
        rows.append([
            f'{BOX} {number} {title}',
            format_amplitude(planned.test, vehicle.rotor_names, duties),
            f'{planned.test.seconds:.0f}',
            '' if free else f'{planned.room[0]:.1f}, {planned.room[1]:.1f}',
        ])  # fmt: skip
    heads = ('test', 'how', 'time [s]', 'moves along, up [m]')
    note = (
        f'Steps begin at rest. Add the size of the vehicle and {PATH_CLEARANCE:g} m on each side '
        'to the motion; the pilot keeps a free flight within the room.'
    )
    return TextTable('The afternoon', heads, rows, note)


def _build_reason_table(tests: Sequence[PlannedTest], vehicle: Vehicle) -> TextTable:
    """Return why each test is on the list."""
    rows = [['weigh', SCALES]]
    for planned in tests:
        words = name_parameters([name for name, _ in planned.informs], vehicle.rotor_names)
        rows.append([planned.test.name, join_words(words[:SHOWN])])
    note = 'What other tests teach less well comes first.'
    return TextTable('Why', ('test', 'teaches'), rows, note)


def _room_size(tests: Sequence[PlannedTest], vehicle: Vehicle) -> float:
    """Return the longest side of the room that the tests need [m]."""
    drilled = [one.room for one in tests if one.test.kind != 'free_flight']
    way = max((max(room) for room in drilled), default=0.0)
    hull = vehicle.file.hull
    size = max((each.si for each in (hull.diameter, hull.length) if each is not None), default=0.0)
    return way + size + 2.0 * PATH_CLEARANCE


def _list_notes(plan: LabPlan, vehicle: Vehicle, left: Sequence[str]) -> list[str]:
    """Return remarks on this vehicle."""
    out = []
    if abs(plan.weight) > 1e-3:
        grams = format_number(1e3 * abs(plan.weight) / STANDARD_GRAVITY, 2)
        side, do = ('heavy', 'remove') if plan.weight > 0.0 else ('light', 'add')
        out.append(
            f'By its file the vehicle is {grams} g too {side} to float: {do} as much ballast for '
            'float, swings and spin-down, near the hull centre or where the ballast is.'
        )
    if plan.commands == 'rotors' and plan.weight > 0.0:
        hover = max(rest_duties(vehicle), default=0.0)
        out.append(f'In steps, the lifting rotors carry the weight, at a duty of {hover:.2f}.')
    if any(one.is_needed and one.test.variant for one in plan.tests):
        out.append(STEP_SIZE_ADVICE)
    if left:
        out.append(f'Not needed: {join_words(left)}; shorter tests teach as much.')
    unknown = name_parameters(
        [n for n in plan.unknown if n != 'vehicle.mass'], vehicle.rotor_names
    )
    if unknown:
        out.append(f'No test teaches much about {join_words(unknown)}.')
    return out


def encode_plan(plan: LabPlan, vehicle: Vehicle) -> dict[str, Any]:
    """Return the plan as JSON data, in SI units."""
    return {
        'vehicle': plan.vehicle,
        'commands': plan.commands,
        'weight': plan.weight,
        'not_taught': list(plan.unknown),
        'tests': [
            {
                'test': one.test.name,
                'kind': one.test.kind,
                'axis': one.test.axis,
                'is_needed': one.is_needed,
                'runs': _count_runs(one.test),
                'seconds': one.test.seconds,
                'tilt': one.test.tilt,
                'yaw_rate': one.test.rate,
                'share_of_limit': one.test.share,
                'force_or_moment': one.test.size,
                'duties': list(_test_duties(plan, vehicle, one.test)),
                'way': {'horizontal': one.room[0], 'vertical': one.room[1]},
                'needs_ballast': one.test.is_neutral,
                'informs': dict(one.informs),
                'needed_for': list(one.best_for),
                'what_can_go_wrong': WRONG[one.test.kind],
            }
            for one in plan.tests
        ],
    }


# Seen from above, where the vehicle turns about the vertical or moves sideways
TOP_VIEW: Final = 'from above, nose to the right'
SKETCH_VIEW: Final = '-84 -66 168 132'  # of a sketch, with the hull in its middle [px]
HULL: Final = '<ellipse rx="44" ry="30"/>'
NOSE: Final = '<path d="M44 0 l-11 -5 v10 z" class="ink"/>'
GONDOLA: Final = '<rect x="-12" y="31" width="24" height="8" class="ink"/>'
STYLE: Final = (
    '<style>.sketches { display: flex; flex-wrap: wrap; gap: 8px 16px; } '
    '.sketches figure { margin: 0; width: 150px; text-align: center; font-size: 13px; } '
    '.sketches svg { fill: none; stroke: var(--soft); stroke-width: 1.5; } '
    '.sketches .ink { fill: var(--soft); stroke: none; } '
    '.sketches .move { stroke: var(--accent); stroke-width: 3; } '
    '.sketches .tip { fill: var(--accent); stroke: none; }</style>'
)
# Arrows to the right and counter-clockwise
PUSH_ARROW: Final = (
    '<path d="M48 0 H70" class="move"/><path d="M82 0 l-14 -7 v14 z" class="tip"/>'
)  # fmt: skip
TURN: Final = (
    '<path d="M52 24 A58 46 0 0 0 40 -34" class="move"/>'
    '<path d="M31 -41 l4 13 l10 -9 z" class="tip"/>'
)
WANDER: Final = '<path d="M-72 50 q12 -18 24 0 t24 0 t24 0 t24 0 t24 0 t24 0" class="move"/>'


def draw_sketches(tests: Sequence[LabTest]) -> str:
    """Return a row of sketches as HTML, one for each test."""
    figures = ''.join(
        f'<figure><svg viewBox="{SKETCH_VIEW}" role="img" aria-label="{escape(test.name)}">'
        f'{draw_sketch(test)}</svg>{escape(test.name)}<br><small>{name_view(test)}</small></figure>'
        for test in tests
    )
    return f'{STYLE}<div class="sketches">{figures}</div>'


def name_view(test: LabTest) -> str:
    """Return from where a test is seen."""
    if test.kind == 'spin_down' or test.axis in ('yaw', 'sway'):
        return TOP_VIEW
    return 'from behind' if test.axis == 'roll' else 'from the right side'


def draw_sketch(test: LabTest) -> str:
    """Return the vehicle, and what moves it."""
    view = name_view(test)
    body = HULL + ('' if view == TOP_VIEW else GONDOLA) + ('' if view == 'from behind' else NOSE)
    back = test.size < 0.0
    if test.kind == 'swing':
        held = f'<g transform="rotate({math.degrees(test.tilt):.0f})">{body}</g>'
        return f'<g stroke-dasharray="3 3">{body}</g>{held}'
    if test.kind == 'spin_down' or test.axis == 'yaw':
        return f'{body}<g transform="scale(1 {-1 if back else 1})">{TURN}</g>'
    if test.kind == 'step':  # forward is right, left and up are up in the sketch
        angle = (0 if test.axis == 'surge' else -90) + (180 if back else 0)
        near = 0 if test.axis == 'surge' else -14  # the hull is lower than it is long
        return f'{body}<g transform="rotate({angle}) translate({near} 0)">{PUSH_ARROW}</g>'
    return body + (WANDER if test.kind == 'free_flight' else '')

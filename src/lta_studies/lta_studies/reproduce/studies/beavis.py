# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare BEAVIS and GT-MAB, both 2 g heavy: altitude, yaw hold, changing yaw."""

from typing import Final

from lta_config.command_line import format_lta_command
from lta_config.constants import AIR_DENSITY, STANDARD_GRAVITY
from lta_studies.platforms.flight import build_entrant, compute_lift_margin
from lta_studies.reproduce.manoeuvres import (
    ComparisonFlights,
    draw_gtmab,
    fly_entries,
    load_scene,
)
from lta_studies.reproduce.study_result import (
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)

BEAVIS_MANOEUVRES: Final = ('climb', 'turn', 'follow')
COMPARED_ENTRIES: Final = ('gtmab', 'beavis_paper')
# Entries whose rates of success claims bound by 80 or 20 %: so many flights, all with the same
# outcome, have a Wilson interval on one side of that
JUDGED: Final = (*COMPARED_ENTRIES, 'beavis_by_matrix')
RATE_SEEDS: Final = 16
CHANGED: Final = {
    'beavis': BEAVIS_MANOEUVRES,
    'beavis_uncompensated': BEAVIS_MANOEUVRES,
    'beavis_too_heavy': ('climb',),
}
BEAVIS_CAPTIONS: Final = {
    'climb': 'The drone rises by 1.5 m and holds its altitude. Dashed: setpoint; seed 1.',
    'turn': 'The drone rises, turns left by 90° and holds its heading. Dashed: setpoint; seed 1.',
    'follow': 'The drone rises and tracks a heading that moves between 0 and 90° at 6°/s; seed 1.',
}
BEAVIS_HEADINGS: Final = {
    'climb': 'Altitude', 'turn': 'Yaw angle', 'follow': 'Continuously changing yaw',
}  # fmt: skip


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Fly both platforms in the paper's tasks, and the variants of BEAVIS."""
    # Following a swinging heading is the longest manoeuvre.
    manoeuvres = BEAVIS_MANOEUVRES[:2] if request.quick else BEAVIS_MANOEUVRES
    rate_pairs = [
        (name, each)
        for name in (COMPARED_ENTRIES if request.quick else JUDGED)
        for each in manoeuvres
    ]
    flights = fly_entries(rate_pairs, request.seeds if request.quick else RATE_SEEDS)
    pairs = rate_pairs
    if not request.quick:
        changed = [(name, each) for name, own in CHANGED.items() for each in own]
        more = fly_entries(changed, request.seeds).flights
        flights = ComparisonFlights([*flights.flights, *more])
        pairs = [*rate_pairs, *changed]
    values: dict[str, MeasuredValue] = {}
    for name, manoeuvre in pairs:
        values[f'{name}_{manoeuvre}_held'] = flights.success_share(name, manoeuvre)
        values[f'{name}_{manoeuvre}_rms'] = flights.metric_value(name, manoeuvre, 'rms')
    values['gtmab_overshoot'] = flights.metric_value('gtmab', 'climb', 'overshoot')
    values['gtmab_settles'] = flights.metric_value('gtmab', 'climb', 'settling_time')
    values |= lift_margins()
    return RowStudyResult(
        values,
        [plot_both_platforms(request, flights, each) for each in manoeuvres],
        draws=draw_gtmab(request, manoeuvres),
    )


def plot_both_platforms(
    request: RowStudyRequest, flights: ComparisonFlights, manoeuvre: str
) -> StudyPicture:
    """Plot both platforms in a manoeuvre, and BEAVIS with a linear B if flown."""
    names = (
        COMPARED_ENTRIES
        if request.quick or manoeuvre == 'follow'
        else (*COMPARED_ENTRIES, 'beavis_by_matrix')
    )
    return StudyPicture(
        manoeuvre, BEAVIS_HEADINGS[manoeuvre], BEAVIS_CAPTIONS[manoeuvre],
        flights.plot_tracking(manoeuvre, names),
        format_lta_command('reproduce', 'beavis'),
    )  # fmt: skip


def lift_margins() -> dict[str, MeasuredValue]:
    """Return the lift at full thrust [N] and its excess over the weight, as mass [kg]."""
    values = {}
    for name in (*COMPARED_ENTRIES, 'beavis'):
        vehicle = build_entrant(load_scene()[0].contestants[name], AIR_DENSITY).vehicle
        lift, weight = compute_lift_margin(vehicle)
        values[f'{name}_lift'] = MeasuredValue(lift)
        values[f'{name}_margin'] = MeasuredValue((lift - weight) / STANDARD_GRAVITY)
    return values

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare closed loop and open-loop baseline, each with both vehicle models."""

from typing import Final

from lta_config.command_line import format_lta_command
from lta_studies.reproduce.manoeuvres import draw_gtmab, fly_entries
from lta_studies.reproduce.study_result import (
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)

LOOP_MANOEUVRES: Final = {
    'gtmab': ('climb', 'cruise'),
    'blimp2b': ('climb', 'cruise'),
    'blimp2b_cascade': ('climb', 'cruise'),
    'gtmab_open_loop': ('climb', 'cruise'),
}
QUICK_PLATFORMS: Final = ('gtmab', 'blimp2b')
LOOP_CAPTIONS: Final = {
    'climb': 'The drone rises by 1.5 m and holds its altitude. Dashed: setpoint; seed 1.',
    'cruise': 'Speed along the course: the drone rises, then flies at 0.5 m/s. '
    'Dashed: setpoint; seed 1.',
}
LOOP_HEADINGS: Final = {'climb': 'Altitude task', 'cruise': 'Velocity task'}


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Fly both models, each in closed and open loop."""
    # --quick leaves out the swapped control laws.
    names = QUICK_PLATFORMS if request.quick else tuple(LOOP_MANOEUVRES)
    pairs = [(name, each) for name in names for each in LOOP_MANOEUVRES[name]]
    flights = fly_entries(pairs, request.seeds)
    values: dict[str, MeasuredValue] = {}
    for name, manoeuvre in pairs:
        values[f'{name}_{manoeuvre}_held'] = flights.success_share(name, manoeuvre)
        values[f'{name}_{manoeuvre}_overshoot'] = flights.metric_value(
            name, manoeuvre, 'overshoot'
        )
        values[f'{name}_{manoeuvre}_rms'] = flights.metric_value(name, manoeuvre, 'rms')
    for name in names:
        values[f'{name}_climb_settles'] = flights.metric_value(name, 'climb', 'settling_time')
        values[f'{name}_cruise_ripple'] = flights.metric_value(name, 'cruise', 'ripple')
    pictures = [
        StudyPicture(each, LOOP_HEADINGS[each], LOOP_CAPTIONS[each], flights.plot_tracking(each,
                     names),
                     format_lta_command('reproduce', 'closed_loop'))
        for each in LOOP_CAPTIONS
    ]  # fmt: skip
    return RowStudyResult(values, pictures, draws=draw_gtmab(request, ('climb', 'cruise')))

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Study panel mounts, and the effect of the height of the centre of gravity."""

import math
from typing import Final

from lta_config.command_line import format_lta_command
from lta_config.files import find_file, load_yaml
from lta_config.parameter_override import draw_content
from lta_studies.energy.mounting.report import (
    build_comparison_tables,
    draw_light_shares,
    draw_overturning,
    draw_straight_flights,
    draw_swings,
    LIGHT_CAPTION,
    OVERTURNING_CAPTION,
    STRAIGHT_CAPTION,
    SWING_CAPTION,
)
from lta_studies.energy.mounting.run import (
    compare_mounts,
    MountingStudy,
    MountVariants,
)
from lta_studies.energy.mounting.straight_flight import average_over_seeds
from lta_studies.reproduce.study_result import (
    collect_draws,
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
    yes_no_value,
)
import numpy as np

MOUNTS: Final = ('side', 'bottom', 'top')
PANEL_DISPLACEMENT: Final = 0.03  # m, misplacement of the panels along the hull


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Fly each mount straight ahead, and release the hull with three heights of the weight."""
    order = MountVariants(
        load_yaml(find_file('vehicle', 'gtmab')), MOUNTS, PANEL_DISPLACEMENT, request.seeds
    )
    comparison = compare_mounts(order)
    values = {**measure_mounts(comparison, request.seeds), **measure_tilt_by_height(comparison)}
    command = format_lta_command('reproduce', 'mounting')
    pictures = [
        StudyPicture('straight', 'Straight flight at 0.1 m/s', STRAIGHT_CAPTION,
                     draw_straight_flights(comparison), command),
        StudyPicture('light', 'Light on the panels', LIGHT_CAPTION, draw_light_shares(comparison),
                     command),
        StudyPicture('over', 'Centre of gravity below, at and above the hull centre',
                     OVERTURNING_CAPTION, draw_overturning(comparison), command),
        StudyPicture('swing', 'Swing after a release', SWING_CAPTION, draw_swings(comparison),
                     command),
    ]  # fmt: skip
    draws = collect_draws(request, measure_draw)
    return RowStudyResult(values, pictures, build_comparison_tables(comparison), draws)


def measure_draw(seed: int) -> dict[str, float | str]:
    """Return the measures of a draw of what is assumed in the vehicle."""
    content = draw_content(load_yaml(find_file('vehicle', 'gtmab')), seed, 'vehicle')
    comparison = compare_mounts(MountVariants(content, MOUNTS, PANEL_DISPLACEMENT, 1, seed))
    values = {**measure_mounts(comparison, 1), **measure_tilt_by_height(comparison)}
    return {name: each.value for name, each in values.items()}


def measure_mounts(comparison: MountingStudy, seeds: int) -> dict[str, MeasuredValue]:
    """Return the swing and the spare lift of each mount."""
    values: dict[str, MeasuredValue] = {}
    for name, each in comparison.shared.items():
        spread = average_over_seeds(each.flights, 'amplitude')
        # One seed has no spread.
        off = spread.deviation if seeds > 1 else math.nan
        ends = (spread.mean - off, spread.mean + off)
        values[f'{name}_swing'] = MeasuredValue(spread.mean, *ends, seeds)
        values[f'{name}_rms'] = MeasuredValue(
            average_over_seeds(each.flights, 'rms').mean, seeds=seeds
        )
        values[f'{name}_spare'] = MeasuredValue(-comparison.lacking[name])
    # A drawn hull may be too small for any mount
    own = comparison.own.get('side', comparison.shared['side'])
    values['side_out_of_place'] = MeasuredValue(own.misplacement)
    values['side_misplaced_swing'] = MeasuredValue(
        average_over_seeds(comparison.misplaced['side'].flights, 'swing').mean
    )
    rms = {name: values[f'{name}_rms'].value for name in MOUNTS}
    assert not any(isinstance(each, str) for each in rms.values())
    values['bottom_by_side'] = MeasuredValue(
        float(rms['bottom']) / float(rms['side']), seeds=seeds
    )
    values['top_by_bottom'] = MeasuredValue(float(rms['top']) / float(rms['bottom']), seeds=seeds)
    return values


def measure_tilt_by_height(comparison: MountingStudy) -> dict[str, MeasuredValue]:
    """Return how a tilt develops with the centre of gravity below, at and above the centre."""
    below, at, above = comparison.overturning
    last = float(at.release.tilt[-1]) / float(at.release.tilt[0])
    return {
        'below_restores': yes_no_value(
            # Restored: the hull swings through upright to the other side.
            bool(np.any(below.release.tilt < 0.0)) and not below.release.overturn_time
        ),
        'coincident_restores': yes_no_value(bool(np.any(at.release.tilt < 0.0))),
        'coincident_left': MeasuredValue(last),
        'above_flips': yes_no_value(above.release.overturn_time is not None),
        'above_turned': MeasuredValue(
            float('nan') if above.release.overturn_time is None else above.release.overturn_time
        ),
    }

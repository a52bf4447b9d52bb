"""Repeat the paper's study of the number of photodiodes, and find the causes of its errors."""

from collections.abc import Mapping, Sequence
import math
from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_report.drawing import create_figure
from lta_report.palette import GRID, SOFT
from lta_studies.light.bearing.bench import BearingBench
from lta_studies.light.bearing.places import build_flight_spec, DIODES, PLACES
from lta_studies.light.bearing.study import (
    count_accurate_directions,
    COUNTS,
    DIRECTIONS,
    list_directions,
    READINGS,
    RingStudy,
    study_ring,
)
from lta_studies.light.bearing.study_report import COLOURS, METHOD
from lta_studies.reproduce.study_result import (
    average_over_seeds,
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)
import numpy as np
from plotly.graph_objects import Figure, Scatterpolar

QUICK: Final = 10  # readings per direction with --quick
GOOD: Final = math.radians(2.0)
DARK_WALLS: Final = {'scenario.room.albedo': 0.0}
NARROW: Final = {f'{DIODES}.response': {'value': 2.0, 'unit': '1', 'source': 'ablation'}}
UNEQUAL: Final = {f'{DIODES}.gain_spread': {'value': 10, 'unit': '%', 'source': 'ablation'}}


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Study both places; each seed is one vehicle with its own diode gains."""
    found = {
        place: {count: study_rings(request, place, count) for count in COUNTS} for place in PLACES
    }
    indoor, outdoor = found['indoor'], found['outdoor']
    values: dict[str, MeasuredValue] = {}
    for place, by_count in found.items():
        for count, each in by_count.items():
            values |= measure_errors(f'{place}_{count}', each)
    for count in COUNTS:
        values[f'outdoor_by_indoor_{count}'] = compare_rings(
            outdoor[count], indoor[count], np.median
        )
    values['outdoor_eight_by_sixteen'] = compare_rings(outdoor[8], outdoor[16], np.median)
    values['worst_outdoor_by_indoor_4'] = compare_rings(outdoor[4], indoor[4], np.max)
    values['indoor_16_below_2'] = count_low_error_directions(indoor[16], 2.0)
    values['indoor_8_below_4'] = count_low_error_directions(indoor[8], 4.0)
    values['indoor_8_below_8'] = count_low_error_directions(indoor[8], 8.0)
    values['indoor_4_below_10'] = count_low_error_directions(indoor[4], 10.0)
    values['four_good_midway'] = average_over_seeds([midway_share(ring) for ring in indoor[4]])
    values['sixteen_worst_dark_walls'] = worst_error(
        study_rings(request, 'indoor', 16, DARK_WALLS)
    )
    values['four_worst_narrow'] = worst_error(study_rings(request, 'indoor', 4, NARROW))
    values['eight_worst_unequal'] = worst_error(study_rings(request, 'indoor', 8, UNEQUAL))
    command = format_lta_command('light', 'study')
    pictures = [
        StudyPicture(place, f'{place.capitalize()}: {PLACES[place].about}',
                'Median bearing error as the radius [°], by direction of the lamp. Seed '
                f'1. {METHOD}',
                plot_polar_errors({count: each[0] for count, each in by_count.items()}), command)
        for place, by_count in found.items()
    ]  # fmt: skip
    return RowStudyResult(values, pictures)


def study_rings(
    request: RowStudyRequest, place: str, count: int, changes: Mapping[str, Any] | None = None
) -> list[RingStudy]:
    """Study one ring in one place for each seed, with optional changes."""
    bench = BearingBench(
        build_flight_spec(PLACES[place], 'gtmab', count).with_values(changes or {})
    )
    readings = QUICK if request.quick else READINGS
    return [
        study_ring(bench, place, count, readings, seed, lambda: None)
        for seed in range(1, request.seeds + 1)
    ]


def measure_errors(name: str, studies: Sequence[RingStudy]) -> dict[str, MeasuredValue]:
    """Return the median error over the directions and the worst one."""
    return {
        f'{name}_median': average_over_seeds([float(np.median(ring.paper)) for ring in studies]),
        f'{name}_worst': worst_error(studies),
    }


def count_low_error_directions(studies: Sequence[RingStudy], degrees: float) -> MeasuredValue:
    """Return the number of directions with an error below a limit."""
    return average_over_seeds(
        [count_accurate_directions(ring.paper, math.radians(degrees)) for ring in studies]
    )


def worst_error(studies: Sequence[RingStudy]) -> MeasuredValue:
    """Return the error in the worst direction. [rad]"""
    return average_over_seeds([max(ring.paper) for ring in studies])


def compare_rings(
    above: Sequence[RingStudy],
    below: Sequence[RingStudy],
    what: Any,  # noqa: ANN401
) -> MeasuredValue:
    """Return the ratio of a statistic of two rings, paired by seed."""
    return average_over_seeds(
        [float(what(a.paper) / what(b.paper)) for a, b in zip(above, below, strict=True)]
    )


def midway_share(ring: RingStudy) -> float:
    """Return the share of low-error directions that lie midway between two diodes."""
    good = [k for k, error in enumerate(ring.paper) if error < GOOD]
    # Test directions per diode spacing
    step = DIRECTIONS // ring.count
    return sum(k % step == step // 2 for k in good) / len(good) if good else math.nan


def plot_polar_errors(studies: Mapping[int, RingStudy]) -> Figure:
    """Plot the errors by direction as in the paper."""
    figure = create_figure()
    angles = np.degrees([*list_directions(), math.tau])
    for count, ring in studies.items():
        # The first direction again closes the curve.
        errors = np.degrees([*ring.paper, ring.paper[0]])
        figure.add_trace(
            Scatterpolar(
                theta=angles, r=errors, mode='lines+markers', name=f'{count} diodes',
                line={'color': COLOURS[count], 'width': 1.6}, marker={'size': 5},
                hovertemplate='%{theta}°: %{r:.2f}°',
            )
        )  # fmt: skip
    axis = {'gridcolor': GRID, 'linecolor': GRID, 'tickfont': {'color': SOFT, 'size': 10}}
    return figure.update_layout(
        polar={
            'bgcolor': 'rgba(0,0,0,0)', 'radialaxis': {**axis, 'ticksuffix': '°'},
            'angularaxis': {**axis, 'dtick': 45},
        },
        xaxis={'visible': False}, yaxis={'visible': False}, showlegend=True, hovermode='closest',
        legend={'orientation': 'h', 'y': 1.12}, margin={'l': 40, 'r': 40, 't': 40, 'b': 30},
    )  # fmt: skip

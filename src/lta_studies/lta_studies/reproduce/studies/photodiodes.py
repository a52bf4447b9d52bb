"""How many photodiodes: the paper's study by its own estimator, and what makes its errors."""

from collections.abc import Mapping, Sequence
import math
from typing import Any, Final

from lta_config.typed import typed
from lta_report.drawing import blank
from lta_report.palette import GRID, SOFT
from lta_studies.light.bearing.bench import Bench
from lta_studies.light.bearing.places import DIODES, made_of, PLACES
from lta_studies.light.bearing.study import (
    COUNTS,
    DIRECTIONS,
    directions,
    one_ring,
    READINGS,
    Studied,
    within,
)
from lta_studies.light.bearing.study_page import COLOURS, METHOD
from lta_studies.reproduce.found import Asked, Found, over, Picture, Value
import numpy as np
from plotly.graph_objects import Figure, Scatterpolar

QUICK: Final = 10  # readings
GOOD: Final = math.radians(2.0)
DARK_WALLS: Final = {'scenario.room.albedo': 0.0}
NARROW: Final = {f'{DIODES}.response': {'value': 2.0, 'unit': '1', 'source': 'ablation'}}
UNEQUAL: Final = {f'{DIODES}.gain_spread': {'value': 10, 'unit': '%', 'source': 'ablation'}}


def study(asked: Asked) -> Found:
    """Return the study in both places; one vehicle a seed, its gains drawn once."""
    found = {place: {count: rings(asked, place, count) for count in COUNTS} for place in PLACES}
    indoor, outdoor = found['indoor'], found['outdoor']
    values: dict[str, Value] = {}
    for place, by_count in found.items():
        for count, each in by_count.items():
            values |= figures(f'{place}_{count}', each)
    for count in COUNTS:
        values[f'outdoor_by_indoor_{count}'] = compared(outdoor[count], indoor[count], np.median)
    values['outdoor_eight_by_sixteen'] = compared(outdoor[8], outdoor[16], np.median)
    values['worst_outdoor_by_indoor_4'] = compared(outdoor[4], indoor[4], np.max)
    values['indoor_16_below_2'] = below(indoor[16], 2.0)
    values['indoor_8_below_4'] = below(indoor[8], 4.0)
    values['indoor_8_below_8'] = below(indoor[8], 8.0)
    values['indoor_4_below_10'] = below(indoor[4], 10.0)
    values['four_good_midway'] = over([midway(ring) for ring in indoor[4]])
    values['sixteen_worst_dark_walls'] = worst(rings(asked, 'indoor', 16, DARK_WALLS))
    values['four_worst_narrow'] = worst(rings(asked, 'indoor', 4, NARROW))
    values['eight_worst_unequal'] = worst(rings(asked, 'indoor', 8, UNEQUAL))
    command = typed('light', 'study')
    pictures = [
        Picture(place, f'{place.capitalize()}: {PLACES[place].about}',
                f'Median error by direction, in degrees from the middle; seed 1. {METHOD}',
                polar({count: each[0] for count, each in by_count.items()}), command)
        for place, by_count in found.items()
    ]  # fmt: skip
    return Found(values, pictures)


def rings(
    asked: Asked, place: str, count: int, changes: Mapping[str, Any] | None = None
) -> list[Studied]:
    """Return one ring in one place for each seed, with something changed if there is anything."""
    bench = Bench(made_of(PLACES[place], 'gtmab', count).with_values(changes or {}))
    readings = QUICK if asked.quick else READINGS
    return [
        one_ring(bench, place, count, readings, seed, lambda: None)
        for seed in range(1, asked.seeds + 1)
    ]


def figures(name: str, found: Sequence[Studied]) -> dict[str, Value]:
    """Return the median over the directions and the worst of them."""
    return {
        f'{name}_median': over([float(np.median(ring.paper)) for ring in found]),
        f'{name}_worst': worst(found),
    }


def below(found: Sequence[Studied], degrees: float) -> Value:
    """Return how many directions stay below a limit."""
    return over([within(ring.paper, math.radians(degrees)) for ring in found])


def worst(found: Sequence[Studied]) -> Value:
    """Return the error in the worst direction. [rad]"""
    return over([max(ring.paper) for ring in found])


def compared(above: Sequence[Studied], below: Sequence[Studied], what: Any) -> Value:  # noqa: ANN401
    """Return the ratio of a figure of two rings, seed by seed."""
    return over([float(what(a.paper) / what(b.paper)) for a, b in zip(above, below, strict=True)])


def midway(ring: Studied) -> float:
    """Return how much of the directions with a small error lie midway between two diodes."""
    good = [k for k, error in enumerate(ring.paper) if error < GOOD]
    step = DIRECTIONS // ring.count
    return sum(k % step == step // 2 for k in good) / len(good) if good else math.nan


def polar(found: Mapping[int, Studied]) -> Figure:
    """Return the errors by direction as the paper draws them."""
    figure = blank()
    angles = np.degrees([*directions(), math.tau])
    for count, ring in found.items():
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

"""Build the report on the number of photodiodes."""

from collections.abc import Sequence
import math
from typing import Final

from lta_report.drawing import add_legend, create_figure
from lta_report.formatting import Tile
from lta_report.palette import GOOD, LAMP, TRUTH
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_studies.light.bearing.places import PLACES
from lta_studies.light.bearing.report import format_degrees
from lta_studies.light.bearing.study import (
    count_accurate_directions,
    COUNTS,
    DIRECTIONS,
    DISTANCE,
    judge_claims,
    list_directions,
    RingStudy,
)
import numpy as np
from plotly.graph_objects import Figure, Scatter

COLOURS: Final = dict(zip(COUNTS, (LAMP, TRUTH, GOOD), strict=True))
HEADS: Final = (
    'place', 'diodes', 'SNR', 'paper: median [°]', 'worst [°]', 'below 2°', 'fit: median [°]',
    'worst [°]', 'below 2°',
)  # fmt: skip
CAPTION: Final = (
    'Median bearing error in each of 16 directions. Full lines: our fit. Dotted: the '
    'weighted mean of the paper.'
)
DEFECT: Final = (
    "What the paper's explanation leaves open: with ideal cosine diodes, its weighted mean "
    'is exact for 4, 8 and 16 diodes at every angle. With equal diodes of any response, a '
    'ring of eight is exact at all 16 test angles. So the printed errors need a response '
    'other than a cosine, unequal gains and reflections, which are all simulated here. '
    "Steady sunlight adds only noise at the lamp's frequency. Outdoors can be better than "
    'indoors because only the ground reflects.'
)
METHOD: Final = (
    'The hull is level at 0.5 m and turns through 16 directions. The diode gains of the vehicle '
    'are drawn once. Errors are medians over the readings; each reading is one block of ADC '
    'samples with its own noise.'
)


def describe_method(aside: float) -> str:
    """Describe the set-up, with the drone `aside` of the lamp's axis. [rad]"""
    where = f'{math.degrees(aside):g} degrees off its axis' if aside else 'on its axis'
    return f'The lamp is {DISTANCE:g} m away and the drone is {where}. {METHOD}'


def build_report(
    studies: Sequence[RingStudy], vehicle: str, readings: int, seed: int, aside: float
) -> Report:
    """Return the report of a study of all rings, `aside` of the lamp's axis. [rad]"""
    # The headline uses the paper's main setup
    eight = next(each for each in studies if (each.place, each.count) == ('indoor', 8))
    return Report(
        command='light study',
        subject='number of photodiodes',
        headline=f'Indoors with eight diodes, {format_median_errors(eight)}.',
        introduction=f'{DIRECTIONS} directions to the lamp, {readings} readings in each.',
        tiles=build_tiles(studies),
        blocks=(
            *(
                Picture(
                    place, f'{place.capitalize()}: {PLACES[place].about}', CAPTION,
                    plot_errors(studies, place), height=420,
                )
                for place in PLACES
            ),
            build_ring_table(studies),
            build_claim_table(judge_claims(studies)),
            TextSection('Method', (describe_method(aside), DEFECT)),
        ),
        data={
            'vehicle': vehicle, 'readings': readings, 'seed': seed, 'aside': aside,
            'rings': [each.to_json() for each in studies], 'claims': judge_claims(studies),
        },
        facts={'vehicle': vehicle, 'seed': str(seed)},
        closing=(DEFECT,),
    )  # fmt: skip


def format_median_errors(ring: RingStudy) -> str:
    """Return the part of a headline with the median errors of both estimators."""
    return (
        f'the median bearing error is {format_degrees(median_error(ring.ours))}° for our fit and '
        f'{format_degrees(median_error(ring.paper))}° for the weighted mean of the paper'
    )


def build_claim_table(claims: Sequence[Sequence[str]]) -> TextTable:
    """Return the table of the paper's claims."""
    heads = ('the paper, indoors', 'its estimator', 'the fit')
    return TextTable('Statements of the paper, checked', heads, claims)


def median_error(errors: Sequence[float]) -> float:
    """Return the median over the directions; NaN if one has no bearing."""
    return float(np.median(errors))


def build_ring_table(studies: Sequence[RingStudy]) -> TextTable:
    """Return the table of errors over all directions."""
    rows = []
    for each in studies:
        cells = [each.place, str(each.count), f'{each.snr:.0f}']
        for errors in (each.paper, each.ours):
            below = f'{count_accurate_directions(errors, math.radians(2.0))} of {DIRECTIONS}'
            cells += [format_degrees(median_error(errors)), format_degrees(max(errors)), below]
        rows.append(cells)
    return TextTable(f'Bearing errors over {DIRECTIONS} directions', HEADS, rows)


def build_tiles(studies: Sequence[RingStudy]) -> list[Tile]:
    """Return tiles with the worst direction of the fit for each ring."""
    return [
        Tile(
            f'{each.place}, {each.count} diodes', format_degrees(max(each.ours)), '°',
            f'worst direction; paper {format_degrees(max(each.paper))}°',
        )
        for each in studies
    ]  # fmt: skip


def plot_errors(studies: Sequence[RingStudy], place: str) -> Figure:
    """Plot the error by direction for each ring."""
    figure = create_figure()
    angles = np.degrees(list_directions())
    for each in studies:
        if each.place != place:
            continue
        for name, errors, dash in (('paper', each.paper, '2px,3px'), ('fit', each.ours, 'solid')):
            figure.add_trace(
                Scatter(
                    x=angles, y=np.degrees(errors), mode='lines+markers',
                    name=f'{each.count} diodes, {name}', marker={'size': 5},
                    line={'color': COLOURS[each.count], 'width': 1.4, 'dash': dash},
                    hovertemplate='%{y:.2f}°',
                )
            )  # fmt: skip
    figure.update_xaxes(title_text='direction of the lamp, seen from the ring [°]', dtick=45)
    figure.update_yaxes(title_text='median error [°]', rangemode='tozero')
    return add_legend(figure)

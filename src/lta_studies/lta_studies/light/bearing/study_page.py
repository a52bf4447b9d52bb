"""Write the study of the number of photodiodes as one self-contained HTML page."""

from collections.abc import Sequence
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_config.command_line import format_lta_command
from lta_report.drawing import create_figure
from lta_report.formatting import Tile
from lta_report.html_elements import render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_report.palette import GOOD, LAMP, TRUTH
from lta_studies.light.bearing.page import format_degrees, render_table
from lta_studies.light.bearing.places import PLACES
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
HEAD: Final = (
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
    f"The lamp is {DISTANCE:g} m away and the drone is 45 degrees off the lamp's axis. The "
    'hull is level at 0.5 m and turns through 16 directions. The diode gains of the vehicle '
    'are drawn once. Errors are medians over the readings; each reading is one block of ADC '
    'samples with its own noise.'
)


def write_page(
    studies: Sequence[RingStudy], vehicle: str, readings: int, seed: int, out: Path
) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    # The headline uses the paper's main setup.
    eight = next(each for each in studies if (each.place, each.count) == ('indoor', 8))
    pictures = [
        render_section(
            place,
            f'{place.capitalize()}: {PLACES[place].about}',
            CAPTION,
            plot_errors(studies, place),
        )
        for place in PLACES
    ]
    return write_file(
        assemble_page(
            'study.html',
            title=escape(
                'Indoors with eight diodes, the median bearing error is '
                f'{format_degrees(median_error(eight.ours))}° for our fit and '
                f'{format_degrees(median_error(eight.paper))}° for the weighted mean of the '
                'paper.'
            ),
            kicker='light · study of the number of photodiodes',
            about=escape(f'{DIRECTIONS} directions to the lamp, {readings} readings in each.'),
            tiles='\n'.join(render_tile(*each) for each in build_tiles(studies)),
            table=render_table(build_ring_rows(studies)),
            claims=render_table(build_claim_rows(studies)),
            notes=''.join(f'<p class="note">{escape(each)}</p>' for each in (METHOD, DEFECT)),
            pictures='\n'.join(pictures),
            facts={'vehicle': vehicle, 'seed': str(seed), 'commit': read_commit()},
            commands={
                'Repeat the study': format_lta_command(
                    'light', 'study', '--vehicle', vehicle, '--readings', str(readings),
                    '--seed', str(seed),
                )
            },
        ),
        out,
    )  # fmt: skip


def build_claim_rows(studies: Sequence[RingStudy]) -> list[tuple[str, str, str]]:
    """Return the table of claims; the first row is the head."""
    return [('the paper, indoors', 'its estimator', 'the fit'), *judge_claims(studies)]


def median_error(errors: Sequence[float]) -> float:
    """Return the median over the directions; NaN if one has no bearing."""
    return float(np.median(errors))


def build_ring_rows(studies: Sequence[RingStudy]) -> list[tuple[str, ...]]:
    """Return the table as text; the first row is the head."""
    rows: list[tuple[str, ...]] = [HEAD]
    for each in studies:
        cells = [each.place, str(each.count), f'{each.snr:.0f}']
        for errors in (each.paper, each.ours):
            below = f'{count_accurate_directions(errors, math.radians(2.0))} of {DIRECTIONS}'
            cells += [format_degrees(median_error(errors)), format_degrees(max(errors)), below]
        rows.append(tuple(cells))
    return rows


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
    return figure.update_layout(showlegend=True, legend={'orientation': 'h', 'y': 1.12})

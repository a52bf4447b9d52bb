# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draw a discovery: errors of forecasts, and the force that stays unexplained."""

from collections.abc import Iterator
from html import escape
import math
from textwrap import wrap
from typing import Final

from lta_discovery.calibration.calibrated_file import CALIBRATED_FILE
from lta_discovery.discovery.conclusion import Conclusion
from lta_discovery.discovery.forecast_comparison import ForecastComparison
from lta_discovery.discovery.study import CLOSEST, Discovery, NAMED, TUNED
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.forecast_blocks import COLOURS, draw_errors_along
from lta_discovery.formatting import format_error
from lta_discovery.state_filter.forecast_scores import FILE_MODEL
from lta_model.effects.protocol import AXES
from lta_report.drawing import add_legend, create_figure
from lta_report.palette import ESTIMATE, TRUTH
from lta_report.report import Block, Picture, ReportSection
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SAMPLE_STRIDE: Final = 5  # grid points from one drawn sample to the next, 0.2 s
PICTURE: Final = 'picture.svg'
FIGURE_WIDTH: Final = 760  # px
LEFT: Final = 190  # px; where bars begin
LONGEST_BAR: Final = 460  # px
ROW_HEIGHT: Final = 34  # px
LINE: Final = 26  # px; of the headline
LONGEST_LINE: Final = 76  # characters
TOP: Final = 66  # px; of the first bar, below the headline
SHORTEST_BAR: Final = 6  # px
# Readable on light and dark pages alike
FIGURE_STYLE: Final = (
    'text{font-family:system-ui,sans-serif;fill:#57606e}'
    '.head{font-size:19px;font-weight:600;fill:#c8500a}.note{font-size:13px}.bar{font-size:15px}'
)


def build_pictures(study: Discovery) -> Iterator[Block]:
    """Yield forecasts along the first judged flight, and what stays unexplained in each flight."""
    comparison = study.comparison
    if comparison.scores:
        best = (NAMED, CLOSEST, CALIBRATED_FILE, TUNED)
        last = next(name for name in best if name in comparison.forecasts)
        horizon = comparison.main.horizon if comparison.main else comparison.scores[0].horizon
        models = {name: comparison.forecasts[name][0] for name in (FILE_MODEL, last)}
        yield draw_errors_along(comparison.names[0], models, horizon)
    wrenches = [
        _draw_wrench(
            f'wrench_{k}',
            name,
            study.flights[name][1],
            {
                TUNED: study.missing.bare.wrenches[k],
                NAMED if study.named else TUNED: study.missing.found.wrenches[k],
            },
        )
        for k, name in enumerate(study.learned_from)
    ]
    yield wrenches[0]
    if wrenches[1:]:
        yield ReportSection('Unexplained force in the other flights', wrenches[1:], folded=True)


def _draw_wrench(
    title: str, name: str, flight: MeasuredFlight, wrenches: dict[str, Array]
) -> Picture:
    """Return the force and moment that a model leaves unexplained in a flight."""
    figure = add_legend(create_figure(len(AXES)))
    thin = slice(None, None, SAMPLE_STRIDE)
    for row, axis in enumerate(AXES, start=1):
        for model, wrench in wrenches.items():
            figure.add_scatter(
                x=flight.time[thin], y=1e3 * wrench[thin, row - 1], name=model,
                line={'color': ESTIMATE if model == TUNED else TRUTH}, legendgroup=model,
                showlegend=row == 1, row=row, col=1,
            )  # fmt: skip
        unit = 'mN' if row < 4 else 'mN m'
        figure.update_yaxes(
            title=f'{axis} [{unit}]', title_standoff=6, automargin=True, nticks=4, row=row, col=1,
        )  # fmt: skip
    figure.update_xaxes(title='time [s]', row=6, col=1)
    caption = (
        f'{name}: force and moment that the model of the vehicle does not explain, as the '
        'smoother estimates them from all readings.'
    )
    return Picture(title, 'Where the model is off', caption, figure, height=840)


def draw_picture(conclusion: Conclusion, comparison: ForecastComparison) -> str:
    """
    Return the picture; '' where no flight is long enough for a forecast.

    The length of a bar goes with the logarithm of the position error.
    """
    scores = comparison.scores
    if not scores:
        return ''
    far = scores[-1]
    sizes = {name: one.position for name, one in far.errors.items() if math.isfinite(one.position)}
    least, most = 0.5 * min(sizes.values()), max(sizes.values())
    span = max(math.log(most / least), 1e-9)
    head = wrap(conclusion.headline, LONGEST_LINE)
    top = TOP + LINE * len(head)
    rows = [
        f'<text class="head" x="20" y="{36 + LINE * k}">{escape(line)}</text>'
        for k, line in enumerate(head)
    ]
    for k, (name, size) in enumerate(sorted(sizes.items(), key=lambda one: -one[1])):
        y, share = top + k * ROW_HEIGHT, math.log(size / least) / span
        length = max(share * LONGEST_BAR, SHORTEST_BAR)
        rows.append(
            f'<text class="bar" x="{LEFT - 12}" y="{y + 16}" text-anchor="end">{escape(name)}'
            f'</text><rect x="{LEFT}" y="{y}" width="{length:.0f}" height="22" rx="4" '
            f'fill="{COLOURS[name]}"/><text class="bar" x="{LEFT + length + 8:.0f}" '
            f'y="{y + 16}">{format_error(size)}</text>'
        )
    height = top + len(sizes) * ROW_HEIGHT + 10
    note = (
        f'Position error {far.horizon:g} s ahead, RMS of {far.forecasts} forecasts of '
        f'{", ".join(comparison.names)}; logarithmic.'
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {FIGURE_WIDTH} {height}" role="img"'
        f' aria-label="{escape(conclusion.headline)}"><style>{FIGURE_STYLE}</style>'
        f'<text class="note" x="20" y="{top - 30}">{escape(note)}</text>{"".join(rows)}</svg>\n'
    )

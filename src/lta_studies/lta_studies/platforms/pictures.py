"""Plot a platform comparison: tracking and speed limits."""

from collections.abc import Mapping, Sequence
import math
from typing import Final

from lta_config.schema.comparison_file import ComparisonFile, ManeuverFile
from lta_report.drawing import build_line_trace, create_figure, EndLabel, label_ends, padded_range
from lta_report.palette import ESTIMATE, GOOD, LAMP, RAW, SETPOINT, SOFT, STRENGTH, TIME, TRUTH
from lta_studies.platforms.flight import COLUMN
from lta_studies.platforms.run import ABLATION, CONTESTANT, LIMIT, PlatformResult
from lta_studies.platforms.summary import select_flights
import numpy as np
from plotly.graph_objects import Figure, Scatter

COLOURS: Final = (
    TRUTH, ESTIMATE, GOOD, LAMP, TIME[0], TIME[2], SOFT, STRENGTH[1], STRENGTH[3], TIME[3], RAW,
)  # fmt: skip
UNIT: Final = {'altitude': 'm', 'heading': '\N{DEGREE SIGN}', 'speed': 'm/s'}
WORDS: Final = {'altitude': 'rise', 'heading': 'heading', 'speed': 'speed along the course'}


def draw_tracking(
    rows: Sequence[PlatformResult],
    titles: Mapping[str, str],
    manoeuvre: ManeuverFile,
    kind: str = CONTESTANT,
) -> Figure:
    """Plot setpoint and response of each entry in a manoeuvre, for seed 1."""
    figure, labels, lines = create_figure(), [], []
    column = COLUMN[manoeuvre.judge]
    selected = [
        row for row in rows
        if row.job.kind == kind and row.job.name in titles and row.flown is not None
        and row.job.manoeuvre == manoeuvre.name
    ]  # fmt: skip
    for index, row in enumerate(selected):
        values = scale_column(manoeuvre, row.flown, row.flown[0, column], column)
        lines.append(values)
        if index == 0:
            setpoint = scale_column(manoeuvre, row.asked, row.asked[0, column], column)
            lines.append(setpoint)
            figure.add_trace(
                build_line_trace('setpoint', row.asked[:, 0], setpoint, SETPOINT,
                unit=UNIT[manoeuvre.judge],
                     dash='4px,3px', steps=manoeuvre.between == 'step')
            )  # fmt: skip
        # Index into all titles, so that an entry has the same colour in every plot.
        colour = COLOURS[list(titles).index(row.job.name) % len(COLOURS)]
        title = titles[row.job.name]
        figure.add_trace(
            build_line_trace(title, row.flown[:, 0], values, colour, unit=UNIT[manoeuvre.judge])
        )
        labels.append(EndLabel(title, float(values[-1]), colour))
    if not selected:
        return figure
    label_ends(figure, labels, padded_range(*lines))
    figure.update_layout(margin={'r': 150})
    figure.update_xaxes(title_text='time [s]')
    return figure.update_yaxes(title_text=f'{WORDS[manoeuvre.judge]} [{UNIT[manoeuvre.judge]}]')


def scale_column(
    manoeuvre: ManeuverFile, table: np.ndarray, first: float, column: int
) -> np.ndarray:
    """Return a column in display units: rise [m], heading [deg] or speed [m/s]."""
    values = table[:, column].astype(np.float64)
    if manoeuvre.judge == 'altitude':
        return values - float(first)
    return values * (180.0 / math.pi) if manoeuvre.judge == 'heading' else values


def format_entry_name(comparison: ComparisonFile, name: str) -> str:
    """Return the title of an ablation or limit: 'beavis_neutral' -> 'BEAVIS neutral'."""
    first, _, rest = name.partition('_')
    contestant = comparison.contestants.get(first)
    platform = contestant.title.split()[0] if contestant else first
    return f'{platform} {rest.replace("_", " ")}'.strip()


def draw_ablations(
    rows: Sequence[PlatformResult], comparison: ComparisonFile, manoeuvre: ManeuverFile
) -> Figure:
    """Plot the ablations in a manoeuvre, for seed 1."""
    titles = {name: format_entry_name(comparison, name) for name in comparison.ablations}
    return draw_tracking(rows, titles, manoeuvre, ABLATION)


def draw_limits(rows: Sequence[PlatformResult], comparison: ComparisonFile) -> Figure:
    """Plot the speed reached and the height gained against the commanded speed."""
    figure = create_figure(2, [0.6, 0.4])
    top = most = 0.0
    labels = []
    for index, (name, limit) in enumerate(comparison.limits.items()):
        colour = COLOURS[index % len(COLOURS)]
        commanded = list(limit.speeds.vector)
        most = max(most, commanded[-1])
        cells = [select_flights(rows, LIMIT, name, limit.manoeuvre, speed) for speed in commanded]
        reached = [part.final_speed.value for part in cells]
        lost = [part.mean_metric('steady_error', 'height').value for part in cells]
        # The speed reached is NaN if no flight was recorded.
        top = max(top, commanded[-1], *(value for value in reached if math.isfinite(value)))
        spread = [part.final_speed.high - part.final_speed.value for part in cells]
        title = format_entry_name(comparison, name)
        mode = {'mode': 'lines+markers', 'line': {'color': colour, 'width': 1.4}, 'name': title}
        figure.add_trace(
            Scatter(x=commanded, y=reached, error_y={'type': 'data', 'array': spread, 'width': 3},
                    hovertemplate='%{y:.3f} m/s', **mode),
            row=1, col=1,
        )  # fmt: skip
        figure.add_trace(
            # Steady error is setpoint - response, so its negative is the height gained.
            Scatter(x=commanded, y=[-value for value in lost], hovertemplate='%{y:.3f} m', **mode),
            row=2, col=1,
        )  # fmt: skip
        labels.append(EndLabel(title, reached[-1], colour))
    figure.add_trace(
        Scatter(x=[0.4, most], y=[0.4, most], mode='lines', name='commanded', hoverinfo='skip',
                line={'color': SETPOINT, 'width': 1.2, 'dash': '4px,3px'}),
        row=1, col=1,
    )  # fmt: skip
    label_ends(figure, labels, (0.35, 1.04 * max(top, 0.5)))
    figure.update_layout(margin={'r': 150})
    figure.update_yaxes(title_text='speed reached [m/s]', row=1)
    figure.update_yaxes(title_text='height gained [m]', row=2)
    return figure.update_xaxes(title_text='commanded speed [m/s]', row=2)

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Summarize and plot the flights of a comparison: means over seeds, ablations, top speeds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any, Final, final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.schema.comparison_file import ComparisonFile, ManeuverFile
from lta_flight.sweep.statistics import (
    MeanInterval,
    ShareInterval,
    student_interval,
    wilson_interval,
)
from lta_model.propulsion import select_lifting_rotors
from lta_model.vehicle import Vehicle
from lta_report.charts import ChartAxis, Curve, DASHED, draw_curves
from lta_report.drawing import create_figure, decimate_line, EndLabel, label_ends
from lta_report.palette import ESTIMATE, GOOD, LAMP, RAW, SETPOINT, SOFT, STRENGTH, TIME, TRUTH
from lta_studies.platforms.flight import COLUMN_OF_SIGNAL
from lta_studies.platforms.run import ABLATION, CONTESTANT, LIMIT, PlatformResult
import numpy as np
from plotly.graph_objects import Figure, Scatter


@final
@dataclass(frozen=True, slots=True)
class ComparisonCell:
    """All seeds of one entry in one manoeuvre."""

    rows: list[PlatformResult]

    @property
    def success_share(self) -> ShareInterval:
        """Share of the flights that held the manoeuvre."""
        return wilson_interval(sum(row.held for row in self.rows), len(self.rows))

    def mean_metric(self, name: str, of: str = 'metrics') -> MeanInterval:
        """Return the mean of one metric over the seeds where it is finite."""
        values = [getattr(getattr(row, of), name) for row in self.rows]
        return student_interval([value for value in values if math.isfinite(value)])

    @property
    def final_speed(self) -> MeanInterval:
        """Speed reached at the end. [m/s]."""
        return student_interval([row.speed for row in self.rows if math.isfinite(row.speed)])


def select_flights(
    rows: Sequence[PlatformResult],
    kind: str,
    name: str,
    manoeuvre: str,
    speed: float | None = None,
) -> ComparisonCell:
    """Return the flights of an entry in a manoeuvre."""
    return ComparisonCell(
        [
            row for row in rows
            if (row.job.kind, row.job.name, row.job.manoeuvre, row.job.speed)
            == (kind, name, manoeuvre, speed)
        ]
    )  # fmt: skip


def find_top_speed(
    comparison: ComparisonFile, rows: Sequence[PlatformResult], name: str
) -> tuple[float, float]:
    """Return the commanded speed up to which all flights held, and the top speed."""
    limit = comparison.limits[name]
    held, reached = 0.0, 0.0
    unbroken = True
    for speed in limit.speeds.vector:
        flights = select_flights(rows, LIMIT, name, limit.manoeuvre, speed)
        # A speed held above one that failed does not count: the range must be continuous.
        unbroken = unbroken and bool(flights.rows) and all(row.held for row in flights.rows)
        held = speed if unbroken else held
        reached = max(reached, flights.final_speed.value)
    return held, reached


def compute_lift_margin(vehicle: Vehicle) -> tuple[float, float]:
    """Return the lift at full thrust and the weight it must carry [N]."""
    own, per_newton = select_lifting_rotors(vehicle.rotors, vehicle.file.aero.coupling)
    # The lifting rotors share the load, so the weakest limits all.
    full = min((rotor.full_thrust for rotor in own), default=0.0)
    return full * per_newton, vehicle.heaviness * STANDARD_GRAVITY


PLATFORM_COLOURS: Final = (
    TRUTH, ESTIMATE, GOOD, LAMP, TIME[0], TIME[2], SOFT, STRENGTH[1], STRENGTH[3], TIME[3], RAW,
)  # fmt: skip
SIGNAL_UNITS: Final = {'altitude': 'm', 'heading': '\N{DEGREE SIGN}', 'speed': 'm/s'}
SIGNAL_WORDS: Final = {'altitude': 'rise', 'heading': 'heading', 'speed': 'speed along the course'}


def draw_tracking(
    rows: Sequence[PlatformResult],
    titles: Mapping[str, str],
    manoeuvre: ManeuverFile,
    kind: str = CONTESTANT,
) -> Figure:
    """Plot setpoint and response of each entry in a manoeuvre, for seed 1."""
    column, unit = COLUMN_OF_SIGNAL[manoeuvre.judge], SIGNAL_UNITS[manoeuvre.judge]
    selected = [
        row for row in rows
        if row.job.kind == kind and row.job.name in titles and row.flown is not None
        and row.job.manoeuvre == manoeuvre.name
    ]  # fmt: skip
    if not selected:
        return create_figure()

    def plot(name: str, table: np.ndarray, colour: str, **look: Any) -> Curve:
        values = scale_column(manoeuvre, table, table[0, column], column)
        line = decimate_line(table[:, 0], values)
        return Curve(name, *line, colour, f'%{{y:.3~f}} {unit}', **look)

    shape = {'line_shape': 'hv' if manoeuvre.between == 'step' else 'linear'}
    curves = [plot('setpoint', selected[0].asked, SETPOINT, dash=DASHED, more=shape)]
    for row in selected:
        # Index into all titles, so that an entry has the same colour in every plot.
        colour = PLATFORM_COLOURS[list(titles).index(row.job.name) % len(PLATFORM_COLOURS)]
        title = titles[row.job.name]
        curves.append(plot(title, row.flown, colour, label=title))
    axis = ChartAxis(f'{SIGNAL_WORDS[manoeuvre.judge]} [{unit}]')
    return draw_curves(curves, ChartAxis('time [s]'), axis).update_layout(margin={'r': 150})


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
        colour = PLATFORM_COLOURS[index % len(PLATFORM_COLOURS)]
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

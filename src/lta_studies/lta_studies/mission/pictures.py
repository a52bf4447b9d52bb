# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plot a mission: charge and light, timeline, minutes flown by the hour, and energy."""

from collections.abc import Sequence

from lta_energy.irradiance import IrradianceSeries, MINUTE
from lta_energy.mission import ALOFT, ASLEEP, AWAY, EMPTY, PERCHED
from lta_report.charts import add_level, Curve, draw_bars, item_colour, Level
from lta_report.drawing import add_legend, create_figure
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, SOFT, TRUTH
from lta_studies.mission.flyer import AWARE
from lta_studies.mission.run import flight_minutes_by_hour, MissionResult
import numpy as np
from plotly.graph_objects import Bar, Figure, Scatter

STATE_LOOKS = {
    PERCHED: ('perched, awake', LAMP), ASLEEP: ('asleep', SOFT), ALOFT: ('in flight', TRUTH),
    AWAY: ('waiting to be fetched', ESTIMATE), EMPTY: ('empty', ESTIMATE),
}  # fmt: skip
LIGHT_MINUTES = 5  # minutes per plotted point of the light


def draw_charge(
    results: Sequence[MissionResult], light: IrradianceSeries, reserve: float
) -> Figure:
    """Plot the light and the state of charge of each schedule for one seed."""
    figure = create_figure(2, (0.36, 0.64))
    lux = light.illuminance()
    # Each value is the mean of one minute, plotted at its middle.
    hours = (np.arange(len(lux)) + 0.5) * MINUTE / 3600.0
    steps = {'line_shape': 'hv', 'showlegend': True}
    above = Curve('light', hours[::LIGHT_MINUTES], lux[::LIGHT_MINUTES] / 1e3, LAMP,
                  '%{y:.1f} klx', width=1.2,
                  more=steps)  # fmt: skip
    figure.add_trace(above.to_trace(), row=1, col=1)
    for k, result in enumerate(results):
        time, charge = np.array(result.diary.time), np.array(result.diary.charge)
        own = Curve(result.schedule, time / 3600.0, 100.0 * charge, item_colour(k), '%{y:.0f} %',
                    width=1.3)  # fmt: skip
        figure.add_trace(own.to_trace(), row=2, col=1)
    add_level(figure, Level(100.0 * reserve, 'reserve', right=True, below=True), row=2)
    figure.update_yaxes(title_text='light [klx]', rangemode='tozero', row=1)
    figure.update_yaxes(title_text='charge [%]', range=[0.0, 102.0], row=2)
    return set_time_axis(figure, light, 2)


def draw_timeline(results: Sequence[MissionResult], light: IrradianceSeries) -> Figure:
    """Plot the state of the drone over time, one row per schedule."""
    figure = create_figure()
    for state, (name, colour) in STATE_LOOKS.items():
        x: list[float | None] = []
        y: list[str | None] = []
        for result in results:
            for begin, end in find_state_intervals(result, state):
                # None breaks the line, so one trace can draw all intervals of a state.
                x += [begin, end, None]
                y += [result.schedule, result.schedule, None]
        if x:
            figure.add_trace(
                Scatter(
                    x=x, y=y, name=name, mode='lines', line={'color': colour, 'width': 22},
                    hovertemplate=name, showlegend=True, connectgaps=False,
                )
            )  # fmt: skip
    # From top to bottom in the order of the other figures
    order = [result.schedule for result in reversed(results)]
    figure.update_yaxes(
        type='category', automargin=True, categoryorder='array', categoryarray=order
    )
    figure.update_layout(hovermode='closest')
    return set_time_axis(figure, light)


def find_state_intervals(result: MissionResult, state: int) -> list[tuple[float, float]]:
    """Return the merged intervals in which a drone was in a state [h]."""
    diary = result.diary
    intervals: list[tuple[float, float]] = []
    for begin, end, own in zip(diary.time[:-1], diary.time[1:], diary.state[:-1], strict=True):
        if own != state:
            continue
        # Adjacent up to rounding (1e-6 h is 4 ms): extend the interval before.
        if intervals and begin / 3600.0 - intervals[-1][1] < 1e-6:
            intervals[-1] = (intervals[-1][0], end / 3600.0)
        else:
            intervals.append((begin / 3600.0, end / 3600.0))
    return intervals


def draw_flight_hours(results: Sequence[MissionResult], light: IrradianceSeries) -> Figure:
    """Plot the minutes flown in each hour."""
    figure = create_figure()
    for k, result in enumerate(results):
        minutes = flight_minutes_by_hour(result.diary, light)
        figure.add_trace(
            Bar(
                x=[hour + 0.5 for hour in range(len(minutes))], y=minutes, name=result.schedule,
                marker={'color': item_colour(k)}, hovertemplate='%{y:.1f} min', showlegend=True,
            )
        )  # fmt: skip
    add_level(figure, Level(18.0, 'paper: 18 min an hour at 80 klx'))
    figure.update_yaxes(title_text='flown [min/h]', rangemode='tozero')
    return set_time_axis(figure, light)


def draw_energy_use(results: Sequence[MissionResult]) -> Figure:
    """Plot the use of the energy of the light."""
    parts = {
        'flight': ([flight_energy(each) for each in results], TRUTH),
        'perch': ([each.figures.consumed - flight_energy(each) for each in results], LAMP),
        'heat in the cell': ([each.figures.lost for each in results], ESTIMATE),
        # A mission that ends with less charge stored nothing; a stacked bar cannot go below 0.
        'stored': ([max(each.figures.stored, 0.0) for each in results], GOOD),
        'not harvested, cell full': ([each.figures.curtailed for each in results], SETPOINT),
    }
    kilojoules = {
        name: ([value / 1e3 for value in values], colour)
        for name, (values, colour) in parts.items()
    }
    return draw_bars([each.schedule for each in results], kilojoules, 'energy', 'kJ')


def flight_energy(result: MissionResult) -> float:
    """Return the energy consumed in flight [J]."""
    return sum(each.spent.consumed for each in result.diary.flights)


def set_time_axis(figure: Figure, light: IrradianceSeries, rows: int = 1) -> Figure:
    """Set the time axis to the hours of the mission."""
    hours = light.end / 3600.0
    figure.update_xaxes(range=[0.0, hours], dtick=3 if hours <= 48 else 12)
    figure.update_xaxes(title_text='time [h]', row=rows, col=1)
    return add_legend(figure)


def select_main_result(results: Sequence[MissionResult]) -> MissionResult:
    """Return the result for the headline: the light-aware schedule, else the first one."""
    return next((each for each in results if each.schedule == AWARE), results[0])

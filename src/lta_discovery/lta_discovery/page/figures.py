"""Draw the figures of a study: error map, overlays, whiteness, remaining forces."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.finding import Discrepancy
from lta_discovery.flights.measured_flight import CHANNELS
from lta_discovery.forecast.flight_prediction import error_to_noise, NAMES
from lta_discovery.page.flight_views import FlightOverlay, piece_conditions, StudyFlightView
from lta_report.drawing import create_figure, padded_range
from lta_report.palette import build_color_scale, ESTIMATE, HEAT, INK, SETPOINT, SOFT, TRUTH, WALL
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure, Heatmap, Scatter
from plotly.subplots import make_subplots

Array = NDArray[np.float64]
BEFORE, AFTER, MEASURED = ESTIMATE, TRUTH, SETPOINT
LINES: Final = (('measured', MEASURED, 4.0), ('before', BEFORE, 1.6), ('after', AFTER, 1.6))
COLUMNS: Final = 150  # of a heat map, at most; more pieces are averaged
ALWAYS: Final = 'always'  # the condition of a discrepancy that occurs throughout
CELLS: Final = 6  # time labels below a heat map, at most
NAMED: Final = 9  # flights with a label above a heat map, at most; there are no times below more


def plot_error_map(flights: Sequence[StudyFlightView], places: Sequence[Discrepancy]) -> Figure:
    """Plot the error-to-noise ratio of each piece and channel, before above after."""
    figure = create_figure(2)
    every = max(1, -(-sum(len(one.before.time) for one in flights) // COLUMNS))
    tables = [
        np.vstack([average_pieces(error_to_noise(one.left[k]), every) for one in flights])
        for k in (0, 1)
    ]
    measured = [k for k in range(len(CHANNELS)) if np.isfinite(tables[0][:, k]).any()]
    names = [NAMES[CHANNELS[k]] for k in measured]
    begun = [one.before.time[::every, 0] for one in flights]
    # Plotly merges columns of one name, and flights may share theirs: append invisible ones.
    columns = [
        f'{one.study_flight.name}, {time:.1f} s' + k * '\N{ZERO WIDTH SPACE}'
        for k, (one, times) in enumerate(zip(flights, begun, strict=True))
        for time in times
    ]
    for row, values in enumerate(tables, 1):
        ratios = values[:, measured].T
        # 100 x log10: the colour scale 0 to 200 spans ratios of 1 to 100, in compact integers.
        logs = np.where(np.isfinite(ratios), 100.0 * np.log10(np.maximum(ratios, 1.0)), 0.0)
        figure.add_trace(
            Heatmap(
                z=np.round(logs).astype(np.int16), x=columns, y=names,
                customdata=np.round(ratios, 2).astype(np.float32),
                zmin=0, zmax=200, colorscale=build_color_scale(HEAT), showscale=row == 1,
                colorbar={'tickvals': [0, 50, 100, 150, 200], 'len': 0.9, 'thickness': 10,
                          'ticktext': ['1', '3', '10', '30', '100'], 'outlinewidth': 0,
                          'tickfont': {'color': SOFT, 'size': 11}, 'x': 1.01},
                hovertemplate='%{x}<br>%{y}: %{customdata:.3~g} x noise<extra></extra>',
                xgap=0.5, ygap=0.5,
            ),
            row=row, col=1,
        )  # fmt: skip
    _label_flights(figure, [one.study_flight.name for one in flights], begun)
    for place in places:
        name = NAMES.get(place.channel, '')
        if name in names and place.condition != ALWAYS:
            _frame_discrepancy(
                figure, place, names.index(name), [one.study_flight.name for one in flights], begun
            )
    figure.update_yaxes(autorange='reversed', showgrid=False, tickfont={'size': 10, 'color': SOFT})
    figure.update_yaxes(title_text='before', row=1)
    figure.update_yaxes(title_text='after', row=2)
    return figure.update_layout(hovermode='closest', margin={'l': 96, 'r': 48, 't': 48, 'b': 34})


def average_pieces(errors: Array, every: int) -> Array:
    """Return the root mean square over groups of `every` pieces, shape (ceil(S / every), 14)."""
    rows = [errors[k : k + every] for k in range(0, len(errors), every)]
    counts = np.array([np.isfinite(part).sum(axis=0) for part in rows]).reshape(-1, len(CHANNELS))
    total = np.array([np.nansum(part**2, axis=0) for part in rows]).reshape(-1, len(CHANNELS))
    return np.where(counts > 0, np.sqrt(total / np.maximum(counts, 1)), np.nan)


def _label_flights(figure: Figure, names: Sequence[str], begun: Sequence[Array]) -> None:
    """Label and separate the flights of the map, and write the time below."""
    first, ticks, texts = 0, [], []
    every = max(1, round(sum(map(len, begun)) / CELLS))
    apart = -(-len(names) // NAMED)
    for k, (name, times) in enumerate(zip(names, begun, strict=True)):
        last = k == len(names) - 1 and k > 0
        if k % apart == 0:
            figure.add_annotation(
                x=(first + len(times) if last else first) - 0.5, xref='x', y=1.0, yref='paper',
                xanchor='right' if last else 'left', yanchor='bottom',
                yshift=12 * (k // apart % 3), text=name, font={'size': 10, 'color': SOFT},
            )  # fmt: skip
        if first:
            for row in (1, 2):
                figure.add_vline(first - 0.5, line={'color': INK, 'width': 1.5}, row=row, col=1)
        for piece in range(0, max(1, len(times) - every + 1), every) if apart == 1 else ():
            ticks.append(first + piece)
            texts.append(f'{times[piece]:.0f} s')
        first += len(times)
    figure.update_xaxes(range=[-0.5, first - 0.5], showgrid=False)
    figure.update_xaxes(tickvals=ticks, ticktext=texts, tickangle=0, row=2)


def _frame_discrepancy(
    figure: Figure, place: Discrepancy, row: int, names: Sequence[str], begun: Sequence[Array]
) -> None:
    """Frame one discrepancy of the finding in the map."""
    first = 0
    for name, times in zip(names, begun, strict=True):
        # A piece lasts until the next one begins; the last has no end.
        ends = np.append(times[1:], np.inf)
        inside = np.flatnonzero((times < place.to_s) & (ends > place.from_s))
        if name == place.flight and len(inside):
            figure.add_shape(
                type='rect', x0=first + inside[0] - 0.5, x1=first + inside[-1] + 0.5,
                y0=row - 0.5, y1=row + 0.5, line={'color': BEFORE, 'width': 2}, row=1, col=1,
            )  # fmt: skip
        first += len(times)


def plot_error_by_condition(flights: Sequence[StudyFlightView]) -> Figure:
    """Plot the pose error of each piece against its flight conditions."""
    conditions = [piece_conditions(one) for one in flights]
    names = list(conditions[0])
    figure = make_subplots(
        rows=2, cols=2, shared_yaxes=True, horizontal_spacing=0.06, vertical_spacing=0.24
    ).update_layout(template=create_figure().layout.template)
    for k, (colour, word) in enumerate(((BEFORE, 'before'), (AFTER, 'after'))):
        errors = np.concatenate([_pose_error(one.left[k]) for one in flights])
        for j, name in enumerate(names):
            figure.add_trace(
                Scatter(
                    x=np.concatenate([each[name] for each in conditions]).astype(np.float32),
                    y=errors.astype(np.float32), mode='markers', name=word,
                    marker={'color': colour, 'size': 4.5, 'opacity': 0.8},
                    hovertemplate='%{y:.3~g} x noise',
                ),
                row=j // 2 + 1, col=j % 2 + 1,
            )  # fmt: skip
            figure.update_xaxes(title_text=name, row=j // 2 + 1, col=j % 2 + 1)
    figure.update_yaxes(type='log', dtick=1)
    figure.update_yaxes(title_text='error by noise', col=1)
    return figure.update_layout(hovermode='closest', margin={'l': 56, 'r': 14, 't': 10, 'b': 42})


def _pose_error(left: Array) -> Array:
    """Return the error-to-noise ratio of the pose of each piece, shape (S,)."""
    # The first six channels are position and attitude.
    each = error_to_noise(left)[:, :6]
    finite = np.isfinite(each)
    total = np.where(finite, each, 0.0) ** 2
    return np.where(
        finite.any(axis=1), np.sqrt(total.sum(axis=1) / np.maximum(finite.sum(axis=1), 1)), np.nan
    )


def plot_path(of: FlightOverlay) -> Figure:
    """Plot measured and predicted paths from above."""
    figure = create_figure()
    for (name, colour, width), line in zip(LINES, of.lines, strict=True):
        figure.add_trace(
            Scatter(
                x=line[:, 0].astype(np.float32), y=line[:, 1].astype(np.float32), name=name,
                mode='lines', line={'color': colour, 'width': width}, connectgaps=False,
                opacity=0.45 if name == 'measured' else 1.0,
                hovertemplate='%{x:.2f}, %{y:.2f} m',
            )
        )  # fmt: skip
    figure.update_xaxes(title_text='x [m]', constrain='domain')
    figure.update_yaxes(title_text='y [m]', scaleanchor='x')
    return figure.update_layout(hovermode='closest', margin={'r': 20})


def plot_time_series(of: FlightOverlay) -> Figure:
    """Plot height, heading and position error over time."""
    figure = create_figure(3)
    for row, (column, title) in enumerate(
        ((2, 'height [m]'), (3, 'heading [\N{DEGREE SIGN}]')), 1
    ):
        for (name, colour, width), line in zip(LINES, of.lines, strict=True):
            figure.add_trace(
                Scatter(
                    x0=of.begin, dx=of.period, y=line[:, column].astype(np.float32), name=name,
                    mode='lines', line={'color': colour, 'width': width}, connectgaps=False,
                    opacity=0.45 if name == 'measured' else 1.0, hovertemplate='%{y:.3~f}',
                ),
                row=row, col=1,
            )  # fmt: skip
        figure.update_yaxes(
            title_text=title, range=padded_range(*(x[:, column] for x in of.lines)), row=row
        )
    figure.update_xaxes(hoverformat='.2f', unifiedhovertitle_text='%{x} s')
    for name, colour, away in prediction_distances(of):
        figure.add_trace(
            Scatter(
                x0=of.begin, dx=of.period, y=away, name=name, mode='lines', connectgaps=False,
                line={'color': colour, 'width': 1.6}, hovertemplate='%{y:.3~f} m',
            ),
            row=3, col=1,
        )  # fmt: skip
    figure.update_yaxes(title_text='off by [m]', rangemode='tozero', row=3)
    figure.update_xaxes(title_text='time [s]', row=3)
    return figure.update_layout(margin={'r': 20})


def prediction_distances(of: FlightOverlay) -> list[tuple[str, str, Array]]:
    """Return name, colour and distance from the measurement [m] of both predictions."""
    truth = of.lines[0][:, :3]
    return [
        (name, colour, np.linalg.norm(line[:, :3] - truth, axis=1).astype(np.float32))
        for (name, colour, _), line in zip(LINES[1:], of.lines[1:], strict=True)
    ]


def plot_stacked_curves(
    curves: Sequence[Sequence[tuple[str, str, Array, Array]]],
    titles: Sequence[str],
    across: str,
    unit: str,
) -> Figure:
    """
    Plot curves in rows that share their x axis.

    `curves`: row by row. `titles`: of the y axes. `across`, `unit`: title of the x axis, and its
    unit.
    """
    figure = create_figure(len(curves))
    for row, (each, title) in enumerate(zip(curves, titles, strict=True), 1):
        for name, colour, x, y in each:
            figure.add_trace(
                Scatter(
                    x=x.astype(np.float32), y=y.astype(np.float32), name=name, mode='lines',
                    line={'color': colour, 'width': 1.8}, hovertemplate='%{y:.3~g}',
                ),
                row=row, col=1,
            )  # fmt: skip
        figure.update_yaxes(title_text=title, row=row)
    figure.update_xaxes(unifiedhovertitle_text=f'%{{x:.3~g}} {unit}')
    figure.update_xaxes(title_text=f'{across} [{unit}]', row=len(curves))
    return figure.update_layout(margin={'r': 20, 'l': 66})


def mark_level(figure: Figure, level: float) -> Figure:
    """Draw a dashed level in all rows, such as that of white noise."""
    figure.add_hline(level, line={'color': WALL, 'width': 1.2, 'dash': '4px,3px'})
    return figure


def plot_parity(
    x: Sequence[Array], y: Sequence[Array], names: Sequence[str], titles: tuple[str, str]
) -> Figure:
    """Plot points of some flights, one colour each, with the line of equality."""
    ends = np.array(padded_range(*x, pad=0.0))
    line = Scatter(
        x=ends, y=ends, mode='lines', hoverinfo='skip',
        line={'color': WALL, 'width': 1.2, 'dash': '4px,3px'},
    )  # fmt: skip
    return plot_points(x, y, names, titles, [line])


def plot_points(
    x: Sequence[Array],
    y: Sequence[Array],
    names: Sequence[str],
    titles: tuple[str, str],
    lines: Sequence[Scatter] = (),
) -> Figure:
    """Plot groups of points, one colour each, above some lines."""
    figure = create_figure()
    figure.add_traces(list(lines))
    for a, b, name, colour in zip(x, y, names, (TRUTH, ESTIMATE, SOFT, WALL), strict=False):
        figure.add_trace(
            Scatter(
                x=a.astype(np.float32), y=b.astype(np.float32), mode='markers', name=name,
                marker={'color': colour, 'size': 4, 'opacity': 0.6},
                hovertemplate='%{x:.3~g}: %{y:.3~g}',
            )
        )  # fmt: skip
    figure.update_xaxes(title_text=titles[0])
    figure.update_yaxes(title_text=titles[1])
    return figure.update_layout(hovermode='closest', margin={'r': 20, 'l': 66})

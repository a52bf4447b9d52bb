"""Plot a sweep over two parameters as maps of the success rate and the median time."""

from collections.abc import Mapping, Sequence
from itertools import product
from statistics import median

from lta_flight.sweep.job_runner import FAILED, SweepRow
from lta_flight.sweep.plan import convert_to_si, SweepPlan
from lta_flight.sweep.statistics import is_number, REACHED
from lta_report.drawing import create_figure
from plotly.graph_objects import Figure, Heatmap

LEAST_VALUES = 3  # values of a parameter; a map of fewer shows nothing
MAP_MARGIN = {'l': 64, 'r': 24, 't': 12}


def find_map_parameters(plan: SweepPlan) -> tuple[str, str] | None:
    """Return the two parameters of a map; None if the sweep has others."""
    if len(plan.lists) != 2 or len(plan.units) != 2:
        return None
    first, second = plan.lists
    # Names have no order and make no map
    fits = all(
        len(values) >= LEAST_VALUES and all(is_number(convert_to_si(value)) for value in values)
        for values in plan.lists.values()
    )
    return (first, second) if fits else None


def plot_heat_map(
    rows: Sequence[SweepRow], both: tuple[str, str], units: Mapping[str, str]
) -> Figure:
    """Return a figure of the reached share and the median time over two parameters."""
    across, up = both
    cells: dict[tuple[float, float], list[SweepRow]] = {}
    for row in rows:
        # Failed flights say nothing about the parameters
        if row.outcome != FAILED:
            cells.setdefault((row.values[across], row.values[up]), []).append(row)
    xs, ys = (sorted({row.values[path] for row in rows}) for path in both)
    share: list[list[float | None]] = [[None] * len(xs) for _ in ys]
    times: list[list[float | None]] = [[None] * len(xs) for _ in ys]
    for (i, x), (j, y) in product(enumerate(xs), enumerate(ys)):
        if cell_rows := cells.get((x, y)):
            reached = [row for row in cell_rows if row.outcome == REACHED]
            share[j][i] = 100.0 * len(reached) / len(cell_rows)
            spent = [row.figures.get('search_time') for row in reached]
            times_reached = [value for value in spent if value is not None]
            # None leaves the cell empty
            times[j][i] = median(times_reached) if times_reached else None
    figure = create_figure(2, [0.5, 0.5])
    for line, (grid, words) in enumerate(((share, 'reached [%]'), (times, 'time [s]')), start=1):
        add_map(figure, xs, ys, grid, words, line)
        figure.update_yaxes(title_text=format_axis_title(up, units), row=line)
    figure.update_xaxes(title_text=format_axis_title(across, units), row=2)
    return figure.update_layout(hovermode='closest', margin=MAP_MARGIN)


def add_map(
    figure: Figure,
    xs: Sequence[float],
    ys: Sequence[float],
    grid: Sequence[Sequence[float | None]],
    words: str,
    line: int,
) -> None:
    """Add one map with its colour bar."""
    # One colour bar next to each of the two maps
    bar = {'title': {'text': words}, 'len': 0.5, 'y': 0.77 if line == 1 else 0.23}
    figure.add_trace(
        Heatmap(
            x=xs, y=ys, z=grid, colorscale='Cividis', colorbar=bar,
            zmin=0.0 if line == 1 else None, zmax=100.0 if line == 1 else None,
            hovertemplate='%{x:.3g}, %{y:.3g}: %{z:.1f}<extra></extra>',
        ),
        row=line, col=1,
    )  # fmt: skip


def format_axis_title(path: str, units: Mapping[str, str]) -> str:
    """Return the last word of a parameter's path with its unit, since axes have little space."""
    *_, before, last = path.split('.')
    # An index alone, as in air.wind.0, would not identify the parameter
    short = f'{before}.{last}' if last.isdecimal() else last
    return f'{short} [{units[path]}]' if units.get(path) else short

"""Draw the measured bearings on the floor plan, one per second."""

from lta_flight.report.results import find_phases
from lta_flight.report.view import FlightView
from lta_report.curves import Array, interpolate
from lta_report.palette import SOFT, STRENGTH
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure, Scatter

LENGTH = 0.75  # m; long enough to show a direction, short enough not to hide the next
PERIOD = 1.0  # s


def select_per_period(time: Array, start: float, end: float) -> NDArray[np.intp]:
    """Return the first sample of each period between two times, if there is one."""
    inside = np.flatnonzero((time >= start) & (time < end))
    _, first = np.unique(np.floor((time[inside] - start) / PERIOD), return_index=True)
    return inside[first]


def draw_rays(figure: Figure, view: FlightView) -> None:
    """Draw short rays along the measured bearings, darker for a better SNR."""
    time, angle = view.bearing
    phases = find_phases(view)
    start = phases.search if np.isfinite(phases.search) else view.span[0]
    chosen = select_per_period(time, start, phases.end)
    # Blocks without a bearing have no ray
    chosen = chosen[np.isfinite(angle[chosen])]
    if not len(chosen):
        return
    truth = view.truth
    x, y, yaw = (
        interpolate(time[chosen], truth.time, part) for part in (truth.x, truth.y, truth.yaw)
    )
    peak_time, parts = view.peaks
    snr = interpolate(time[chosen], peak_time, parts['snr'].max(axis=1))
    # Bearings are in the body frame, the plan is in map
    course = yaw + angle[chosen]
    # The SNR spans orders of magnitude, so grade its logarithm
    shades = assign_shades(np.log(np.maximum(snr, 1.0)))
    for grade, colour in enumerate(STRENGTH):
        strong = shades == grade
        if strong.any():
            figure.add_trace(build_ray_line(x[strong], y[strong], course[strong], colour))
    key = ''.join(
        f'<span style="color:{colour}">\N{BOX DRAWINGS HEAVY HORIZONTAL}</span>'
        for colour in STRENGTH
    )
    figure.add_annotation(
        x=0.03,
        y=0.03,
        xref='x domain',
        yref='y domain',
        xanchor='left',
        text=f'bearing, SNR {snr.min():.0f} {key} {snr.max():.0f}',
        font={'color': SOFT, 'size': 11},
    )


def assign_shades(values: Array) -> Array:
    """Return the index of the shade of each value, from least to greatest."""
    # Equal values all get the first shade
    span = float(np.ptp(values)) or 1.0
    share = (values - values.min()) / span
    return np.asarray(np.minimum(share * len(STRENGTH), len(STRENGTH) - 1).astype(int))


def build_ray_line(x: Array, y: Array, course: Array, colour: str) -> Scatter:
    """Return rays of one colour as a single line with gaps."""
    # A NaN after each ray interrupts the line; one trace draws faster than many
    gap = np.full(len(x), np.nan)
    return Scatter(
        x=np.stack([x, x + LENGTH * np.cos(course), gap], axis=1).ravel().astype(np.float32),
        y=np.stack([y, y + LENGTH * np.sin(course), gap], axis=1).ravel().astype(np.float32),
        mode='lines',
        line={'color': colour, 'width': 1.8},
        name='bearing',
        hoverinfo='skip',
    )

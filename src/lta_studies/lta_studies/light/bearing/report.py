"""Build the report on bearing accuracy."""

from collections.abc import Sequence
import math
from typing import Final

from lta_report.drawing import add_legend, create_figure
from lta_report.formatting import MISSING, Tile
from lta_report.palette import ESTIMATE, TIME, TRUTH, WALL
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_studies.light.bearing.places import PLACES
from lta_studies.light.bearing.run import BearingTrialRequest, BearingTrialResult, to_json
from lta_studies.light.bearing.score import extract_column, interval_coverage
import numpy as np
from plotly.graph_objects import Figure, Scatter
from scipy.special import ndtri

CAPTION: Final = (
    'Dots: median error of the bearing. Lines above them: up to the 95 % quantile. Orange: '
    'the weighted mean of the paper (Huang et al. 2025). Blue: our fit.'
)
HONEST: Final = (
    "How often the fit's interval contains the true bearing, against the nominal "
    'probability of the interval. On the dashed line the fit is calibrated; above it the '
    'intervals are too wide, below it too narrow.'
)
METHOD: Final = (
    'Each reading is one block of ADC samples (100 ms) from the simulated diodes and '
    "amplifiers, at a random pose within 60 degrees of the lamp's axis: random heading, "
    'hull at 0.5 to 1.5 m, pitch and roll of 2 degrees rms, and new random diode gains for '
    'every pose. The true bearing is the direction from the centre of the diodes to the '
    'lamp. "holds" is the share of true values within the fit\'s 95 % interval. A level ring '
    'of diodes cannot measure the elevation, so its estimate is the prior. Medians have their '
    '95 % interval, by the order of the errors. "bound" is the median error of an unbiased '
    'estimator with normal errors that attains the Cramer-Rao bound of the deviation at every '
    'pose, with this noise and these unequal gains, and knows the reflections and the response '
    'of the diodes. It bounds deviations; the median error of other estimators may be smaller.'
)
DASHES: Final = ('solid', '5px,3px', '2px,2px')  # of curves that share a colour
TICKS: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # degrees
PLACE_HEADS: Final = ('place', 'diodes', 'range [m]')
DIODE_HEADS: Final = ('true exponent', 'true gain spread [%]')
BEARING_HEADS: Final = (
    'SNR', 'bound, median [°]', 'paper, median [°]', 'paper, 95 % quantile [°]',
    'fit, median [°]', 'fit, 95 % quantile [°]', 'fit deviation [°]', 'holds [%]',
)  # fmt: skip
ELEVATION_HEADS: Final = ('elevation, median [°]', 'holds [%]', 'lost: paper, fit [%]')


def build_report(results: Sequence[BearingTrialResult], request: BearingTrialRequest) -> Report:
    """Return the report of a bearing study."""
    places = ' · '.join(f'{name}: {PLACES[name].about}' for name in request.place)
    return Report(
        command='light bearing',
        subject=request.vehicle,
        headline=format_headline(results),
        introduction=f'{places}. {request.poses} random poses for each place, number of diodes '
        'and range.',
        tiles=build_tiles(results),
        blocks=(
            Picture('errors', 'Error of the bearing', CAPTION, plot_errors(results), height=420),
            build_bearing_table(results),
            build_elevation_table(results),
            Picture(
                'honest', 'How often the interval contains the true bearing', HONEST,
                plot_calibration(results), height=420,
            ),
            TextSection('Method', (METHOD,)),
        ),
        data=to_json(results, request),
        facts={
            'vehicle': request.vehicle, 'seed': str(request.seed),
            'readings': str(request.pose_count),
        },
    )  # fmt: skip


def format_range(distance: float | None) -> str:
    """Format a range [m] as an option value."""
    return 'any' if distance is None else f'{distance:g}'


def format_distance(distance: float | None) -> str:
    """Format a range [m] with its unit."""
    return 'any range' if distance is None else f'{distance:g} m'


def format_degrees(angle: float, digits: int = 2) -> str:
    """Format an angle in degrees; a dash if it is not finite."""
    return f'{math.degrees(angle):.{digits}f}' if math.isfinite(angle) else MISSING


def format_median(angle: float, interval: tuple[float, float]) -> str:
    """Format a median in degrees with its interval."""
    low, high = map(format_degrees, interval)
    return f'{format_degrees(angle)} ({low} to {high})'


def format_percent(part: float) -> str:
    """Format a share in percent; a dash if it is not finite."""
    return f'{100.0 * part:.1f}' if math.isfinite(part) else MISSING


def build_bearing_table(results: Sequence[BearingTrialResult]) -> TextTable:
    """Return the table of the bearings of both estimators."""
    rows = [
        [
            *format_place(each), *format_diodes(each), f'{s.snr:.0f}', format_degrees(s.bound),
            format_median(s.paper, s.paper_interval),
            format_degrees(s.paper_most, 1), format_median(s.ours, s.ours_interval),
            format_degrees(s.ours_most, 1), format_degrees(s.deviation), format_percent(s.holds),
        ]
        for each, s in ((each, each.score) for each in results)
    ]  # fmt: skip
    heads = (*PLACE_HEADS, *DIODE_HEADS, *BEARING_HEADS)
    return TextTable('Comparison of the estimators', heads, rows)


def build_elevation_table(results: Sequence[BearingTrialResult]) -> TextTable:
    """Return the table of elevations and of readings without an estimate."""
    rows = [
        [
            *format_place(each), format_degrees(s.elevation, 1),
            format_percent(s.elevation_holds),
            f'{format_percent(s.paper_lost)}, {format_percent(s.ours_lost)}',
        ]
        for each, s in ((each, each.score) for each in results)
    ]  # fmt: skip
    heading = 'Elevation, and readings without an estimate'
    return TextTable(heading, (*PLACE_HEADS, *ELEVATION_HEADS), rows)


def format_place(result: BearingTrialResult) -> list[str]:
    """Return the cells of place, number of diodes and range."""
    return [result.place, str(result.count), format_range(result.range)]


def format_diodes(result: BearingTrialResult) -> list[str]:
    """Return the cells of the simulated diodes."""
    response, spread = result.diodes
    return [
        'file' if response is None else f'{response:g}',
        'file' if spread is None else f'{100.0 * spread:g}',
    ]


def format_headline(results: Sequence[BearingTrialResult]) -> str:
    """Return the headline."""
    # Prefer 8 diodes at 3 m, the setup of the paper.
    best = min(results, key=lambda each: (each.count != 8, each.range != 3.0))
    where = 'anywhere' if best.range is None else f'at {best.range:g} m'
    return (
        f'{best.place.capitalize()}, {best.count} diodes, {where}: the median bearing error '
        f'is {format_degrees(best.score.ours)}° for our fit and '
        f'{format_degrees(best.score.paper)}° for the weighted mean of the paper.'
    )


def build_tiles(results: Sequence[BearingTrialResult]) -> list[Tile]:
    """Return tiles with the median error of the fit, up to eight."""
    return [
        Tile(
            f'{each.place}, {each.count}, {format_distance(each.range)}'.replace(
                'any m', 'anywhere'
            ),
            format_degrees(each.score.ours),
            '°',
            f'median error; paper: {format_degrees(each.score.paper)}°; truth within the 95 '
            f'% interval: {format_percent(each.score.holds)} %',
        )
        for each in results[:8]
    ]


def plot_errors(results: Sequence[BearingTrialResult]) -> Figure:
    """Plot median and 95 % quantile of both estimators."""
    figure = create_figure()
    names = [
        f'{each.place}<br>{each.count} diodes<br>{format_distance(each.range)}' for each in results
    ]
    pairs = (
        # Shifted by 0.12 of a category, so that the two markers do not overlap.
        (
            'weighted mean of the paper',
            ESTIMATE,
            -0.12,
            [(e.score.paper, e.score.paper_most) for e in results],
        ),
        ('our fit', TRUTH, 0.12, [(e.score.ours, e.score.ours_most) for e in results]),
    )
    for name, colour, aside, quantiles in pairs:
        middle, most = np.degrees(np.array(quantiles)).T
        figure.add_trace(
            Scatter(
                x=np.arange(len(results)) + aside, y=middle, mode='markers', name=name,
                marker={'color': colour, 'size': 9},
                error_y={
                    # Bars only upwards, from the median to the quantile
                    'type': 'data', 'array': most - middle, 'arrayminus': 0.0 * middle,
                    'color': colour, 'thickness': 1.4, 'width': 3, 'symmetric': False,
                },
                hovertemplate='%{y:.2f}°',
            )
        )  # fmt: skip
    figure.update_xaxes(tickvals=list(range(len(results))), ticktext=names, tickfont={'size': 10})
    figure.update_yaxes(
        title_text='bearing error [°]', type='log', tickvals=TICKS,
        ticktext=[f'{each:g}' for each in TICKS],
    )  # fmt: skip
    return add_legend(figure).update_layout(margin_b=70)


def plot_calibration(results: Sequence[BearingTrialResult]) -> Figure:
    """Plot the coverage of intervals against their nominal probability."""
    figure = create_figure()
    stated = np.linspace(0.02, 0.99, 60)
    # Half width of the central normal interval, in standard deviations
    widths = ndtri(0.5 + 0.5 * stated)
    figure.add_trace(
        Scatter(
            x=100.0 * stated, y=100.0 * stated, mode='lines', name='calibrated', hoverinfo='skip',
            line={'color': WALL, 'width': 1, 'dash': '4px,4px'},
        )
    )  # fmt: skip
    for k, each in enumerate(results):
        own, deviation = (
            extract_column(each.readings, 'ours'),
            extract_column(each.readings, 'deviation'),
        )
        figure.add_trace(
            Scatter(
                x=100.0 * stated,
                y=[100.0 * interval_coverage(own, deviation, float(width)) for width in widths],
                mode='lines',
                name=f'{each.place}, {each.count} diodes, {format_distance(each.range)}',
                line={
                    'color': TIME[k % len(TIME)], 'width': 1.4,
                    'dash': DASHES[k // len(TIME) % len(DASHES)],
                },
                hovertemplate='%{y:.0f} %',
            )
        )  # fmt: skip
    figure.update_xaxes(title_text='nominal [%]', range=[0, 100])
    figure.update_yaxes(title_text='true bearings inside [%]', range=[0, 101])
    return add_legend(figure)

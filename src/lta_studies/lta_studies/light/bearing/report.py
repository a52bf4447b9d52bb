"""Build the report on bearing accuracy."""

from collections.abc import Sequence
import math
from typing import Final

from lta_report.charts import ChartAxis, Curve, DASHED, draw_curves
from lta_report.formatting import MISSING, Tile
from lta_report.palette import ESTIMATE, TIME, TRUTH, WALL
from lta_report.report import Picture, Report, TextSection
from lta_report.result_table import build_table, Column
from lta_studies.light.bearing.bench import BEARING_PLACES
from lta_studies.light.bearing.run import (
    BearingTrialRequest,
    BearingTrialResult,
    extract_column,
    interval_coverage,
    to_json,
)
import numpy as np
from plotly.graph_objects import Figure
from scipy.special import ndtri

ERROR_CAPTION: Final = (
    'Dots: median error of the bearing. Lines beside them: up to the 95 % quantile. Orange: '
    'the weighted mean of the paper (Huang et al. 2025). Blue: our fit.'
)
HONEST: Final = (
    "How often the fit's interval contains the true bearing, against the nominal "
    'probability of the interval. On the dashed line the fit is calibrated; above it the '
    'intervals are too wide, below it too narrow.'
)
BEARING_METHOD: Final = (
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
ERROR_TICKS: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # degrees


def build_report(results: Sequence[BearingTrialResult], request: BearingTrialRequest) -> Report:
    """Return the report of a bearing study."""
    places = ' · '.join(f'{name}: {BEARING_PLACES[name].about}' for name in request.place)
    return Report(
        command='light bearing',
        subject=request.vehicle,
        headline=format_headline(results),
        introduction=f'{places}. {request.poses} random poses for each place, number of diodes '
        'and range.',
        tiles=build_tiles(results),
        blocks=(
            Picture('errors', 'Error of the bearing', ERROR_CAPTION, plot_errors(results),
                    height=140 + 22 * len(results)),
            build_table('Comparison of the estimators', BEARING_COLUMNS, results),
            build_table('Elevation, and readings without an estimate', ELEVATION_COLUMNS, results),
            Picture(
                'honest', 'How often the interval contains the true bearing', HONEST,
                plot_calibration(results), height=420,
            ),
            TextSection('Method', (BEARING_METHOD,)),
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


PLACE_COLUMNS: Final[tuple[Column[BearingTrialResult], ...]] = (
    Column('', 'place', of=lambda each: each.place),
    Column('', 'diodes', of=lambda each: each.count),
    Column('', 'range [m]', of=lambda each: format_range(each.range)),
)
BEARING_COLUMNS: Final[tuple[Column[BearingTrialResult], ...]] = (
    *PLACE_COLUMNS,
    Column('', 'true exponent', of=lambda each: format_simulated(each.diodes[0], 1.0)),
    Column('', 'true gain spread [%]', of=lambda each: format_simulated(each.diodes[1], 100.0)),
    Column('', 'SNR', digits=0, of=lambda each: each.score.snr),
    Column('', 'bound, median', '°', 2, lambda each: each.score.bound),
    Column('', 'paper, median [°]',
           of=lambda each: format_median(each.score.paper, each.score.paper_interval)),
    Column('', 'paper, 95 % quantile', '°', 1, lambda each: each.score.paper_most),
    Column('', 'fit, median [°]',
           of=lambda each: format_median(each.score.ours, each.score.ours_interval)),
    Column('', 'fit, 95 % quantile', '°', 1, lambda each: each.score.ours_most),
    Column('', 'fit deviation', '°', 2, lambda each: each.score.deviation),
    Column('', 'holds', '%', 1, lambda each: each.score.holds),
)  # fmt: skip
ELEVATION_COLUMNS: Final[tuple[Column[BearingTrialResult], ...]] = (
    *PLACE_COLUMNS,
    Column('', 'elevation, median', '°', 1, lambda each: each.score.elevation),
    Column('', 'holds', '%', 1, lambda each: each.score.elevation_holds),
    Column('', 'lost: paper, fit', '%', 1,
           lambda each: (each.score.paper_lost, each.score.ours_lost)),
)  # fmt: skip


def format_simulated(value: float | None, factor: float) -> str:
    """Format a property of the simulated diodes, which is that of the file if not chosen."""
    return 'file' if value is None else f'{factor * value:g}'


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
            f'median error of {len(each.readings)} readings; paper: '
            f'{format_degrees(each.score.paper)}°; truth within the 95 % interval: '
            f'{format_percent(each.score.holds)} %',
        )
        for each in results[:8]
    ]


def plot_errors(results: Sequence[BearingTrialResult]) -> Figure:
    """Plot median and 95 % quantile of both estimators."""
    # Places one below the other: beside each other, their names would overlap on a phone
    names = [f'{each.place}, {each.count}, {format_distance(each.range)}' for each in results]
    pairs = (
        ('weighted mean of the paper', ESTIMATE, -0.12,
         [(e.score.paper, e.score.paper_most) for e in results]),
        ('our fit', TRUTH, 0.12, [(e.score.ours, e.score.ours_most) for e in results]),
    )  # fmt: skip
    curves = []
    # Shifted aside, so that the two markers do not overlap
    for name, colour, aside, quantiles in pairs:
        middle, most = np.degrees(np.array(quantiles)).T
        places = np.arange(len(results)) + aside
        # From the median to the quantile
        bars = {
            'type': 'data', 'symmetric': False, 'array': most - middle, 'arrayminus': 0.0 * middle,
            'thickness': 1.4, 'width': 3,
        }  # fmt: skip
        curves.append(Curve(name, middle, places, colour, '%{x:.2f}°', 'markers', size=9,
                            more={'error_x': bars}))  # fmt: skip
    order = {'tickfont_size': 11, 'automargin': True, 'autorange': 'reversed'}
    title = 'place, number of diodes, range'
    places_axis = ChartAxis(title, ticks=range(len(results)), words=names, more=order)
    error_axis = ChartAxis('bearing error [°]', log=True, ticks=ERROR_TICKS, more={'tickangle': 0})
    return draw_curves(curves, error_axis, places_axis).update_layout(margin_r=16)


def plot_calibration(results: Sequence[BearingTrialResult]) -> Figure:
    """Plot the coverage of intervals against their nominal probability."""
    stated = np.linspace(0.02, 0.99, 60)
    # Half width of the central normal interval, in standard deviations
    widths = ndtri(0.5 + 0.5 * stated).tolist()
    percent = 100.0 * stated
    curves = [Curve('calibrated', percent, percent, WALL, '', 'lines', DASHED, 1.0)]
    for k, each in enumerate(results):
        own = extract_column(each.readings, 'ours')
        deviation = extract_column(each.readings, 'deviation')
        inside = [100.0 * interval_coverage(own, deviation, width) for width in widths]
        name = f'{each.place}, {each.count} diodes, {format_distance(each.range)}'
        dash = DASHES[k // len(TIME) % len(DASHES)]
        colour = TIME[k % len(TIME)]
        curves.append(Curve(name, percent, inside, colour, '%{y:.0f} %', 'lines', dash, 1.4))
    nominal = ChartAxis('nominal [%]', range=(0, 100))
    return draw_curves(curves, nominal, ChartAxis('true bearings inside [%]', range=(0, 101)))

"""Score bearing readings: median errors, interval coverage and share without estimate."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
import math
from typing import Final, final

from lta_report.json_value import replace_nonfinite
from lta_studies.light.bearing.bench import BearingReading
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import erf
from scipy.stats import binom

INTERVAL: Final = 1.959964  # half width of the 95 % interval in standard deviations
PERCENT: Final = 95.0
Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class BearingScore:
    """Score of readings; angles in rad, NaN without estimates."""

    readings: int  # number of readings
    snr: float  # median SNR of the best diode
    # Median error of the paper's estimator with its 95 % interval, the 95 % quantile of the
    # errors, and the share without a bearing
    paper: float
    paper_interval: tuple[float, float]
    paper_most: float
    paper_lost: float
    # The same for the fit
    ours: float
    ours_interval: tuple[float, float]
    ours_most: float
    ours_lost: float
    deviation: float  # median of the standard deviation estimated by the fit
    holds: float  # share of the true bearings within its 95 % interval
    # Median error, median deviation and coverage of the elevation
    elevation: float
    elevation_deviation: float
    elevation_holds: float
    # Median error of an unbiased estimator with normal errors whose deviation is the Cramer-Rao
    # bound at every pose (`bearing_bound`)
    bound: float

    def to_json(self) -> dict[str, float | None]:
        """Convert the score to JSON, with NaN as null."""
        content: dict[str, float | None] = replace_nonfinite(asdict(self))
        return content


def score_readings(readings: Sequence[BearingReading]) -> BearingScore:
    """Compute the score of readings."""
    paper, ours = extract_column(readings, 'paper'), extract_column(readings, 'ours')
    deviation = extract_column(readings, 'deviation')
    elevation, up = (
        extract_column(readings, 'elevation'),
        extract_column(readings, 'elevation_deviation'),
    )
    return BearingScore(
        readings=len(readings),
        snr=float(np.median(extract_column(readings, 'snr'))),
        paper=error_quantile(paper, 50.0),
        paper_interval=median_interval(paper),
        paper_most=error_quantile(paper, PERCENT),
        # NaN marks a block without an estimate.
        paper_lost=float(np.mean(np.isnan(paper))),
        ours=error_quantile(ours, 50.0),
        ours_interval=median_interval(ours),
        ours_most=error_quantile(ours, PERCENT),
        ours_lost=float(np.mean(np.isnan(ours))),
        deviation=error_quantile(deviation, 50.0),
        holds=interval_coverage(ours, deviation, INTERVAL),
        elevation=error_quantile(elevation, 50.0),
        elevation_deviation=error_quantile(up, 50.0),
        elevation_holds=interval_coverage(elevation, up, INTERVAL),
        bound=median_normal_error(extract_column(readings, 'bound')),
    )


def extract_column(readings: Sequence[BearingReading], name: str) -> Array:
    """Return an attribute of all readings, shape (n,)."""
    return np.array([getattr(reading, name) for reading in readings], dtype=np.float64)


def error_quantile(errors: Array, percent: float) -> float:
    """Return a percentile of the absolute errors; NaN if there are none."""
    finite = np.abs(errors[np.isfinite(errors)])
    return float(np.percentile(finite, percent)) if finite.size else math.nan


def median_interval(errors: Array) -> tuple[float, float]:
    """
    Return the 95 % interval of the median of the absolute errors, by their order alone.

    The number of errors below the true median is binomial, whatever their distribution (David and
    Nagaraja 2003, Order Statistics, 7.1). NaN of fewer than six errors, which have no such
    interval.
    """
    finite = np.sort(np.abs(errors[np.isfinite(errors)]))
    # The interval begins at the last error that so few lie below with a chance of at most 2.5 %
    first = int(binom.ppf(0.5 - 0.005 * PERCENT, len(finite), 0.5)) - 1 if finite.size else -1
    if first < 0:
        return math.nan, math.nan
    return float(finite[first]), float(finite[-1 - first])


def median_normal_error(deviations: Array) -> float:
    """Return the median of absolute normal errors, one of each deviation; NaN of none."""
    finite = deviations[np.isfinite(deviations)]
    if not finite.size:
        return math.nan
    ends = 0.0, float(finite.max())
    # Half of all errors are smaller; at the largest deviation more than two thirds are
    return float(brentq(lambda error: np.mean(erf(error / finite / math.sqrt(2.0))) - 0.5, *ends))


def interval_coverage(errors: Array, deviations: Array, width: float) -> float:
    """Return the share of errors within `width` times their deviations. [1]"""
    finite = np.isfinite(errors)
    if not finite.any():
        return math.nan
    return float(np.mean(np.abs(errors[finite]) < width * deviations[finite]))

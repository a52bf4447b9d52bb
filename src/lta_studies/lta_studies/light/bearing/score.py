"""Score bearing readings: median errors, interval coverage and share without estimate."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
import math
from typing import Final, final

from lta_report.json_value import replace_nonfinite
from lta_studies.light.bearing.bench import BearingReading
import numpy as np
from numpy.typing import NDArray

INTERVAL: Final = 1.959964  # half width of the 95 % interval in standard deviations
PERCENT: Final = 95.0
MEDIAN: Final = 0.6744898  # median absolute error of a normal distribution, over its deviation
Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class BearingScore:
    """Score of readings; angles in rad, NaN without estimates."""

    readings: int  # number of readings
    snr: float  # median SNR of the best diode
    # Median error of the paper's estimator, its 95 % quantile, and the share without a bearing
    paper: float
    paper_most: float
    paper_lost: float
    # The same for the fit
    ours: float
    ours_most: float
    ours_lost: float
    deviation: float  # median of the standard deviation estimated by the fit
    holds: float  # share of the true bearings within its 95 % interval
    # Median error, median deviation and coverage of the elevation
    elevation: float
    elevation_deviation: float
    elevation_holds: float
    bound: float  # smallest median error that an unbiased estimator could reach (`bearing_bound`)

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
        paper_most=error_quantile(paper, PERCENT),
        # NaN marks a block without an estimate.
        paper_lost=float(np.mean(np.isnan(paper))),
        ours=error_quantile(ours, 50.0),
        ours_most=error_quantile(ours, PERCENT),
        ours_lost=float(np.mean(np.isnan(ours))),
        deviation=error_quantile(deviation, 50.0),
        holds=interval_coverage(ours, deviation, INTERVAL),
        elevation=error_quantile(elevation, 50.0),
        elevation_deviation=error_quantile(up, 50.0),
        elevation_holds=interval_coverage(elevation, up, INTERVAL),
        bound=MEDIAN * error_quantile(extract_column(readings, 'bound'), 50.0),
    )


def extract_column(readings: Sequence[BearingReading], name: str) -> Array:
    """Return an attribute of all readings, shape (n,)."""
    return np.array([getattr(reading, name) for reading in readings], dtype=np.float64)


def error_quantile(errors: Array, percent: float) -> float:
    """Return a percentile of the absolute errors; NaN if there are none."""
    finite = np.abs(errors[np.isfinite(errors)])
    return float(np.percentile(finite, percent)) if finite.size else math.nan


def interval_coverage(errors: Array, deviations: Array, width: float) -> float:
    """Return the share of errors within `width` times their deviations. [1]"""
    finite = np.isfinite(errors)
    if not finite.any():
        return math.nan
    return float(np.mean(np.abs(errors[finite]) < width * deviations[finite]))

"""Evaluate bearings at random poses for places, numbers of diodes and ranges."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import product
import math
from typing import Annotated, Any, cast, Final, final, NamedTuple

from lta_config.errors import unknown_name_error
from lta_report.json_value import replace_nonfinite
from lta_report.report import Report
from lta_report.request import option, remove_duplicates, StudyRequest, StudyRun, VEHICLE
from lta_report.study import hash_inputs, Study
from lta_report.study_store import StoreFormat
from lta_report.workers import report_progress
from lta_studies.light.bearing.bench import (
    BEARING_PLACES,
    BearingBench,
    BearingReading,
    build_flight_spec,
    draw_pose,
    TrueDiodes,
)
import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator, PlainSerializer, TypeAdapter
from scipy.optimize import brentq
from scipy.special import erf
from scipy.stats import binom

ANY: Final = 'any'  # range: anywhere in the scene
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


class BearingCase(NamedTuple):
    """A place, number of diodes, kind of diodes and range [m]; its text is its key."""

    place: str
    ring: int
    diodes: TrueDiodes
    range: float | None


def _parse_place(name: str) -> str:
    """Return the name of a place; raise `BadInput` if it is unknown."""
    if name not in BEARING_PLACES:
        raise unknown_name_error('place', name, list(BEARING_PLACES))
    return name


def _parse_range(text: object) -> object:
    """Return a range in m, and None for "any"."""
    try:
        distance = None if text in (None, ANY) else float(cast('str', text))
    except ValueError:
        distance = math.nan
    # NaN fails this test as well
    if distance is not None and not 1.0 <= distance <= 100.0:
        raise ValueError(f"'{text}' is not a distance; give 1 to 100 metres, or {ANY}")
    return distance


Place = Annotated[str, AfterValidator(_parse_place)]
LampRange = Annotated[  # m; None is anywhere in the scene
    float | None, BeforeValidator(_parse_range), PlainSerializer(lambda range: range or ANY)
]


@final
class BearingTrialRequest(StudyRequest, command='light bearing', quick={'poses': 20}):
    """
    Evaluate bearing estimation: the paper's weighted mean against our fit.

    Simulates random poses in front of the lamp, through diodes, amplifiers, ADC and demodulator.
    Reports the median of the bearing error with its interval, its 95 % quantile, the coverage of
    the fit's 95 % interval, the elevation error, and the median error at the Cramer-Rao bound of
    the deviation. The drone assumes the photodiodes of the vehicle file; --response and
    --gain-spread simulate others. Indoor is the shared room with reflections; outdoor is a field
    in daylight of 80 klux, with suitable diodes.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta light bearing --place indoor --diodes 8 --range any --poses 10000
    """

    vehicle: str = VEHICLE
    place: Annotated[tuple[Place, ...], AfterValidator(remove_duplicates)] = option(
        'Where to simulate: indoor or outdoor; repeat for both.', default=tuple(BEARING_PLACES)
    )
    diodes: Annotated[tuple[int, ...], AfterValidator(remove_duplicates)] = option(
        'Number of photodiodes in the ring; repeat to compare several.', default=(4, 8, 16),
        low=1, high=64,
    )  # fmt: skip
    range: Annotated[tuple[LampRange, ...], AfterValidator(remove_duplicates)] = option(
        'Distance to the lamp in metres, or "any" (random); repeat to compare several.',
        default=('3', '7', ANY),
    )
    poses: int = option(
        'Number of random poses for each combination of place, diodes and distance.', default=500,
        low=1, high=1_000_000,
    )  # fmt: skip
    response: tuple[float, ...] = option(
        'True exponent of the simulated diodes, of which the drone only knows the vehicle file; '
        'repeat to compare several; by default as in the file.',
        default=(), low=0.3, high=10.0,
    )  # fmt: skip
    gain_spread: tuple[float, ...] = option(
        'True spread of the gains in percent; repeat to compare several; by default as in the '
        'file.',
        default=(), low=0.0, high=50.0,
    )  # fmt: skip
    off_axis: float = option(
        "Largest angle between the lamp's axis and the drone, degrees; 0: on the axis, at a "
        '--range in metres.',
        default=60.0, low=0.0, high=60.0,
    )  # fmt: skip
    seed: int = option('Random seed.', default=1, low=0)

    def run(self, run: StudyRun) -> Report:
        """Return the report of all combinations."""
        from lta_studies.light.bearing.report import build_report

        # Also checks that the vehicle fits the scenes before any work
        specs = [build_flight_spec(BEARING_PLACES[name], self.vehicle, 1) for name in self.place]
        inputs = (self.poses, self.seed, self.off_axis, *(s.contents for s in specs))
        study = Study(self.evaluate, str, BEARING_STORE, 'combinations')
        trials = run.run_study(study, hash_inputs(*inputs), self.list_cases())
        return build_report(trials, self)

    @property
    def pose_count(self) -> int:
        """Total number of poses."""
        return len(self.list_cases()) * self.poses

    def list_cases(self) -> list[BearingCase]:
        """Return all combinations; the drone assumes the diodes of the vehicle file."""
        kinds = [
            TrueDiodes(exponent, spread)
            for exponent in dict.fromkeys(self.response) or (None,)
            for spread in dict.fromkeys(each / 100.0 for each in self.gain_spread) or (None,)
        ]
        every = product(self.place, self.diodes, kinds, self.range)
        return [BearingCase(*each) for each in every]

    def evaluate(self, case: BearingCase) -> 'BearingTrialResult':
        """
        Evaluate the bearings of a combination.

        Each starts its own random stream, so that rings of different size see the same poses.
        """
        place = BEARING_PLACES[case.place]
        bench = BearingBench(
            build_flight_spec(place, self.vehicle, case.ring),
            build_flight_spec(place, self.vehicle, case.ring, case.diodes),
        )
        readings = tuple(simulate_random_poses(bench, case.range, self))
        return BearingTrialResult(
            case.place, case.ring, case.range, case.diodes, readings, score_readings(readings)
        )


@final
@dataclass(frozen=True, slots=True)
class BearingTrialResult:
    """Readings and score at a place, number of diodes, range [m] and kind of diodes."""

    place: str
    count: int
    range: float | None
    diodes: TrueDiodes
    readings: tuple[BearingReading, ...]
    score: BearingScore

    def to_json(self) -> dict[str, Any]:
        """Convert the score to JSON, without the single readings."""
        return {
            'place': self.place,
            'diodes': self.count,
            'range': self.range,
            'true_response': self.diodes.response,
            'true_gain_spread': self.diodes.gain_spread,
            **self.score.to_json(),
        }


BEARING_STORE: Final = StoreFormat(
    'bearings.jsonl',
    'bearing',
    'study of bearings',
    TypeAdapter(BearingTrialResult),
)


def simulate_random_poses(
    bench: BearingBench, distance: float | None, request: BearingTrialRequest
) -> list[BearingReading]:
    """Return the readings at random poses, each with its own diode gains."""
    # Separate streams for poses and noise keep the poses independent of the number of diodes.
    where, what = (np.random.default_rng([request.seed, k]) for k in range(2))
    readings = []
    for k in range(request.poses):
        pose = draw_pose(bench.scenario, distance, where, math.radians(request.off_axis))
        diodes = bench.sample_diode_gains(what)
        readings.append(bench.estimate_block_bearing(pose, diodes, what))
        report_progress((k + 1) / request.poses)
    return readings


def to_json(results: Sequence[BearingTrialResult], request: BearingTrialRequest) -> dict[str, Any]:
    """Convert the results to JSON; angles in rad, ranges in m."""
    return {
        'vehicle': request.vehicle,
        'poses': request.poses,
        'seed': request.seed,
        'rows': [each.to_json() for each in results],
    }

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Score forecasts of the same flights by several models, beside coasting."""

from collections.abc import Mapping, Sequence
import math
from typing import Final, final, NamedTuple

from lta_discovery.state_filter.forecast_noise import BLOCK
from lta_discovery.state_filter.forecasts import FlightForecasts
from lta_discovery.state_filter.linear_flight import POSE_SIZE
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Names of models
COASTING: Final = 'coasting'
FILE_MODEL: Final = 'vehicle file'
CALIBRATED: Final = 'calibrated'
MAIN: Final = 3.0  # s; horizon of the errors in headlines
FORECAST_DRAWS: Final = 1000  # of a bootstrap
LEAST_BLOCKS: Final = 4  # independent blocks of forecasts; fewer give no interval


@final
class ForecastRms(NamedTuple):
    """RMS errors of some forecasts."""

    position: float  # [m]
    attitude: float  # [rad]
    # Of the position by the heading in which a forecast begins, and upwards [m]
    nose: float
    side: float
    up: float


@final
class LeastRms(NamedTuple):
    """
    RMS errors by a perfect model, which sensors and still air allow.

    Of those forecasts that meet no gap of the tracker; NaN without any.
    """

    position: float  # [m]
    attitude: float  # [rad]


@final
class HorizonErrors(NamedTuple):
    """RMS errors at one horizon, by the name of the model; that of coasting is among them."""

    horizon: float  # [s]
    errors: Mapping[str, ForecastRms]
    forecasts: int  # number
    least: LeastRms

    @property
    def positions(self) -> dict[str, float]:
        """Position errors by model [m]."""
        return {name: one.position for name, one in self.errors.items()}


@final
class ErrorRatio(NamedTuple):
    """Position error of one model by that of another, with a 95 % interval."""

    value: float
    ci95: tuple[float, float]  # NaN with too few forecasts


def score_forecasts(
    forecasts: Mapping[str, Sequence[FlightForecasts]],
) -> tuple[HorizonErrors, ...]:
    """Return the errors at each horizon that was reached; `forecasts`: by model and flight."""
    first = next(iter(forecasts.values()), ())
    out = []
    for h, horizon in enumerate(first[0].horizons if first else ()):
        tables = {
            name: np.concatenate([one.errors[:, h] for one in each])
            for name, each in forecasts.items()
        }
        tables[COASTING] = np.concatenate([one.coasting[:, h] for one in first])
        # The last model knows best where the nose is, if the markers are turned
        headings = np.concatenate([one.headings for one in [*forecasts.values()][-1]])
        measured = ~np.isnan(np.stack(list(tables.values()))).any(axis=(0, 2))
        floor = np.concatenate([one.floor[:, h] for one in [*forecasts.values()][-1]])
        if measured.any():
            rms = {
                name: _summarize_errors(table[measured], headings[measured])
                for name, table in tables.items()
            }
            sizes = floor[measured & np.isfinite(floor).all(axis=1)]
            squares = np.mean(sizes**2, axis=0) if len(sizes) else np.full(POSE_SIZE, np.nan)
            least = LeastRms(*np.sqrt(squares.reshape(2, 3).sum(axis=1)).tolist())
            out.append(HorizonErrors(horizon, rms, int(measured.sum()), least))
    return tuple(out)


def find_main_score(scores: Sequence[HorizonErrors]) -> HorizonErrors | None:
    """Return the errors that headlines state: 3 s ahead, or the furthest below it."""
    near = [one for one in scores if one.horizon <= MAIN]
    return max(near, key=lambda one: one.horizon, default=None)


def _summarize_errors(errors: Array, headings: Array) -> ForecastRms:
    """
    Return RMS errors; infinite where a forecast diverged.

    `errors`: of poses, shape (N, 6). `headings`: in which the forecasts begin, shape (N,).
    """
    nose = np.column_stack([np.cos(headings), np.sin(headings)])
    side = np.column_stack([-nose[:, 1], nose[:, 0]])
    with np.errstate(over='ignore', invalid='ignore'):
        parts = (
            np.linalg.norm(errors[:, :3], axis=1),
            np.linalg.norm(errors[:, 3:], axis=1),
            np.sum(errors[:, :2] * nose, axis=1),
            np.sum(errors[:, :2] * side, axis=1),
            errors[:, 2],
        )
        sizes = (np.where(np.isfinite(one), one, np.inf) for one in parts)
        return ForecastRms(*(float(np.sqrt(np.mean(one**2))) for one in sizes))


def compare_errors(
    model: Sequence[FlightForecasts], other: Sequence[FlightForecasts]
) -> ErrorRatio:
    """
    Return the position error of a model by that of another one, at the main horizon.

    The interval is that of a bootstrap over blocks of 10 s, whose errors are independent.
    """
    main = find_main_score(score_forecasts({'model': model, 'other': other}))
    if main is None:
        return ErrorRatio(math.nan, (math.nan, math.nan))
    h = model[0].horizons.index(main.horizon)
    pairs, blocks = [], []
    for f, (one, two) in enumerate(zip(model, other, strict=True)):
        squares = [np.sum(each.errors[:, h, :3] ** 2, axis=1) for each in (one, two)]
        pairs.append(np.column_stack(squares))
        blocks += [(f, int(start // BLOCK)) for start in one.starts]
    table = np.concatenate(pairs)
    measured = ~np.isnan(table).any(axis=1)
    labels = np.unique(np.array(blocks)[measured], axis=0, return_inverse=True)[1]
    sums = np.zeros((labels.max(initial=-1) + 1, 2))
    np.add.at(sums, labels.ravel(), table[measured])
    return _bootstrap_ratio(sums)


def _bootstrap_ratio(sums: Array) -> ErrorRatio:
    """Return the ratio of two RMS errors from the squares summed in each block, shape (B, 2)."""
    with np.errstate(invalid='ignore', divide='ignore'):
        whole = float(np.sqrt(np.divide(*sums.sum(axis=0))))
        if len(sums) < LEAST_BLOCKS:
            return ErrorRatio(whole, (math.nan, math.nan))
        draws = np.random.default_rng(0).integers(len(sums), size=(FORECAST_DRAWS, len(sums)))
        totals = sums[draws].sum(axis=1)
        low, high = np.percentile(np.sqrt(totals[:, 0] / totals[:, 1]), [2.5, 97.5])
    return ErrorRatio(whole, (float(low), float(high)))

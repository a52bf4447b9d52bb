# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Tell which way z points: by heights above a floor, and by the tilt of what accelerates."""

from typing import Final

from lta_config.constants import STANDARD_GRAVITY
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.kinematics import (
    differentiate,
    fit_scale,
    is_near,
    ScaleFit,
    smooth_acceleration,
)
import numpy as np
from scipy.spatial.transform import Rotation

LOW: Final = 0.05  # heights beyond it say where the floor is [m]
TILT_COSINE: Final = 0.5  # cosine of lean and acceleration that tells up from down
LEVER: Final = 0.6  # largest distance of markers from the axis of a swing [m]


def judge_heights(position: Numbers | None, axis: int = 2) -> tuple[int, str]:
    """Return which way an axis points if the floor is at zero."""
    if position is None:
        return 0, ''
    low, high = np.nanpercentile(position[:, axis], [2.0, 98.0])
    why = f'{"xyz"[axis]} is {low:.3g} to {high:.3g} m, and the floor is at zero'
    if low > -LOW and high > LOW:
        return 1, why
    if high < LOW and low < -LOW:
        return -1, why
    return 0, ''


def describe_heights(position: Numbers | None) -> str:
    """Return why heights do not say which way is up."""
    if position is None:
        return 'no position shows where the floor is'
    low, high = np.nanpercentile(position[:, 2], [2.0, 98.0])
    return f'z is {low:.3g} to {high:.3g} m, on both sides of zero or next to it'


def judge_tilt(turn: Rotation, position: Numbers, seconds: Numbers) -> tuple[int, ScaleFit]:
    """
    Return whether z of the body points up (1) or down (-1), by how a vehicle accelerates.

    0 if that is not the acceleration of a rotorcraft, by g times its lean: that of markers above
    the axis of a swing has the other sign, and says nothing.
    """
    fit = fit_tilt(turn, position, seconds)
    size = is_near(fit.ratio / STANDARD_GRAVITY, 1.0) if np.isfinite(fit.ratio) else False
    if abs(fit.cosine) < TILT_COSINE or not size:
        return 0, fit
    lever = fit_lever(turn, position, seconds)
    swings = lever.cosine > TILT_COSINE and 0.0 < lever.ratio < LEVER
    return (0 if swings else 1 if fit.cosine > 0.0 else -1), fit


def fit_tilt(turn: Rotation, position: Numbers, seconds: Numbers) -> ScaleFit:
    """
    Compare the horizontal acceleration with the lean of the body's z axis.

    A rotorcraft accelerates by g times its lean; a negative cosine means that z points down.
    """
    pull, lean = smooth_acceleration(position, seconds), turn.as_matrix()[:, :, 2]
    return fit_scale(_level(pull), _level(lean), seconds)


def fit_lever(turn: Rotation, position: Numbers, seconds: Numbers) -> ScaleFit:
    """
    Compare the horizontal velocity with the rate of the lean of the body's z axis.

    A point above the axis about which a vehicle swings moves by its lever arm [m], the factor.
    """
    lean = differentiate(turn.as_matrix()[:, :, 2], seconds)
    return fit_scale(_level(differentiate(position, seconds)), _level(lean), seconds)


def upright_share(turn: Rotation) -> float:
    """Return the share of the time with the body's z axis within 60 degrees of the map's."""
    return float(np.mean(turn.as_matrix()[:, 2, 2] > 0.5))


def is_inverted(turn: Rotation) -> bool:
    """Return whether the body's z axis points down nearly all the time."""
    return float(np.percentile(turn.as_matrix()[:, 2, 2], 90.0)) < -0.5


def _level(rows: Numbers) -> Numbers:
    """Return the horizontal parts of vectors, without their means."""
    return np.asarray((rows - np.nanmean(rows, axis=0)) * [1.0, 1.0, 0.0])

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fit of a direction to the diode readings: weighted least squares with priors.

Gauss-Newton on the tangent plane of the direction, over all unknowns of `lta_vlc.reading_model`.
The covariance is the inverse of the normal matrix, which includes the priors on the light and not
noise alone; it grows where the readings do not follow the model.

Plain numbers and sequences: compiled for loops and fleets, plain in the node, with bit-identical
results.
"""

import math
from typing import NamedTuple

from lta_vlc.reading_model import (
    AZIMUTH,
    build_normal_equations,
    DiodeFitInputs,
    DirectionPrior,
    ELEVATION,
    FALL,
    LEAST_ERROR,
    MISFIT_AT,
    NEARNESS,
    NORMAL_AT,
    Numbers,
    PEDESTAL,
    RESPONSE,
    RIGHT_SIDE,
    Scratch,
    STRENGTH,
    UNKNOWNS,
    VALUES,
)

NEAREST_LAMP, STEEPEST_FALL = 0.5, 3.0  # m and 1: beyond them no lamp is sought
# Exponents of the response beyond which none is sought
WIDEST_RESPONSE, NARROWEST_RESPONSE = 0.3, 10.0
FIT_ROUNDS = 12
# Rounds after which steps are halved: a few fits go back and forth over an edge
FULL_STEP_ROUNDS = 5
LONGEST_STEP = 0.3  # longest step on the sphere [rad]
LAST_STEP = 1e-5  # [rad]
FREE_UNKNOWNS = 3  # unknowns without a prior: azimuth, strength and pedestal
VARIANCE_WORTH = 10.0  # readings that the stated variances are worth beside the misfit


class DirectionFit(NamedTuple):
    """The fitted direction."""

    found: bool  # whether there is a direction; everything else is zero without one
    # Unit vector to the lamp, body frame
    x: float
    y: float
    z: float
    # Of azimuth and elevation [rad2]
    azimuth_variance: float
    covariance: float
    elevation_variance: float
    # S and its variance [counts, counts2]
    strength: float
    strength_variance: float
    pedestal: float  # P [counts]


def fit_direction(
    array: DiodeFitInputs,
    expected: DirectionPrior,
    readings: Numbers,
    errors: Numbers,
    scratch: Scratch,
) -> DirectionFit:
    """
    Return the direction to a lamp.

    `readings` are amplitudes, `errors` their standard deviations by noise, infinite for a spoilt
    diode [counts]; `scratch` is work space of `FIT_SCRATCH` numbers.
    """
    x, y, z, top = guess_direction(array, expected, readings, errors, scratch)
    # All diodes dark, dead or spoilt
    if not top > 0.0:
        return failed_fit()
    for turn in range(FIT_ROUNDS):
        build_normal_equations(
            array, expected, readings, errors, scratch, x, y, z, LEAST_ERROR * top
        )
        if not factorize_cholesky(scratch):
            return failed_fit()
        solve_cholesky(scratch)
        along, up = scratch[RIGHT_SIDE + AZIMUTH], scratch[RIGHT_SIDE + ELEVATION]
        length = math.sqrt(along * along + up * up)
        # Full Gauss-Newton steps first
        part = 1.0 if turn < FULL_STEP_ROUNDS else 0.5
        # Limit the step, because the model is linearised on the tangent plane
        if length * part > LONGEST_STEP:
            part = LONGEST_STEP / length
        x, y, z = rotate_direction(x, y, z, part * along, part * up)
        update_unknowns(scratch, top)
        # The unknowns besides the direction are linear or converge with it
        if length < LAST_STEP:
            break
    return build_direction_fit(scratch, x, y, z, variance_inflation(scratch, errors))


def failed_fit() -> DirectionFit:
    """Return the result without a direction."""
    return DirectionFit(False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def variance_inflation(scratch: Scratch, errors: Numbers) -> float:
    """
    Return a factor on variances, at least 1: the reduced chi-square, with a prior of 1.

    Readings that follow the model have a misfit, priors included, of their number less that
    of the unknowns without a prior. A lamp half hidden by the hull, or gains that differ more than
    expected, are not in the model: then the covariance grows with the misfit.
    """
    count = 0
    for i in range(len(errors)):
        if errors[i] < math.inf:
            count += 1
    # A good fit does not shrink the covariance, most of which is that of the priors
    return max(
        1.0,
        (VARIANCE_WORTH + scratch[MISFIT_AT]) / (VARIANCE_WORTH + max(count - FREE_UNKNOWNS, 0)),
    )


def build_direction_fit(
    scratch: Scratch, x: float, y: float, z: float, strange: float
) -> DirectionFit:
    """Return a direction with its covariance, from the last corner of the Cholesky factor."""
    level = math.sqrt(x * x + y * y)
    # Rows of the lower Cholesky factor L; covariance (L L^T)^-1
    last = NORMAL_AT + UNKNOWNS * AZIMUTH
    # Standard deviation of the step to the left [rad]
    side = 1.0 / scratch[last + AZIMUTH]
    if not (level > 0.0 and side < level):
        return failed_fit()  # an azimuth uncertain by a radian or more is useless
    # Row of the elevation
    above = last - UNKNOWNS
    upward = 1.0 / scratch[above + ELEVATION]
    both = -scratch[last + ELEVATION] * upward * side
    # Row of the strength
    strong = 1.0 / scratch[above - UNKNOWNS + STRENGTH]
    lifted = -scratch[above + STRENGTH] * strong * upward
    turned = -(scratch[last + STRENGTH] * strong + scratch[last + ELEVATION] * lifted) * side
    turn = side / level  # multiplied by itself below: a power differs in the last bit
    return DirectionFit(
        True,
        x,
        y,
        z,
        strange * turn * turn,
        strange * both * side / level,
        strange * (upward * upward + both * both),
        scratch[VALUES + STRENGTH],
        strange * (strong * strong + lifted * lifted + turned * turned),
        scratch[VALUES + PEDESTAL],
    )


def guess_direction(
    array: DiodeFitInputs,
    expected: DirectionPrior,
    readings: Numbers,
    errors: Numbers,
    scratch: Scratch,
) -> tuple[float, float, float, float]:
    """Return a first direction, and the highest reading; write first values of the rest."""
    # The lowest reading is the first guess of the pedestal
    low, top = math.inf, 0.0
    for i in range(len(readings)):
        if errors[i] < math.inf and array.gains[i] > 0.0:
            reading = readings[i] / array.gains[i]
            low, top = min(low, reading), max(top, reading)
    x, y = 0.0, 0.0
    for i in range(len(readings)):
        if errors[i] < math.inf and array.gains[i] > 0.0:
            # Weighted mean of the axes, as in the paper
            excess = readings[i] / array.gains[i] - low
            x += excess * array.nx[i]
            y += excess * array.ny[i]
    level = math.sqrt(x * x + y * y)
    for j in range(ELEVATION):
        scratch[VALUES + j] = 0.0
    scratch[VALUES + STRENGTH], scratch[VALUES + PEDESTAL] = top - low, low
    scratch[VALUES + NEARNESS] = expected.nearness
    scratch[VALUES + RESPONSE] = array.response
    if not (level > 0.0 and top < math.inf):
        return 1.0, 0.0, 0.0, 0.0
    # Scale the horizontal part, so that the vector has length 1
    height = math.cos(expected.elevation) / level
    return x * height, y * height, math.sin(expected.elevation), top


def rotate_direction(
    x: float, y: float, z: float, along: float, up: float
) -> tuple[float, float, float]:
    """Return a unit vector after steps to its left and upwards [rad]."""
    # Straight up or down, left is undefined
    level = max(math.sqrt(x * x + y * y), 1e-9)
    a, b, c = (
        x - (along * y + up * z * x) / level,
        y + (along * x - up * z * y) / level,
        z + up * level,
    )
    # A step on the tangent plane leaves the sphere: normalise
    length = math.sqrt(a * a + b * b + c * c)
    return a / length, b / length, c / length


def update_unknowns(scratch: Scratch, top: float) -> None:
    """Add the step to all values but the direction, and clip them to possible values."""
    for j in range(ELEVATION):
        scratch[VALUES + j] += scratch[RIGHT_SIDE + j]
    # A negative strength would point away from the lamp
    scratch[VALUES + STRENGTH] = max(scratch[VALUES + STRENGTH], 1e-3 * top)
    scratch[VALUES + NEARNESS] = min(max(scratch[VALUES + NEARNESS], 0.0), 1.0 / NEAREST_LAMP)
    scratch[VALUES + FALL] = min(max(scratch[VALUES + FALL], -STEEPEST_FALL), STEEPEST_FALL)
    scratch[VALUES + RESPONSE] = min(
        max(scratch[VALUES + RESPONSE], WIDEST_RESPONSE), NARROWEST_RESPONSE
    )


def factorize_cholesky(scratch: Scratch) -> bool:
    """Replace the normal matrix by its Cholesky factor; return whether there is one."""
    # In place, row by row, lower triangle only
    for i in range(UNKNOWNS):
        at = NORMAL_AT + UNKNOWNS * i
        for j in range(i + 1):
            own = NORMAL_AT + UNKNOWNS * j
            rest = scratch[at + j]
            for k in range(j):
                rest -= scratch[at + k] * scratch[own + k]
            if i != j:
                scratch[at + j] = rest / scratch[own + j]
            elif rest > 0.0:
                scratch[at + j] = math.sqrt(rest)
            else:
                return False
    return True


def solve_cholesky(scratch: Scratch) -> None:
    """Replace the right side by the solution, with the factor."""
    # Forward substitution with L
    for i in range(UNKNOWNS):
        rest = scratch[RIGHT_SIDE + i]
        for k in range(i):
            rest -= scratch[NORMAL_AT + UNKNOWNS * i + k] * scratch[RIGHT_SIDE + k]
        scratch[RIGHT_SIDE + i] = rest / scratch[NORMAL_AT + (UNKNOWNS + 1) * i]
    # Backward substitution with its transpose
    for back in range(UNKNOWNS):
        i = UNKNOWNS - 1 - back
        rest = scratch[RIGHT_SIDE + i]
        for k in range(i + 1, UNKNOWNS):
            rest -= scratch[NORMAL_AT + UNKNOWNS * k + i] * scratch[RIGHT_SIDE + k]
        scratch[RIGHT_SIDE + i] = rest / scratch[NORMAL_AT + (UNKNOWNS + 1) * i]

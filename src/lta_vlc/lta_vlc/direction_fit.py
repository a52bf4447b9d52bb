"""
The fit of a direction to what the diodes read: weighted least squares with priors.

Gauss-Newton on the tangent plane of the direction, over all unknowns of `lta_vlc.reading_model`.
The
covariance is the inverse of the normal matrix, it holds what the light may do by the priors, not
noise alone; and it grows where the readings follow no such model.

Plain numbers and sequences: compiled for loops and fleets as it stands, plain in the node, equal
to the last bit.
"""

import math
from typing import NamedTuple

from lta_vlc.reading_model import (
    AZIMUTH,
    build_normal_equations,
    DirectionPrior,
    ELEVATION,
    FAINT,
    FALL,
    FitArray,
    MISFIT,
    NEARNESS,
    NORMAL,
    Numbers,
    PEDESTAL,
    PULLS,
    Scratch,
    STRENGTH,
    UNKNOWNS,
    VALUES,
)

NEAREST, STEEPEST = 0.5, 3.0  # m and 1: beyond them no lamp is sought
ROUNDS = 12
DAMPED = 5  # rounds after which steps are halved: a few fits go back and forth over an edge
STRIDE = 0.3  # longest step on the sphere [rad]
DONE = 1e-5  # [rad]


class DirectionFit(NamedTuple):
    """
    The direction and what came with it.

    Attributes
    ----------
    found : bool
        Whether there is a direction; everything else is zero without one.
    x, y, z : float
        Unit vector to the lamp, body frame.
    azimuth_variance, covariance, elevation_variance : float
        Of azimuth and elevation. [rad2]
    strength, strength_variance : float
        S and its variance. [counts, counts2]
    pedestal : float
        P. [counts]

    """

    found: bool
    x: float
    y: float
    z: float
    azimuth_variance: float
    covariance: float
    elevation_variance: float
    strength: float
    strength_variance: float
    pedestal: float


def fit_direction(
    array: FitArray, expected: DirectionPrior, readings: Numbers, errors: Numbers, scratch: Scratch
) -> DirectionFit:
    """
    Return the direction to a lamp.

    Parameters
    ----------
    array : Array
        The diodes.
    expected : Expected
        What is known of the lamp.
    readings : sequence of float, one a diode
        Amplitudes. [counts]
    errors : sequence of float, one a diode
        Standard deviation of each reading by noise, infinite for one that says blind. [counts]
    scratch : sequence of float
        `FIT_SCRATCH` numbers to write on.

    """
    x, y, z, top = guess_direction(array, expected, readings, errors, scratch)
    if not top > 0.0:
        return failed_fit()
    for turn in range(ROUNDS):
        build_normal_equations(array, expected, readings, errors, scratch, x, y, z, FAINT * top)
        if not factorize_cholesky(scratch):
            return failed_fit()
        solve_cholesky(scratch)
        along, up = scratch[PULLS + AZIMUTH], scratch[PULLS + ELEVATION]
        length = math.sqrt(along * along + up * up)
        part = 1.0 if turn < DAMPED else 0.5
        if length * part > STRIDE:
            part = STRIDE / length
        x, y, z = rotate_direction(x, y, z, part * along, part * up)
        update_unknowns(scratch, top)
        if length < DONE:
            break
    return build_fit(scratch, x, y, z, variance_inflation(scratch, errors))


def failed_fit() -> DirectionFit:
    """Return what is concluded where there is no direction."""
    return DirectionFit(False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def variance_inflation(scratch: Scratch, errors: Numbers) -> float:
    """
    Return by how much the readings are further off than they may be, as a variance; at least 1.

    Of readings that follow the model the misfit, priors included, is as large as they are many. A
    lamp that is half behind the hull is in no model: then the covariance grows with the misfit.
    """
    count = 0
    for i in range(len(errors)):
        if errors[i] < math.inf:
            count += 1
    return max(1.0, scratch[MISFIT] / count)


def build_fit(scratch: Scratch, x: float, y: float, z: float, strange: float) -> DirectionFit:
    """Return a direction with its covariance, which the last corner of the factor holds."""
    level = math.sqrt(x * x + y * y)
    last = NORMAL + UNKNOWNS * AZIMUTH
    side = 1.0 / scratch[last + AZIMUTH]
    if not (level > 0.0 and side < level):
        return failed_fit()  # an azimuth known to a radian at best is none
    above = last - UNKNOWNS
    upward = 1.0 / scratch[above + ELEVATION]
    both = -scratch[last + ELEVATION] * upward * side
    strong = 1.0 / scratch[above - UNKNOWNS + STRENGTH]
    lifted = -scratch[above + STRENGTH] * strong * upward
    turned = -(scratch[last + STRENGTH] * strong + scratch[last + ELEVATION] * lifted) * side
    turn = side / level  # multiplied by itself: a power is another number in the last bit
    return DirectionFit(
        True, x, y, z,
        strange * turn * turn, strange * both * side / level,
        strange * (upward * upward + both * both), scratch[VALUES + STRENGTH],
        strange * (strong * strong + lifted * lifted + turned * turned),
        scratch[VALUES + PEDESTAL],
    )  # fmt: skip


def guess_direction(
    array: FitArray, expected: DirectionPrior, readings: Numbers, errors: Numbers, scratch: Scratch
) -> tuple[float, float, float, float]:
    """Return a first direction, and the highest reading; write first values of the rest."""
    low, top = math.inf, 0.0
    for i in range(len(readings)):
        if errors[i] < math.inf and array.gains[i] > 0.0:
            reading = readings[i] / array.gains[i]
            low, top = min(low, reading), max(top, reading)
    x, y = 0.0, 0.0
    for i in range(len(readings)):
        if errors[i] < math.inf and array.gains[i] > 0.0:
            excess = readings[i] / array.gains[i] - low
            x += excess * array.nx[i]
            y += excess * array.ny[i]
    level = math.sqrt(x * x + y * y)
    for j in range(ELEVATION):
        scratch[VALUES + j] = 0.0
    scratch[VALUES + STRENGTH], scratch[VALUES + PEDESTAL] = top - low, low
    scratch[VALUES + NEARNESS] = expected.nearness
    if not (level > 0.0 and top < math.inf):
        return 1.0, 0.0, 0.0, 0.0
    height = math.cos(expected.elevation) / level
    return x * height, y * height, math.sin(expected.elevation), top


def rotate_direction(
    x: float, y: float, z: float, along: float, up: float
) -> tuple[float, float, float]:
    """Return a unit vector after steps to its left and upwards. [rad]"""
    level = max(math.sqrt(x * x + y * y), 1e-9)
    a, b, c = (
        x - (along * y + up * z * x) / level,
        y + (along * x - up * z * y) / level,
        z + up * level,
    )
    length = math.sqrt(a * a + b * b + c * c)
    return a / length, b / length, c / length


def update_unknowns(scratch: Scratch, top: float) -> None:
    """Add the step to all values but the direction, and keep them within what can be."""
    for j in range(ELEVATION):
        scratch[VALUES + j] += scratch[PULLS + j]
    scratch[VALUES + STRENGTH] = max(scratch[VALUES + STRENGTH], 1e-3 * top)
    scratch[VALUES + NEARNESS] = min(max(scratch[VALUES + NEARNESS], 0.0), 1.0 / NEAREST)
    scratch[VALUES + FALL] = min(max(scratch[VALUES + FALL], -STEEPEST), STEEPEST)


def factorize_cholesky(scratch: Scratch) -> bool:
    """Put the Cholesky factor in place of the normal matrix; tell whether there is one."""
    for i in range(UNKNOWNS):
        at = NORMAL + UNKNOWNS * i
        for j in range(i + 1):
            own = NORMAL + UNKNOWNS * j
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
    """Put the solution in place of the right side, by the factor."""
    for i in range(UNKNOWNS):
        rest = scratch[PULLS + i]
        for k in range(i):
            rest -= scratch[NORMAL + UNKNOWNS * i + k] * scratch[PULLS + k]
        scratch[PULLS + i] = rest / scratch[NORMAL + (UNKNOWNS + 1) * i]
    for back in range(UNKNOWNS):
        i = UNKNOWNS - 1 - back
        rest = scratch[PULLS + i]
        for k in range(i + 1, UNKNOWNS):
            rest -= scratch[NORMAL + UNKNOWNS * k + i] * scratch[PULLS + k]
        scratch[PULLS + i] = rest / scratch[NORMAL + (UNKNOWNS + 1) * i]

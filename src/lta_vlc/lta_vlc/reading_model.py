# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Model of the photodiode readings of a lamp in a room, with priors on its unknowns.

Diode i, with unit axis n_i, place r_i and gain g_i, reads

    M_i = g_i (S f_i (1 + k t r_i.a) + P + s.n_i + b1 (n_x^2 - n_y^2) + b2 2 n_x n_y),
    f_i = max(0, n_i.w_i)^p / |w_i|^(p+2),    w_i = u - k r_i

u is the direction from the middle of the diodes to the lamp, and S the reading of a nominal diode
there that faces it. The other terms bias the bearing; each is an unknown with a prior:

- the exponent p of the diodes' response, by the vehicle file, which no data sheet prints;
- the pedestal P of diffuse light, the same from all sides, and its first and second angular
  harmonics, a slope s and a bend b: the unevenness of the first reflections from floor, walls and
  ceiling;
- the inverse distance k: at 3 m, opposite diodes of a ring of 7 cm radius see the lamp up to 2.7
  degrees apart, and up to 10 % brighter or darker;
- the fall t of the lamp's own beam across the diodes, along the horizontal a to the left of u.

The size of the harmonics goes with B = P S / (S + `MIXED` P): the more often light is reflected,
the more even it is. Beside the lamp's axis the ground is brighter on the side to which the lamp
shines, so that the harmonics across the direction to the lamp follow the fall t of its beam. The
priors are means and spreads of the first reflections at 953 places in 40 random rooms 6 to 14 m
long, 5 to 12 m wide, 2.5 to 6 m high, with an albedo of 0.2 to 0.8, rounded up where large halls
and doors are outside them. `make campaign bearing` tests them (docs/bearing.md).

The variance of a reading is that of its noise, the spread of the gains, and the remaining pattern
of the pedestal. The slope of f is smoothed over a few degrees around the edge of a diode's view,
where the true one jumps.

Plain numbers and sequences, also for the compiler. Only `sqrt`, because `hypot` differs between
platforms.
"""

from collections.abc import MutableSequence, Sequence
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Numbers = Sequence[float] | NDArray[np.float64]
Scratch = MutableSequence[float] | NDArray[np.float64]
# The unknowns; the last two are steps on the sphere. The last three are asked for: in this order
# their covariance stands in the last corner of the factor.
PEDESTAL, SLOPE, BEND, NEARNESS, FALL, RESPONSE = 0, 1, 4, 6, 7, 8
STRENGTH, ELEVATION, AZIMUTH = 9, 10, 11
UNKNOWNS = 12
# Where each part stands in the scratch numbers.
ROW_AT = 0
RIGHT_SIDE = ROW_AT + UNKNOWNS
NORMAL_AT = RIGHT_SIDE + UNKNOWNS
VALUES = NORMAL_AT + UNKNOWNS * UNKNOWNS
MISFIT_AT = VALUES + ELEVATION
FIT_SCRATCH = MISFIT_AT + 1
DIFFUSE_MIXING = 2.5
# Standard deviations, parts of B
SLOPE_DEVIATION, BEND_DEVIATION, PATTERN_DEVIATION = 0.37, 0.13, 0.02
# Mean of the slope towards the lamp, part of B: the ground below it is brightest
GROUND_SLOPE = 0.2
# Slope across the direction, over B t, and its spread over B
FALL_SLOPE, FALL_SLOPE_DEVIATION = 0.2, 0.15
FALL_BEND, FALL_BEND_DEVIATION = 0.1, 0.06  # the same of the bend
LEAST_PEDESTAL = 0.005  # smallest pedestal taken as possible, share of S
# Standard deviation of t: the tangent of the angle at which the beam leaves the lamp
FALL_DEVIATION = 1.0
VIEW_EDGE = 0.05  # half width of the edge of a diode's view, in cosines
AZIMUTH_VARIANCE = math.pi * math.pi / 3.0  # variance of a uniformly distributed azimuth [rad2]
LEAST_ERROR = 1e-6  # least error of a reading, part of the highest


class DiodeFitInputs(NamedTuple):
    """The diodes as the fit takes them; sequences with a value for each diode."""

    # Unit axes, body frame
    nx: Numbers
    ny: Numbers
    nz: Numbers
    # Places relative to their middle [m, body]
    rx: Numbers
    ry: Numbers
    rz: Numbers
    gains: Numbers  # 0 for a diode that is known to be dead
    # Prior of the exponent p: mean and standard deviation
    response: float
    response_deviation: float
    spread: float  # relative standard deviation of the true gains


class DirectionPrior(NamedTuple):
    """Prior on a lamp: mean and standard deviation."""

    elevation: float  # [rad]
    elevation_deviation: float  # [rad]
    nearness: float  # inverse distance [1/m]
    nearness_deviation: float  # [1/m]


def pedestal_unevenness(strength: float, pedestal: float) -> float:
    """Return B, the size of the pedestal's harmonics [counts]."""
    # A fit may step to a negative pedestal
    diffuse = max(pedestal, 0.0) + LEAST_PEDESTAL * strength
    return diffuse * strength / (strength + DIFFUSE_MIXING * diffuse)


def build_normal_equations(
    array: DiodeFitInputs,
    expected: DirectionPrior,
    readings: Numbers,
    errors: Numbers,
    scratch: Scratch,
    x: float,
    y: float,
    z: float,
    least_error: float,
) -> None:
    """Write normal matrix (lower half), right side and misfit at the current values."""
    # Right side and matrix are accumulated below
    for j in range(RIGHT_SIDE, VALUES):
        scratch[j] = 0.0
    scratch[MISFIT_AT] = 0.0
    strength, pedestal = scratch[VALUES + STRENGTH], scratch[VALUES + PEDESTAL]
    uneven = pedestal_unevenness(strength, pedestal)
    for i in range(len(readings)):
        gain = array.gains[i]
        # Spoilt or dead diode
        if not (errors[i] < math.inf and gain > 0.0):
            continue
        seen = compute_jacobian_row(array, i, x, y, z, scratch)
        model = seen + pedestal
        # Slope and bend enter linearly: value times derivative
        for j in range(SLOPE, NEARNESS):
            model += scratch[VALUES + j] * scratch[ROW_AT + j]
        # Standard deviation by the unknown true gain
        unequal = array.spread * gain * (seen + pedestal)
        rough = PATTERN_DEVIATION * gain * uneven
        variance = (
            errors[i] * errors[i] + unequal * unequal + rough * rough + least_error * least_error
        )
        # The model is for reading over gain, hence its variance over gain squared
        weight = gain * gain / variance
        missing = readings[i] / gain - model
        scratch[MISFIT_AT] += weight * missing * missing
        for j in range(UNKNOWNS):
            part = weight * scratch[ROW_AT + j]
            scratch[RIGHT_SIDE + j] += part * missing
            own = NORMAL_AT + UNKNOWNS * j
            for k in range(j + 1):
                scratch[own + k] += part * scratch[ROW_AT + k]
    # A uniform azimuth keeps the matrix regular where the diodes say nothing
    scratch[NORMAL_AT + (UNKNOWNS + 1) * AZIMUTH] += 1.0 / AZIMUTH_VARIANCE
    level = math.sqrt(x * x + y * y)
    # Priors on the other unknowns
    lifted = math.atan2(z, level) - expected.elevation
    add_prior(scratch, ELEVATION, lifted, expected.elevation_deviation)
    near = scratch[VALUES + NEARNESS] - expected.nearness
    add_prior(scratch, NEARNESS, near, expected.nearness_deviation)
    add_prior(scratch, FALL, scratch[VALUES + FALL], FALL_DEVIATION)
    odd = scratch[VALUES + RESPONSE] - array.response
    add_prior(scratch, RESPONSE, odd, array.response_deviation)
    towards = GROUND_SLOPE * uneven
    add_prior(
        scratch, SLOPE + 2, scratch[VALUES + SLOPE + 2] - towards * z, SLOPE_DEVIATION * uneven
    )
    # Slope and bend along the direction and across it, by the cosine and sine of its azimuth
    c, s = (x / level, y / level) if level > 0.0 else (1.0, 0.0)
    add_harmonic_prior(scratch, SLOPE, c, s, 0.0, towards * level, SLOPE_DEVIATION * uneven)
    add_harmonic_prior(
        scratch, SLOPE, -s, c, FALL_SLOPE * uneven, 0.0, FALL_SLOPE_DEVIATION * uneven
    )
    c, s = c * c - s * s, 2.0 * c * s
    add_harmonic_prior(scratch, BEND, c, s, 0.0, 0.0, BEND_DEVIATION * uneven)
    add_harmonic_prior(scratch, BEND, -s, c, FALL_BEND * uneven, 0.0, FALL_BEND_DEVIATION * uneven)


def add_prior(scratch: Scratch, unknown: int, off: float, deviation: float) -> None:
    """Add the prior of one unknown at a deviation from its mean."""
    weight = 1.0 / (deviation * deviation)
    # Diagonal element
    scratch[NORMAL_AT + (UNKNOWNS + 1) * unknown] += weight
    scratch[RIGHT_SIDE + unknown] -= weight * off
    scratch[MISFIT_AT] += weight * off * off


def add_harmonic_prior(
    scratch: Scratch,
    first: int,
    c: float,
    s: float,
    per_fall: float,
    mean: float,
    deviation: float,
) -> None:
    """Add the prior of c h1 + s h2 - per_fall t for the two unknowns h from `first`."""
    weight = 1.0 / (deviation * deviation)
    off = (
        c * scratch[VALUES + first]
        + s * scratch[VALUES + first + 1]
        - per_fall * scratch[VALUES + FALL]
        - mean
    )
    scratch[RIGHT_SIDE + first] -= weight * off * c
    scratch[RIGHT_SIDE + first + 1] -= weight * off * s
    scratch[RIGHT_SIDE + FALL] += weight * off * per_fall
    # Lower half of the outer product; FALL comes after both harmonics
    scratch[NORMAL_AT + (UNKNOWNS + 1) * first] += weight * c * c
    scratch[NORMAL_AT + (UNKNOWNS + 1) * (first + 1)] += weight * s * s
    scratch[NORMAL_AT + UNKNOWNS * (first + 1) + first] += weight * c * s
    scratch[NORMAL_AT + (UNKNOWNS + 1) * FALL] += weight * per_fall * per_fall
    scratch[NORMAL_AT + UNKNOWNS * FALL + first] -= weight * per_fall * c
    scratch[NORMAL_AT + UNKNOWNS * FALL + first + 1] -= weight * per_fall * s
    scratch[MISFIT_AT] += weight * off * off


def compute_jacobian_row(
    array: DiodeFitInputs, i: int, x: float, y: float, z: float, scratch: Scratch
) -> float:
    """Write the derivatives of a diode's reading over its gain; return S f (1 + ...)."""
    nx, ny, nz = array.nx[i], array.ny[i], array.nz[i]
    rx, ry, rz = array.rx[i], array.ry[i], array.rz[i]
    near, fall = scratch[VALUES + NEARNESS], scratch[VALUES + FALL]
    level = max(math.sqrt(x * x + y * y), 1e-9)
    ax, ay = -y / level, x / level  # to the left of the direction
    bx, by = -z * x / level, -z * y / level  # and, with `level`, upwards
    # Direction from this diode to the lamp, in units of the distance
    wx, wy, wz = x - near * rx, y - near * ry, z - near * rz
    cosine = nx * wx + ny * wy + nz * wz
    square = wx * wx + wy * wy + wz * wz
    p = scratch[VALUES + RESPONSE]
    # |w|^-(p+2): normalises the cosine, and the inverse square
    thinned = square ** (-0.5 * p - 1.0)
    response = cosine**p * thinned if cosine > 0.0 else 0.0
    # Smooth stand-in for |cos|, so that the slope is continuous at the edge
    edge = math.sqrt(cosine * cosine + VIEW_EDGE * VIEW_EDGE)
    # Offset of the diode to the left, across the beam
    left = rx * ax + ry * ay
    beam = 1.0 + near * fall * left
    strength = scratch[VALUES + STRENGTH]
    # Derivative by the cosine
    sharp = strength * beam * p * (0.5 * (cosine + edge)) ** p / edge * thinned
    # Derivative by the distance
    wide = strength * beam * (p + 2.0) * response / square
    scratch[ROW_AT + AZIMUTH] = sharp * (nx * ax + ny * ay) + wide * near * left
    scratch[ROW_AT + ELEVATION] = sharp * (nx * bx + ny * by + nz * level) + wide * near * (
        rx * bx + ry * by + rz * level
    )
    scratch[ROW_AT + STRENGTH] = beam * response
    scratch[ROW_AT + PEDESTAL] = 1.0
    scratch[ROW_AT + SLOPE], scratch[ROW_AT + SLOPE + 1], scratch[ROW_AT + SLOPE + 2] = nx, ny, nz
    scratch[ROW_AT + BEND], scratch[ROW_AT + BEND + 1] = nx * nx - ny * ny, 2.0 * nx * ny
    scratch[ROW_AT + NEARNESS] = (
        wide * (wx * rx + wy * ry + wz * rz)
        - sharp * (nx * rx + ny * ry + nz * rz)
        + strength * response * fall * left
    )
    scratch[ROW_AT + FALL] = strength * response * near * left
    # Derivative of a power by its exponent; towards the edge of the view it goes to zero
    narrower = math.log(cosine / math.sqrt(square)) if cosine > 0.0 else 0.0
    scratch[ROW_AT + RESPONSE] = strength * beam * response * narrower
    return strength * beam * response

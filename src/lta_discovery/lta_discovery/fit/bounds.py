"""Bound the parameters of a fit, and tolerances to some standard deviations."""

from collections.abc import Sequence
import math
from typing import Final

from lta_discovery.fit.evidence import Prior
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Standard deviations by which a fit may move a tolerance from the vehicle file (if it can also be
# an effect, of both combined). Larger deviations stay unexplained and are reported
# (`find_exceeded_tolerances`).
FARTHEST: Final = 6.0


def apply_parameters(
    nominal: NominalVehicle, knobs: Sequence[FreeParameter], values: Array
) -> tuple[NominalVehicle, Array]:
    """Return the vehicle with the parameters set, and the values clipped to their bounds."""
    out = clip_to_bounds(knobs, values)
    for k, knob in enumerate(knobs):
        # A value of 0 must leave the vehicle unchanged: applying it would enable the effect
        if out[k] != 0.0:
            nominal = knob.apply_to(nominal, float(out[k]))
    return nominal, out


def parameter_bounds(knobs: Sequence[FreeParameter], prior: Prior) -> tuple[Array, Array]:
    """
    Return lower and upper bounds of the shared parameters, two ndarrays of shape (G,).

    The bounds of each parameter, and FARTHEST standard deviations for a tolerance.
    """
    spread = np.sqrt(np.diag(prior.covariance))
    far = np.full(len(spread), np.inf)
    low, high = -far, far.copy()
    for k, knob in enumerate(knobs):
        if _is_tolerance(knob, spread[k]):
            # Tolerance and effect are independent, so their deviations add in quadrature
            far[k] = FARTHEST * math.hypot(knob.tolerance, knob.typical)
        low[k], high[k] = knob.low, knob.high
    return np.maximum(low, prior.mean - far), np.minimum(high, prior.mean + far)


def bound_mean(mean: Array, covariance: Array, low: Array, high: Array) -> Array:
    """
    Return the most probable values within bounds, of a Gaussian.

    Values beyond a bound are set to it, and the others to their mean given these.
    """
    out, held = mean, np.zeros(len(mean), dtype=np.bool_)
    while (beyond := ~held & ((out < low) | (out > high))).any():
        held |= beyond
        at = np.flatnonzero(held)
        off = (mean - np.clip(out, low, high))[at]
        out = mean - covariance[:, at] @ np.linalg.solve(covariance[np.ix_(at, at)], off)
    return np.clip(out, low, high)


def find_exceeded_tolerances(
    knobs: Sequence[FreeParameter], prior: Prior, mean: Array
) -> list[str]:
    """
    Return the tolerances that the data want beyond their bounds.

    `mean`, shape (G,): unbounded posterior mean (`ParameterPosterior.mean`).
    """
    low, high = parameter_bounds(knobs, prior)
    spread = np.sqrt(np.diag(prior.covariance))
    return [
        knob.name
        for k, knob in enumerate(knobs)
        if _is_tolerance(knob, spread[k]) and not low[k] <= mean[k] <= high[k]
    ]


def format_bounds_warning(names: Sequence[str]) -> list[str]:
    """Return a warning about exceeded tolerances, if there are any."""
    if not names:
        return []
    return [
        f'To explain the flights, these parameters would have to differ from the vehicle file by '
        f'more than {FARTHEST:g} standard deviations of their tolerance: {", ".join(names)}. '
        'Measure them again.'
    ]


def _is_tolerance(knob: FreeParameter, spread: float) -> bool:
    """Return whether a parameter is free by its tolerance only, not as a named effect."""
    # The margin is for rounding of the square root; a named effect widens the spread
    return 0.0 < spread < (1.0 + 1e-9) * knob.tolerance


def clip_to_bounds(knobs: Sequence[FreeParameter], values: Array) -> Array:
    """Clip values to their bounds; the trailing sensor errors have none."""
    out = values.copy()
    for k, knob in enumerate(knobs):
        out[k] = min(max(values[k], knob.low), knob.high)
    return out

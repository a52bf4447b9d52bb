"""How far a fit may turn a knob: its bounds, and for a tolerance some standard deviations."""

from collections.abc import Sequence
import math
from typing import Final

from lta_discovery.fit.evidence import Prior
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Standard deviations that a fit may take a tolerance from the vehicle file (where it can be an
# effect too, of both). What wants to go further is left unexplained, and said
# (`find_strained_tolerances`).
FARTHEST: Final = 6.0


def apply_parameters(
    nominal: NominalVehicle, knobs: Sequence[FreeParameter], values: Array
) -> tuple[NominalVehicle, Array]:
    """Return the vehicle with its knobs at values, and those values within their bounds."""
    out = clip_to_bounds(knobs, values)
    for k, knob in enumerate(knobs):
        if out[k] != 0.0:
            nominal = knob.apply_to(nominal, float(out[k]))
    return nominal, out


def parameter_bounds(knobs: Sequence[FreeParameter], prior: Prior) -> tuple[Array, Array]:
    """
    Return between which values a fit may put what flights share, two ndarrays of shape (G,).

    The bounds of each knob, and for a tolerance FARTHEST standard deviations.
    """
    spread = np.sqrt(np.diag(prior.covariance))
    far = np.full(len(spread), np.inf)
    low, high = -far, far.copy()
    for k, knob in enumerate(knobs):
        if _is_tolerance(knob, spread[k]):
            far[k] = FARTHEST * math.hypot(knob.tolerance, knob.typical)
        low[k], high[k] = knob.low, knob.high
    return np.maximum(low, prior.mean - far), np.minimum(high, prior.mean + far)


def find_strained_tolerances(
    knobs: Sequence[FreeParameter], prior: Prior, mean: Array
) -> list[str]:
    """
    Return the tolerances that the data would put further from the vehicle file than they may be.

    Parameters
    ----------
    knobs : sequence of Knob
        All.
    prior : Prior
        Of the fit.
    mean : ndarray, shape (G,)
        What is most probable, if nothing but the prior held it (`Fitted.mean`).

    """
    low, high = parameter_bounds(knobs, prior)
    spread = np.sqrt(np.diag(prior.covariance))
    return [
        knob.name
        for k, knob in enumerate(knobs)
        if _is_tolerance(knob, spread[k]) and not low[k] <= mean[k] <= high[k]
    ]


def format_strained_tolerances(names: Sequence[str]) -> list[str]:
    """Return a sentence on tolerances that are not enough, if there are any."""
    if not names:
        return []
    return [
        f'The flights want more than {FARTHEST:g} standard deviations of tolerance for '
        f'{", ".join(names)}.'
    ]


def _is_tolerance(knob: FreeParameter, spread: float) -> bool:
    """Tell whether a knob is free by its tolerance, and not as an effect that was named."""
    return 0.0 < spread < (1.0 + 1e-9) * knob.tolerance


def clip_to_bounds(knobs: Sequence[FreeParameter], values: Array) -> Array:
    """Return values within their bounds; the last, of SENSORS, have none."""
    out = values.copy()
    for k, knob in enumerate(knobs):
        out[k] = min(max(values[k], knob.low), knob.high)
    return out

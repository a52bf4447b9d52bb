"""
Widen posteriors by model errors that flights of one vehicle cannot reveal.

Errors of integrator, command timing and sensor filters are the same in all flights. Their size
(`PART`, `LEAST`) was calibrated on simulated truths. An effect outside the library follows the
motion, and does not average out over pieces as the latent wrench does; if there is one, all values
are less certain. A value that the vehicle file states with a tolerance also takes up errors in the
form of its effect, such as another exponent of drag: a part of the tolerance counts as such.
"""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_discovery.fit.evidence import ParameterPosterior
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NORMAL: Final = 1.96  # standard deviations; half width of a 95 % interval
BESIDE: Final = 1.2  # factor on the deviations, if an effect outside the library remains
PART: Final = 0.005  # of the value; smallest deviation
FORM: Final = 0.2  # of the tolerance; deviation for an error in the form of an effect
# Smallest absolute deviations: over a flight, half a millisecond of the 40 ms grid.
LEAST: Final[Mapping[str, float]] = {'clock_skew.skew': 5e-6}


def parameter_deviations(
    posterior: ParameterPosterior, parameters: Sequence[FreeParameter], has_remainder: bool
) -> Array:
    """Return the standard deviations of parameters, including model errors."""
    wider, count = BESIDE if has_remainder else 1.0, len(parameters)
    own, mean = np.diag(posterior.covariance)[:count], posterior.mean[:count]
    least = np.array([LEAST.get(knob.name, 0.0) for knob in parameters])
    # Errors of single flights differ between them and average out
    form = np.array([0.0 if knob.per_flight else FORM * knob.tolerance for knob in parameters])
    out: Array = np.sqrt(wider**2 * own + (PART * mean) ** 2 + least**2 + form**2)
    return out

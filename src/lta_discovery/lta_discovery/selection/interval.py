"""
How well a value is known: what its flights say, and what the model itself may be off by.

An integrator, a command that takes over within a few milliseconds, a sensor's filter are off by
what no flight of the same vehicle can show: by how much (`PART`, `LEAST`) was found on hidden
truths. What is outside the library follows the motion, and so does not average out over the pieces
as the latent wrench does that stands for it: beside it every value is known less well.
"""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_discovery.fit.evidence import ParameterPosterior
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NORMAL: Final = 1.96  # deviations, of the 95 % interval
BESIDE: Final = 1.2  # factor on the deviations, where something outside the library remains
PART: Final = 0.005  # of the value, that it is off by at least
# And by so much, whatever the value: over a flight, half a millisecond of a grid of 40.
LEAST: Final[Mapping[str, float]] = {'clock_skew.skew': 5e-6}


def parameter_deviations(
    posterior: ParameterPosterior, parameters: Sequence[FreeParameter], has_remainder: bool
) -> Array:
    """
    Return standard deviations of knobs, with what the model itself may be off by.

    Parameters
    ----------
    found : Fitted
        The knobs after the data.
    known : sequence of Knob
        In their order.
    beside : bool
        Whether something remains that is outside the library.

    Returns
    -------
    ndarray, shape (K,)
        In the units of the knobs.

    """
    wider, count = BESIDE if has_remainder else 1.0, len(parameters)
    own, mean = np.diag(posterior.covariance)[:count], posterior.mean[:count]
    least = np.array([LEAST.get(knob.name, 0.0) for knob in parameters])
    out: Array = np.sqrt(wider**2 * own + (PART * mean) ** 2 + least**2)
    return out

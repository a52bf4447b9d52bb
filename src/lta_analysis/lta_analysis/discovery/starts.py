"""
Where a fit begins with an effect that jumps: no slope at one value tells of another.

A deadband lets a command through or not, so the evidence over its threshold has steps where
commands lie; a Newton step from 0 goes astray. A few values are tried and the best is the start.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from lta_analysis.discovery.evidence import fitted, Pieces, Prior
from lta_analysis.discovery.knobs import Knob
from lta_analysis.discovery.linear import Point
from lta_analysis.discovery.linearise import Linearised
from lta_config.errors import BadInput
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# In typical sizes.
TRIED: Final[Mapping[str, tuple[float, ...]]] = {
    'motor_deadband.threshold': (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0)
}


def begun(
    flight: Linearised,
    prior: Prior,
    begin: Point,
    deviations: Array,
    named: Sequence[str],
) -> Point:
    """
    Return where a fit should begin.

    Parameters
    ----------
    flight, prior, begin, deviations
        As for `fit`.
    named : sequence of str
        The effects that are in the model now.

    Returns
    -------
    Point
        `begin` itself, unless an effect that jumps is in the model and another value of it is
        more probable.

    """
    for k, knob in enumerate(flight.knobs):
        if knob.name in named and knob.name in TRIED and begin.values[k] == 0.0:
            points = [begin, *_aside(flight.knobs, begin, k)]
            scores = [_score(flight, point, prior, deviations) for point in points]
            begin = points[int(np.argmax(scores))]
    return begin


def _aside(knobs: Sequence[Knob], begin: Point, k: int) -> list[Point]:
    """Return the point with one knob at each of the values that are tried."""
    knob, out = knobs[k], []
    for size in TRIED[knob.name]:
        value = size * knob.typical
        if knob.low <= value <= knob.high:
            values = begin.values.copy()
            values[k] = value
            out.append(replace(begin, nominal=knob.turned(begin.nominal, value), values=values))
    return out


def _score(flight: Linearised, point: Point, prior: Prior, deviations: Array) -> float:
    """Return the log evidence about a point."""
    try:
        reduced = Pieces(flight.at(point)).reduced(deviations)
    except BadInput:
        return -np.inf
    return fitted(reduced, point.values, prior).log_evidence

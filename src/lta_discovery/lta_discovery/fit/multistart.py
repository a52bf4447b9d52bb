"""
Choose the start of a fit for effects with discontinuous evidence.

A motor deadband passes a command or not, so the evidence has steps at the commanded values, and a
Newton step from 0 fails. Several values are tried, and the best is the start.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.fit.evidence import compute_posterior, Prior
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.fit.joint_fit import JointFitter
from lta_discovery.replay.linearized_flight import LinearizationPoint
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Trial values, in typical sizes.
TRIED: Final[Mapping[str, tuple[float, ...]]] = {
    'motor_deadband.threshold': (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0)
}


def choose_start(
    fitter: JointFitter,
    prior: Prior,
    begin: LinearizedGroup,
    deviations: Array,
    named: Sequence[str],
) -> LinearizedGroup:
    """
    Return where a fit should start.

    This is `begin`, unless another value of a discontinuous effect is more probable.
    """
    for k, knob in enumerate(fitter.flights[0].knobs):
        # A value other than 0 was fitted before and is a good start already
        if knob.name in named and knob.name in TRIED and begin.at[k] == 0.0:
            groups = [begin, *_linearize_trials(fitter, begin, k, prior)]
            scores = [_log_evidence(group, prior, deviations) for group in groups]
            best = groups[int(np.argmax(scores))]
            if best is not begin:
                # The trials have only the free columns; the fit needs all
                begin = fitter.linearize_flights(
                    best.at, [linear.point for linear in best.linears]
                )
    return begin


def _linearize_trials(
    fitter: JointFitter, begin: LinearizedGroup, k: int, prior: Prior
) -> list[LinearizedGroup]:
    """Return the flights about each trial value of one parameter."""
    knob, out = fitter.flights[0].knobs[k], []
    for size in TRIED[knob.name]:
        value = size * knob.typical
        if knob.low <= value <= knob.high:
            at = begin.at.copy()
            at[k] = value
            try:
                points = [
                    _set_parameter(fitter, linear.point, k, value) for linear in begin.linears
                ]
                out.append(fitter.linearize_flights(at, points, prior))
            except BadInput:
                continue
    return out


def _set_parameter(
    fitter: JointFitter, point: LinearizationPoint, k: int, value: float
) -> LinearizationPoint:
    """Return a point with one parameter changed."""
    values = point.values.copy()
    values[k] = value
    knob = fitter.flights[0].knobs[k]
    return replace(point, nominal=knob.apply_to(point.nominal, value), values=values)


def _log_evidence(group: LinearizedGroup, prior: Prior, deviations: Array) -> float:
    """Return the log evidence about a point; -inf where it is undefined."""
    try:
        return compute_posterior(group.reduce_flights(deviations), group.at, prior).log_evidence
    except np.linalg.LinAlgError:
        return -np.inf

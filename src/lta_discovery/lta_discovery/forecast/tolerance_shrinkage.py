"""
Scale the fitted tolerances to the share that forecasts best.

A fit has a latent wrench to help it; a forecast has not. Where an effect is missing, tolerances
absorb part of it, and the tuned model may forecast worse than the vehicle file. Therefore the
flights of the fit are forecast with all, parts and none of its tolerances, and the best share is
used. Named effects never change.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.fit.misfit import forecast_error
from lta_discovery.replay.linearized_flight import LinearizationPoint, zero_unknowns
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHARES: Final = (1.0, 0.5, 0.25, 0.0)  # of the fitted tolerances
BETTER: Final = 0.98  # of the error; a smaller share has to be better than this


def shrink_tolerances(fitter: JointFitter, joint: JointFit, named: Iterable[int] = ()) -> JointFit:
    """
    Return a fit with the share of its tolerances that forecasts its own flights best.

    `named`: indices of the named effects' parameters, which keep their values.
    """
    mean, held = joint.fitted.mean, np.zeros(len(joint.fitted.mean), dtype=np.bool_)
    held[list(named)] = True
    best, least = mean, np.inf
    for share in SHARES:
        at = np.where(held, mean, share * mean)
        error = forecast_error(fitter.flights, _build_forecast_points(fitter, joint, at))
        if error < (BETTER if np.isfinite(least) else 1.0) * least:
            best, least = at, error
    return replace(joint, fitted=joint.fitted._replace(mean=best))


def _build_forecast_points(
    fitter: JointFitter, joint: JointFit, at: Array
) -> list[LinearizationPoint]:
    """Return the point of each flight's forecasts: shared values, and its own errors."""
    out, own = [], fitter.variance > 0.0
    for flight, linear in zip(fitter.flights, joint.group.linears, strict=True):
        # Each flight keeps its own deviation from the shared value
        values = np.where(own, linear.point.values - joint.group.at + at, at)
        vehicle, values = apply_parameters(fitter.nominal, flight.knobs, values)
        out.append(LinearizationPoint(vehicle, values, zero_unknowns(flight.replay.cut)))
    return out

"""
How much of the fitted tolerances to forecast with: as much as makes the forecasts best.

A fit is helped by a latent wrench all along; a forecast is not. Where something is missing that
has no name, the tolerances take up what they can of it, and a model tuned so may forecast worse
than the vehicle file. So the flights that the fit knows are forecast with all of its tolerances,
with parts of them and with none, and the best is kept. What was named is never changed.
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
BETTER: Final = 0.98  # of the error with all of them; what is better by less is no reason


def shrink_tolerances(fitter: JointFitter, joint: JointFit, named: Iterable[int] = ()) -> JointFit:
    """
    Return a fit with the share of its tolerances that forecasts its own flights best.

    Parameters
    ----------
    fitter : Fitter
        The flights.
    joint : Joint
        Their fit.
    named : iterable of int
        Which knobs are effects that were named.

    """
    mean, held = joint.fitted.mean, np.zeros(len(joint.fitted.mean), dtype=np.bool_)
    held[list(named)] = True
    best, least = mean, np.inf
    for share in SHARES:
        at = np.where(held, mean, share * mean)
        error = forecast_error(fitter.flights, _build_points(fitter, joint, at))
        if error < (BETTER if np.isfinite(least) else 1.0) * least:
            best, least = at, error
    return replace(joint, fitted=joint.fitted._replace(mean=best))


def _build_points(fitter: JointFitter, joint: JointFit, at: Array) -> list[LinearizationPoint]:
    """Return where each flight's forecasts begin: what is shared, and its own errors."""
    out, own = [], fitter.variance > 0.0
    for flight, linear in zip(fitter.flights, joint.group.linears, strict=True):
        values = np.where(own, linear.point.values - joint.group.at + at, at)
        vehicle, values = apply_parameters(fitter.nominal, flight.knobs, values)
        out.append(LinearizationPoint(vehicle, values, zero_unknowns(flight.replay.cut)))
    return out

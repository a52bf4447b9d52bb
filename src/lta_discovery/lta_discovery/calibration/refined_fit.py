"""
Refine a calibration by the likelihood of every reading, which also gives the intervals.

States of each piece and a slowly varying unexplained wrench are free, as in discovery, so that the
intervals contain what the model does not explain.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.calibration.coarse_fit import CoarseCalibration
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, wrench_floor
from lta_discovery.fit.joint_fit import JointFit, JointFitter, REST
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import NET_LIFT
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.knot_count import count_needed_knots
from lta_discovery.replay.linearized_flight import LinearizationPoint, SENSORS, zero_unknowns
import numpy as np

LOOSE: Final = 3.0  # nats; convergence criterion of a fit with more noise than the tracker's


def refine_calibration(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    coarse: CoarseCalibration,
    noise: float = 1.0,
) -> JointFit | None:
    """
    Return the joint fit of all flights from a coarse calibration; None if it does not converge.

    `noise`: factor on the noise of the readings. With a larger one, it is enough that the evidence
    settles to some nats: values and deviations of the latent wrench may alternate around the best.

    Values and intervals of a fit that stopped on the way are those of a linearization elsewhere.
    """
    knobs = flights[0].knobs
    near = apply_parameters(nominal, knobs, coarse.values)[0]
    knots = count_needed_knots(flights, near)
    flights = [one.with_knots(knots).with_reference(near).with_noise(noise) for one in flights]
    lift = next(k for k, knob in enumerate(knobs) if knob.name == NET_LIFT)
    points = []
    for one, force in zip(flights, coarse.lifts, strict=True):
        values = coarse.values.copy()
        values[lift] += force
        vehicle, values = apply_parameters(nominal, knobs, values)
        values = np.append(values, np.zeros(len(SENSORS)))
        points.append(LinearizationPoint(vehicle, values, zero_unknowns(one.replay.cut)))
    floor = wrench_floor(nominal)
    fitter = JointFitter(nominal, flights, per_flight_variance(knobs), floor)
    prior = build_shared_prior(knobs)
    at = np.append(coarse.values, np.zeros(len(SENSORS)))
    try:
        begin = fitter.linearize_flights(at, points, prior)
        fit = fitter.fit(prior, begin, floor, rest=REST if noise == 1.0 else LOOSE, narrow=True)
    except (BadInput, np.linalg.LinAlgError):
        return None
    if not fit.is_converged:
        return None
    # Bounded, as the values are used
    mean = fitter.propose_step(fit)[0]
    return replace(fit, fitted=fit.fitted._replace(mean=mean))

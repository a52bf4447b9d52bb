# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Take the result of a calibration as the prior of a discovery."""

from collections.abc import Sequence
from dataclasses import replace
import math
from typing import Final

from lta_discovery.calibration.result import CalibratedValue, WIDE
from lta_discovery.model.calibration_parameters import (
    BY_EYE,
    GAIN_NAMES,
    HEADING,
    list_marker_parameters,
    ordinary_tolerances,
    PER_FLIGHT,
    prior_deviation,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, GAIN_SPREAD, NET_LIFT_FORCE

NO_THRUST: Final = 0.05  # relative; a rotor with less has an uncertain thrust


def apply_calibration(
    knobs: Sequence[FreeParameter], nominal: NominalVehicle, values: Sequence[CalibratedValue]
) -> list[FreeParameter]:
    """
    Return the free parameters of a discovery after a calibration, those of the markers included.

    A calibrated number is as well known as in a vehicle that was measured with care, or as its
    interval says if that is wider. It is no candidate: what calibration explains is no effect.

    `nominal`: the calibrated vehicle.
    """
    usual = ordinary_tolerances(nominal)
    by_name = {one.name: one for one in values}
    out = []
    for knob in [*knobs, *list_marker_parameters()]:
        one = by_name.get(knob.name)
        is_fitted = knob.name == HEADING and one is not None and one.is_known
        if one is None or not (knob.is_calibration or knob.name in PER_FLIGHT or is_fitted):
            out.append(knob)
            continue
        own = knob.name in PER_FLIGHT
        tolerance = max(usual.get(knob.name, 0.0), _posterior_deviation(one))
        if own:
            tolerance = _flight_deviation(knob, nominal, values)
        elif knob.name in GAIN_NAMES:
            tolerance = max(GAIN_SPREAD * abs(one.value), one.deviation)
        low = -math.inf if own else knob.low
        out.append(
            replace(
                knob,
                tolerance=tolerance,
                typical=0.0,
                low=low,
                per_flight=knob.per_flight or own,
            )
        )
    return out


def free_flight_lifts(
    knobs: Sequence[FreeParameter], nominal: NominalVehicle
) -> list[FreeParameter]:
    """Return the free parameters with a net lift that each flight may have of its own."""
    return [
        replace(knob, tolerance=prior_deviation(knob, nominal), typical=0.0, low=-math.inf)
        if knob.name == NET_LIFT_FORCE
        else knob
        for knob in knobs
    ]


def _flight_deviation(
    knob: FreeParameter, nominal: NominalVehicle, values: Sequence[CalibratedValue]
) -> float:
    """Return the standard deviation of what each flight has of its own."""
    if knob.name == NET_LIFT_FORCE:
        # That of other flights does not tell it
        return prior_deviation(knob, nominal)
    trends = [one.value for one in values if one.name == knob.name]
    return max(BY_EYE[knob.name], math.sqrt(sum(each**2 for each in trends) / len(trends)))


def _posterior_deviation(one: CalibratedValue) -> float:
    """Return the standard deviation of a calibrated number, in the unit of its parameter."""
    if one.name.startswith('vehicle.'):
        return math.log(one.ci95[1] / one.ci95[0]) / (2.0 * WIDE)
    if one.name.endswith('.thrust'):
        # Relative to the calibrated thrust
        return one.deviation / max(abs(one.value), NO_THRUST)
    return one.deviation

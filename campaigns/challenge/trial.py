# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly one case, study it as `lta discover` does, and compare the names with the answer."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
import math
from pathlib import Path
from tempfile import TemporaryDirectory
import time
from typing import Any, Final

from lta_config.errors import BadInput
from lta_discovery.discovery.conclusion import draw_conclusion
from lta_discovery.discovery.run import DiscoveryRequest, study_usable_flights
from lta_discovery.discovery.study import Discovery
from lta_discovery.flights.bags import read_bags
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.model.candidates import vector_components
from lta_discovery.posterior.missing_elements import LEARNING, LINEARIZATIONS
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.parameter_fit import fit_likelihood
from lta_model.effects.protocol import AXES
from lta_model.vehicle import load_vehicle
import numpy as np

from campaigns.challenge.case_generator import ChallengeCase, Kind, OtherCaseGenerator, SECONDS
from campaigns.challenge.recording import write_bag

VEHICLE: Final = 'gtmab'
WIDE: Final = (
    10.0  # typical sizes; prior deviation of a hidden effect, which tells next to nothing
)
# Effects with the same columns in every flight of this vehicle, fixed before anything was scored:
# cosines of 0.98 or more between what states, forces and all tolerances leave of them
INDISTINGUISHABLE: Final = (
    ('steady_wind.x', 'wind_gradient.x_z'),
    ('steady_wind.y', 'wind_gradient.y_z'),
    ('gas_purity.purity', 'ballast.mass', 'payload.mass', 'net_lift.force'),
    ('added_mass.surge', 'added_mass.sway'),
    ('tracker_delay.delay', 'clock_offset.offset'),
)
# Hidden drag follows the speed to the power of 1.9, as quadratic and linear drag do together
BESIDE: Final = {f'quadratic_drag.{axis}': f'linear_drag.{axis}' for axis in AXES[:3]}
CLASSES: Final = {name: group[0] for group in INDISTINGUISHABLE for name in group}


def run_trial(
    seed: int, kind: Kind | None, number: int, seconds: tuple[float, float] = SECONDS
) -> dict[str, Any]:
    """
    Study one case, and compare the result with the answer.

    `seconds`: range of the lengths of its flights.

    Returns
    -------
    dict
        JSON data: what was hidden and how visible it is, what was named, intervals, errors, time.

    """
    vehicle = load_vehicle(VEHICLE)
    case = OtherCaseGenerator(vehicle, seed, number, kind, seconds).generate_case()
    answer, begin = case.answer, time.process_time()
    hidden = {one['knob']: float(one['value']) for one in answer['hidden']}
    result: dict[str, Any] = {
        'number': number, 'kind': answer['kind'], 'hidden': hidden, 'outside': answer['outside'],
        'floors': answer['size'], 'refused': '',
    }  # fmt: skip
    try:
        study = _study(case)
    except BadInput as fault:
        return {**result, 'refused': str(fault), 'cpu_s': time.process_time() - begin}
    seconds = time.process_time() - begin
    main = study.comparison.main
    return {
        **result,
        **compare_names([one.present.names for one in study.named if one.estimates], hidden),
        'verdict': draw_conclusion(study).verdict,
        'forces': [one.present.names[0] for one in study.named if not one.estimates],
        'sigma': measure_strength(study, hidden) if hidden else {},
        'intervals': _list_intervals(study, answer['nominal']['given']),
        'errors': {name: each.position for name, each in main.errors.items()} if main else {},
        'cpu_s': seconds,
    }


def _study(case: ChallengeCase) -> Discovery:
    """Record the flights of a case and study them."""
    vehicle = load_vehicle(VEHICLE)
    with TemporaryDirectory(prefix='lta-case-') as scratch:
        bags: dict[str, list[Path]] = {}
        for flight in case.flights:
            bag = Path(scratch) / flight.name
            write_bag(bag, flight.streams, vehicle.rotor_names, {'case': str(case.number)})
            bags.setdefault(flight.role, []).append(bag)
        usable = select_usable_flights(read_bags(bags), vehicle)
    request = DiscoveryRequest.of_bags(VEHICLE, bags)
    return study_usable_flights(request, vehicle, usable, lambda _what, _part: None)[0]


def compare_names(
    named: Sequence[Sequence[str]], hidden: Mapping[str, float]
) -> dict[str, list[str]]:
    """
    Return what was named, what was missed, and what is wrong.

    `named`: of each element, its name and those that cannot be told from it. Effects of one line
    of `INDISTINGUISHABLE` count as one. What may be named beside a hidden effect is in `BESIDE`.
    """

    def name_classes(names: Sequence[str]) -> set[str]:
        return {CLASSES.get(one, one) for name in names for one in vector_components(name)}

    right = [name_classes([one]) for one in hidden]
    groups = [name_classes(one) for one in named]
    allowed = [*right, {BESIDE[one] for one in hidden if one in BESIDE}]
    return {
        'named': [' or '.join(one) for one in named],
        'missed': [one for one, own in zip(hidden, right, strict=True)
                   if not any(own & group for group in groups)],
        'wrong': [one[0] for one, group in zip(named, groups, strict=True)
                  if not any(own & group for own in allowed)],
    }  # fmt: skip


def measure_strength(study: Discovery, hidden: Mapping[str, float]) -> dict[str, float]:
    """
    Return the size of each hidden effect by its standard deviation.

    That of a fit that knows what is hidden, and starts at the truth, with the tolerance of the
    vehicle in the same number.
    """
    shared = study.missing.parameters
    at = [k for k, one in enumerate(shared) if one.name in hidden and not one.per_flight]
    free = [k for k, one in enumerate(shared) if one.tolerance > 0.0 or k in at]
    wide = {k: math.hypot(shared[k].tolerance, WIDE * shared[k].typical) for k in at}
    parameters = [replace(shared[k], tolerance=wide[k]) if k in wide else shared[k] for k in free]
    flights = [study.flights[name][1] for name in study.learned_from]
    fit = fit_likelihood(
        [FlightSystem(study.vehicle, one, parameters) for one in flights],
        study.nominal,
        np.array([hidden.get(shared[k].name, 0.0) if k in wide else 0.0 for k in free]),
        [NoiseModel.guess(study.nominal, one) for one in flights],
        LINEARIZATIONS,
        LEARNING,
        is_near=True,
    )
    out = {}
    for k in at:
        place = free.index(k)
        variance = float(fit.covariance[place, place])
        information = max(1.0 / variance - wide[k] ** -2.0, 1e-12)
        deviation = math.hypot(information**-0.5, shared[k].tolerance)
        out[shared[k].name] = abs(hidden[shared[k].name]) / deviation
    return out


def _list_intervals(
    study: Discovery, true: Mapping[str, Mapping[str, float]]
) -> list[dict[str, Any]]:
    """Return estimates of hidden effects with the truth, where they alone are named."""
    out = []
    for one in study.named:
        for each in one.estimates:
            effect, _, name = each.name.partition('.')
            value = true.get(effect, {}).get(name)
            if value is not None and not one.alternatives:
                out.append({'name': each.name, 'true': value, 'value': each.value,
                            'ci95': list(each.ci95)})  # fmt: skip
    return out

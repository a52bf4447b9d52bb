"""
Compare laws with an oracle that knows the equation, for each kind outside the library.

The library is not searched, as it has no name for these kinds: each case is fitted with its
tolerances, and a law is sought whatever the verdict would be, also where nothing is hidden
(`--kinds clean`). One line of JSON for each case: errors after 3 s on the held-out flight.
"""

import argparse
from dataclasses import replace
import json
from pathlib import Path
import pickle
import sys
import tempfile
import time
from typing import Any

from lta_challenge import case as generator
from lta_challenge.case import CaseGenerator, ROLES
from lta_challenge.make import load_challenge_vehicle, read_vehicle_text
from lta_challenge.outside import STRANGE
from lta_challenge.outside.law_oracle import fit_law_oracle
from lta_challenge.recording import write_bag
from lta_discovery.conclusion import FAR
from lta_discovery.finding import ChannelErrors, StudyResult
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, wrench_floor
from lta_discovery.fit.joint_fit import JointFitter
from lta_discovery.flights.bags import read_bags
from lta_discovery.flights.role_assignment import Role
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.forecast.file_comparison import limit_to_file
from lta_discovery.forecast.held_out import build_model_points
from lta_discovery.forecast.tolerance_shrinkage import shrink_tolerances
from lta_discovery.laws.law_file import BaseFile
from lta_discovery.laws.proposal import add_law
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.model.replay_kernel import load_body_kernel
from lta_discovery.replay.knot_count import count_needed_knots
from lta_discovery.replay.linearized_flight import LinearizationPoint, zero_unknowns
from lta_discovery.study import (
    DiscoveryStudy,
    prepare_flight,
    StudyFlight,
    ThreeModelComparison,
)
from lta_model.law_text import describe_term
from lta_model.vehicle import load_vehicle, Vehicle
import numpy as np

SECONDS = (40.0, 50.0)
BEGIN = 1.3  # noise floors; initial estimate of the unexplained force


def make_flights(kind: str, seed: int, number: int) -> tuple[Vehicle, list[Role], dict[str, Any]]:
    """Return vehicle, usable flights and answer of a case of a kind."""
    generator.choose_outside_kind = lambda _draw, late: kind
    about, hides = load_challenge_vehicle(), 'clean' if kind == 'clean' else 'outside'
    case = CaseGenerator(about, seed, number, 'base', hides, SECONDS).generate_case()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / 'vehicle.yaml').write_text(read_vehicle_text(), encoding='utf-8')
        for flight in case.flights:
            write_bag(place / flight.name, flight.streams, about.vehicle.rotor_names, {})
        vehicle = load_vehicle(str(place / 'vehicle.yaml'))
        bags = {role: sorted(place.glob(f'{role}*')) for role in ROLES}
        return vehicle, select_usable_flights(read_bags(bags), vehicle).flights, case.answer


def fit_tolerances(vehicle: Vehicle, flights: list[Role]) -> DiscoveryStudy:
    """Return the study of flights in which no effect is sought."""
    nominal = NominalVehicle.from_vehicle(vehicle)
    known = list_free_parameters(nominal, False)
    flown = [StudyFlight(n, role, prepare_flight(vehicle, f, known)) for n, role, f in flights]
    knots = count_needed_knots([one.flight for one in flown], nominal)
    flown = [replace(one, flight=one.flight.with_knots(knots)) for one in flown]
    taught = [one.flight for role in ROLES[:2] for one in flown if one.role == role]
    variance, floor, prior = (
        per_flight_variance(known),
        wrench_floor(nominal),
        build_shared_prior(known),
    )
    fitter, at = JointFitter(nominal, taught, variance, floor), np.zeros(len(variance))
    named, values = apply_parameters(nominal, known, at)
    points = [LinearizationPoint(named, values, zero_unknowns(f.replay.cut)) for f in taught]
    begin = fitter.linearize_flights(at, points, prior)
    joint = fitter.fit(prior, begin, BEGIN * floor, narrow=True)
    bare = shrink_tolerances(fitter, joint)
    fits = limit_to_file(nominal, taught, bare, bare)
    shown = [
        ThreeModelComparison(one, *build_model_points(one.flight, nominal, fits.bare, fits.full))
        for one in flown
        if one.role == 'holdout'
    ]
    roles = {role: (role,) for role in ROLES}
    finding = StudyResult('unexplained', (), (), (), (), True, (), (), 1, roles, 'gtmab')
    return DiscoveryStudy(
        finding, nominal, nominal, flown, shown, joint=joint, forecasts=fits.full
    )


def select_far(errors: tuple[ChannelErrors, ...]) -> dict[str, dict[str, float]]:
    """Return the errors at the horizon by channel and model."""
    models = ('before', 'tuned', 'after', 'coast')
    return {
        one.channel: {model: getattr(one, model) for model in models}
        for one in errors
        if one.horizon_s == FAR
    }


def study_case(
    kind: str, seed: int, number: int, folder: Path | None
) -> tuple[Vehicle, DiscoveryStudy, dict[str, Any]]:
    """Return vehicle, study and answer of a case, stored ones if there are any."""
    place = folder / f'{kind}_{seed}_{number}.pickle' if folder else None
    if place and place.exists():
        # Before threads need it: CPython 3.11 parses no source in several threads at once
        load_body_kernel()
        out: tuple[Vehicle, DiscoveryStudy, dict[str, Any]] = pickle.loads(place.read_bytes())
        return out
    vehicle, flights, answer = make_flights(kind, seed, number)
    made = vehicle, fit_tolerances(vehicle, flights), answer
    if place:
        place.write_bytes(pickle.dumps(made))
    return made


def run_case(kind: str, seed: int, number: int, folder: Path | None = None) -> dict[str, Any]:
    """Return law, errors and those of the oracle for one case."""
    vehicle, study, answer = study_case(kind, seed, number, folder)
    base = BaseFile(read_vehicle_text(), vehicle)
    begun = time.process_time()
    found = add_law(study, base, lambda _what, _part: None).finding.law
    spent, name = time.process_time() - begun, answer['outside']
    oracle = fit_law_oracle(study, name, answer['strange'][name]) if name else ()
    assert found is not None
    return {
        'kind': kind, 'seed': seed, 'number': number, 'floors': answer['floors'],
        'proposed': found.law is not None, 'reason': found.reason,
        'terms': [describe_term(one) for one in found.tried.terms] if found.tried else [],
        'errors': select_far(found.errors), 'oracle': select_far(oracle), 'law_cpu_s': spent,
    }  # fmt: skip


def main() -> None:
    """Run the cases that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--seed', type=int, default=3803)
    parser.add_argument('--kinds', nargs='+', default=list(STRANGE))
    parser.add_argument('--first', type=int, default=1, help='number of the first case')
    parser.add_argument('--studies', type=Path, help='folder that keeps the fitted studies')
    asked = parser.parse_args()
    if asked.studies:
        asked.studies.mkdir(parents=True, exist_ok=True)
    for number, kind in enumerate(asked.kinds, asked.first):
        sys.stdout.write(json.dumps(run_case(kind, asked.seed, number, asked.studies)) + '\n')
        sys.stdout.flush()


if __name__ == '__main__':
    main()

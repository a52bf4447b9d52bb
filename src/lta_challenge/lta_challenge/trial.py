"""Run discovery on one case, and fit the oracle that knows the hidden structure."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
import time
import traceback
from typing import Any, Final

from lta_challenge.case import ROLES
from lta_challenge.contradictions import find_contradictions
from lta_challenge.outside import STRANGE
from lta_challenge.outside.law_oracle import fit_law_oracle
from lta_challenge.rows import find_challenge_row
from lta_config.errors import BadInput
from lta_discovery.conclusion import draw_conclusion
from lta_discovery.finding import ChannelErrors, LawFinding
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, wrench_floor
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.forecast.held_out import build_model_points, compute_model_errors
from lta_discovery.planning.next_flight import add_confusable
from lta_discovery.replay.linearized_flight import LinearizationPoint, zero_unknowns
from lta_discovery.run import DiscoveryRequest, study_usable_flights
from lta_discovery.study import DiscoveryStudy
from lta_model.law_text import describe_term
from lta_model.vehicle import load_vehicle
import numpy as np

BEGIN: Final = 1.3  # noise floors; initial estimate of the unexplained force
# A case that cannot be analysed, or hits a defect, must not end a run of hundreds
FAULTS: Final = (BadInput, ArithmeticError, ValueError, LookupError)


def run_trial(folder: Path, read_answer: Callable[[], Mapping[str, Any]]) -> dict[str, Any]:
    """
    Study one case, and only then read its answer for the oracle.

    Parameters
    ----------
    folder : Path
        Folder of the case.
    read_answer : callable
        Returns the answer of the case.

    Returns
    -------
    dict
        JSON data: finding, computing time and oracle.

    """
    result, study = study_case(folder)
    if study is not None:
        # Read after the study, so that the answer cannot influence it
        answer = read_answer()
        if find_challenge_row(answer['row']).rough:
            return result  # nothing is hidden, and the file is wrong
        try:
            result |= {'oracle': fit_oracle(study, answer)}
        except FAULTS as fault:
            result |= {'oracle': {}, 'oracle_fault': str(fault)}
        try:
            result['oracle'] |= {'law': _test_law_oracle(study, answer)}
        except FAULTS as fault:
            result |= {'law_oracle_fault': str(fault)}
    return result


def study_case(folder: Path) -> tuple[dict[str, Any], DiscoveryStudy | None]:
    """Return the finding of a case as JSON data, and the study; None if it was refused."""
    # Processor time is comparable between runs with different numbers of workers
    wall, cpu = time.monotonic(), time.process_time()
    result: dict[str, Any] = {'refused': ''}
    study = None
    try:
        study = _study_case(folder)
        result |= _finding_to_dict(study)
    except FAULTS as fault:
        result |= {'refused': str(fault), 'verdict': 'not_identifiable', 'effects': [], 'gaps': []}
        result |= {'remains': [], 'warnings': []}
        if not isinstance(fault, BadInput):
            result |= {'traceback': ''.join(traceback.format_exception(fault))}
    result |= {'wall_s': time.monotonic() - wall, 'cpu_s': time.process_time() - cpu}
    return result, study


def _study_case(folder: Path) -> DiscoveryStudy:
    """Study a case as `lta discover` does."""
    name = str(folder / 'vehicle.yaml')
    bags: dict[Role, list[Path]] = {
        # Some rows have several flights of a role: train, train_4, ...
        role: sorted(folder.glob(f'{role}*'))
        for role in ROLES
    }
    vehicle = load_vehicle(name)
    sound = select_usable_flights(read_bags(bags), vehicle)
    return add_confusable(
        study_usable_flights(
            DiscoveryRequest(name, bags), vehicle, sound, lambda _what, _part: None
        )
    )


def _finding_to_dict(study: DiscoveryStudy) -> dict[str, Any]:
    """Return a finding as JSON data."""
    finding = study.finding
    return {
        'verdict': finding.verdict,
        'effects': [
            {**asdict(one), 'parameters': [each._asdict() for each in one.parameters]}
            for one in finding.effects
        ],
        'gaps': _select_pose_errors(finding.gaps),
        'training': _select_pose_errors(finding.training),
        'remains': [one._asdict() for one in finding.remains],
        'law': None if finding.law is None else _law_to_dict(finding.law),
        'warnings': list(finding.warnings),
        'advice': draw_conclusion(finding).advice,
        'detectable': {one.knob: one.size for one in finding.detectable},
        'contradictions': find_contradictions(finding),
    }


def _law_to_dict(outcome: LawFinding) -> dict[str, Any]:
    """Return the law that was proposed or tried, as JSON data."""
    return {
        'proposed': outcome.law is not None,
        'reason': outcome.reason,
        'terms': []
        if outcome.tried is None
        else [describe_term(one) for one in outcome.tried.terms],
        'errors': _select_pose_errors(outcome.errors),
    }


def _select_pose_errors(differences: Sequence[ChannelErrors]) -> list[dict[str, Any]]:
    """Return the errors of position and attitude."""
    return [asdict(one) for one in differences if one.channel in ('position', 'attitude')]


def fit_oracle(study: DiscoveryStudy, answer: Mapping[str, Any]) -> dict[str, Any]:
    """
    Fit the true structure: the oracle knows which effects are hidden, but not their size.

    Returns
    -------
    dict
        'sigma': size of each hidden parameter, divided by its standard deviation from these
        flights and the vehicle's tolerance; 'gaps': errors on the held-out flights.

    """
    hidden = {one['knob']: float(one['value']) for one in answer['hidden']}
    fits = _fit_true_structure(study, hidden)
    models = [
        build_model_points(each.study_flight.flight, study.nominal, fits, fits)
        for each in study.comparisons
    ]
    flights = [each.study_flight.flight for each in study.comparisons]
    return {
        'sigma': _compute_effect_strengths(study, hidden, fits),
        'gaps': _select_pose_errors(compute_model_errors(flights, models, 0)),
    }


def _test_law_oracle(study: DiscoveryStudy, answer: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the errors of the oracle that knows the equation outside the library."""
    name = answer['outside']
    if name not in STRANGE or 'unexplained' not in study.finding.verdict:
        return []
    return _select_pose_errors(fit_law_oracle(study, name, answer['strange'][name]))


def _fit_true_structure(study: DiscoveryStudy, hidden: Mapping[str, float]) -> JointFit:
    """Fit the true structure to the train and confirm flights, starting at the true values."""
    flights = [one.flight for one in study.flights if one.role != 'holdout']
    parameters, nominal = flights[0].knobs, study.nominal
    fitter = JointFitter(nominal, flights, per_flight_variance(parameters), wrench_floor(nominal))
    variance = per_flight_variance(parameters)
    # Start the fit at the true values; the other parameters start at zero
    at = np.zeros(len(variance))
    for k, knob in enumerate(parameters):
        at[k] = hidden.get(knob.name, 0.0)
    vehicle, values = apply_parameters(nominal, parameters, at)
    points = [LinearizationPoint(vehicle, values, zero_unknowns(f.replay.cut)) for f in flights]
    prior = build_shared_prior(parameters, tuple(hidden))
    begin = fitter.linearize_flights(at, points, prior)
    return fitter.fit(prior, begin, BEGIN * wrench_floor(nominal), narrow=True)


def _compute_effect_strengths(
    study: DiscoveryStudy, hidden: Mapping[str, float], fits: JointFit
) -> dict[str, float]:
    """Return the strength of each hidden effect in standard deviations."""
    out = {}
    for k, knob in enumerate(study.flights[0].flight.knobs):
        if knob.name not in hidden:
            continue
        variance = float(fits.fitted.covariance[k, k])
        before = float(fits.prior.covariance[k, k])
        # Information of the flights alone: subtract that of the prior
        information = max(1.0 / variance - 1.0 / before, 1e-12)
        # Parameters of a single flight have no vehicle tolerance
        own = 0.0 if knob.per_flight else knob.tolerance
        out[knob.name] = abs(hidden[knob.name]) / float(np.sqrt(1.0 / information + own**2))
    return out

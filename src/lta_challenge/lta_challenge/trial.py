"""One case put to discovery, and to the oracle, which is told what was hidden."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
import time
from typing import Any, Final

from lta_challenge.case import ROLES
from lta_challenge.contradictions import find_contradictions
from lta_config.errors import BadInput
from lta_discovery.conclusion import draw_conclusion
from lta_discovery.finding import Gap
from lta_discovery.fit.bounds import turned
from lta_discovery.fit.evidence import floor_of, own_variance, shared
from lta_discovery.fit.fit import Fitter, Joint
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.trusted import believed
from lta_discovery.forecast.held_out import gaps, shown
from lta_discovery.planning.next_flight import doubted
from lta_discovery.replay.linear import Point, still
from lta_discovery.run import Asked, studied
from lta_discovery.study import Study
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import keep_json
import numpy as np

BEGIN: Final = 1.3  # floors; of the unexplained force to begin with
# One case that cannot be answered, or is answered by a defect, must not end hundreds.
FAULTS: Final = (BadInput, ArithmeticError, ValueError, LookupError)


def put(folder: Path, answer: Mapping[str, Any], out: Path) -> dict[str, Any]:
    """
    Study one case, write what was found, and only then look at its answer.

    Parameters
    ----------
    folder : Path
        Of the case.
    answer : mapping
        Of it.
    out : Path
        File of the result.

    Returns
    -------
    dict
        Plain data: what was found, what it took, and what the oracle says.

    """
    found, made = study_case(folder)
    keep_json(found, out)
    if made is not None:
        try:
            found |= {'oracle': oracle(made, answer)}
        except FAULTS as fault:
            found |= {'oracle': {}, 'oracle_fault': str(fault)}
        keep_json(found, out)
    return found


def study_case(folder: Path) -> tuple[dict[str, Any], Study | None]:
    """Return what is found in a case as plain data, and the study; None where it was refused."""
    wall, cpu = time.monotonic(), time.process_time()
    found: dict[str, Any] = {'refused': ''}
    made = None
    try:
        made = _studied(folder)
        found |= _told(made)
    except FAULTS as fault:
        found |= {'refused': str(fault), 'verdict': 'not_identifiable', 'effects': [], 'gaps': []}
        found |= {'remains': [], 'warnings': []}
    found |= {'wall_s': time.monotonic() - wall, 'cpu_s': time.process_time() - cpu}
    return found, made


def _studied(folder: Path) -> Study:
    """Return the study of a case: what `lta discover` does with its bags."""
    name = str(folder / 'vehicle.yaml')
    bags: dict[Role, list[Path]] = {role: [folder / role] for role in ROLES}
    vehicle = load_vehicle(name)
    sound = believed(read_bags(bags), vehicle)
    return doubted(studied(Asked(name, bags), vehicle, sound, lambda _what, _part: None))


def _told(made: Study) -> dict[str, Any]:
    """Return a finding as plain data."""
    finding = made.finding
    return {
        'verdict': finding.verdict,
        'effects': [
            {**asdict(one), 'parameters': [each._asdict() for each in one.parameters]}
            for one in finding.effects
        ],
        'gaps': _shown(finding.gaps),
        'remains': [one._asdict() for one in finding.remains],
        'warnings': list(finding.warnings),
        'advice': draw_conclusion(finding).advice,
        'detectable': {one.knob: one.size for one in finding.detectable},
        'contradictions': find_contradictions(finding),
    }


def _shown(differences: Sequence[Gap]) -> list[dict[str, Any]]:
    """Return the errors of position and attitude."""
    return [asdict(one) for one in differences if one.channel in ('position', 'attitude')]


def oracle(made: Study, answer: Mapping[str, Any]) -> dict[str, Any]:
    """
    Return what one would find who knew what was hidden, and not how large.

    Parameters
    ----------
    made : Study
        Of the case.
    answer : mapping
        Of the case.

    Returns
    -------
    dict
        'sigma': size of each hidden knob by the deviation with which these flights and the
        vehicle's own tolerance leave it; 'gaps': errors on the held-out flights.

    """
    hidden = {one['knob']: float(one['value']) for one in answer['hidden']}
    fits = _fitted(made, hidden)
    models = [shown(each.flown.flight, made.nominal, fits, fits) for each in made.shown]
    flights = [each.flown.flight for each in made.shown]
    return {
        'sigma': _sigmas(made, hidden, fits),
        'gaps': _shown(gaps(flights, models, 0)),
    }


def _fitted(made: Study, hidden: Mapping[str, float]) -> Joint:
    """Fit the flights that teach and confirm with the true structure, from the truth."""
    flights = [one.flight for one in made.flights if one.role != 'holdout']
    known, nominal = flights[0].knobs, made.nominal
    fitter = Fitter(nominal, flights, own_variance(known), floor_of(nominal))
    variance = own_variance(known)
    at = np.zeros(len(variance))
    for k, knob in enumerate(known):
        at[k] = hidden.get(knob.name, 0.0)
    vehicle, values = turned(nominal, known, at)
    points = [Point(vehicle, values, still(f.replay.cut)) for f in flights]
    prior = shared(known, tuple(hidden))
    begin = fitter.about(at, points, prior)
    return fitter.fit(prior, begin, BEGIN * floor_of(nominal), narrow=True)


def _sigmas(made: Study, hidden: Mapping[str, float], fits: Joint) -> dict[str, float]:
    """Return the strength of each hidden effect in deviations."""
    out = {}
    for k, knob in enumerate(made.flights[0].flight.knobs):
        if knob.name not in hidden:
            continue
        variance = float(fits.fitted.covariance[k, k])
        before = float(fits.prior.covariance[k, k])
        information = max(1.0 / variance - 1.0 / before, 1e-12)
        own = 0.0 if knob.per_flight else knob.tolerance
        out[knob.name] = abs(hidden[knob.name]) / float(np.sqrt(1.0 / information + own**2))
    return out

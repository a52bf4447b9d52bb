"""
Score the fits of rough cases against their files: `python test/score/rough.py --cases 200`.

Each case is one of `lta challenge make --row rough --seed SEED --n CASES`, in order: a vehicle
file that is wrong by a factor of 0.3 to 3, and logs as laboratories have them. Only the fit
without effects is computed, which is what diverges, if anything does; a whole study takes five
times as long. A fit that predicts its own flights 5 % worse than the file, 3 s ahead, fails.
"""

import argparse
from collections import Counter
from collections.abc import Mapping
import json
from pathlib import Path
import sys
import tempfile
import time
import traceback
from typing import Any

from lta_challenge.case import ROLES
from lta_challenge.make import ChallengeRequest, draw_case, load_challenge_vehicle
from lta_challenge.recording import write_bag
from lta_config.errors import BadInput
from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, wrench_floor
from lta_discovery.fit.initial_guess import guess_start
from lta_discovery.fit.joint_fit import JointFitter
from lta_discovery.flights.bags import read_bags
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.forecast.file_comparison import AHEAD, limit_to_file, WORSE
from lta_discovery.forecast.tolerance_shrinkage import shrink_tolerances
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.replay.diverging_pieces import drop_diverging_pieces
from lta_discovery.replay.knot_count import count_needed_knots
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.study import prepare_flight
from lta_model.vehicle import load_vehicle


def recorded(order: ChallengeRequest, number: int, folder: Path) -> Mapping[str, Any]:
    """Record one case; return its answer."""
    case = draw_case(order, number)
    (folder / 'vehicle.yaml').write_text(case.vehicle_file or '', encoding='utf-8')
    for flight in case.flights:
        names = load_challenge_vehicle().vehicle.rotor_names
        write_bag(folder / flight.name, flight.streams, names, {})
    return case.answer


def compared(folder: Path) -> dict[str, float]:
    """Return the errors of the fit on its own flights, by those of the vehicle file."""
    vehicle = load_vehicle(str(folder / 'vehicle.yaml'))
    nominal = NominalVehicle.from_vehicle(vehicle)
    bags = read_bags({role: sorted(folder.glob(f'{role}*')) for role in ROLES})
    told = select_usable_flights(bags, vehicle).flights
    known = list_free_parameters(nominal, any(one.wrench is not None for _, _, one in told))
    flown = [prepare_flight(vehicle, one, known) for _, role, one in told if role != 'holdout']
    flown = [drop_diverging_pieces(one, nominal)[0] for one in flown]
    knots = count_needed_knots(flown, nominal)
    flown = [one.with_knots(knots) for one in flown if len(one.replay.first)]
    fitter = JointFitter(nominal, flown, per_flight_variance(known), wrench_floor(nominal))
    prior = build_shared_prior(known)
    points = [unchanged_vehicle_point(nominal, known, one.replay.cut) for one in flown]
    at, points, deviations = guess_start(fitter, prior, points[0].values, points)
    fit = fitter.fit(prior, fitter.linearize_flights(at, points, prior), deviations, narrow=True)
    tuned = shrink_tolerances(fitter, fit)
    limited = limit_to_file(nominal, flown, tuned, tuned)
    ratios = {e.channel: e.tuned / e.before for e in limited.errors if e.horizon_s == AHEAD}
    return {**ratios, 'share': limited.share}


def trial(order: ChallengeRequest, number: int) -> dict[str, Any]:
    """Return the outcome of one case: 'no worse', 'worse', 'refused' or 'traceback'."""
    begun = time.process_time()
    with tempfile.TemporaryDirectory() as name:
        answer = recorded(order, number, Path(name))
        try:
            ratios = compared(Path(name))
            worst = max(ratios.get(channel, 0.0) for channel in ('position', 'attitude'))
            out: dict[str, Any] = {'outcome': 'worse' if worst > WORSE else 'no worse', **ratios}
        except BadInput as fault:
            out = {'outcome': 'refused', 'why': str(fault)}
        except Exception:
            out = {'outcome': 'traceback', 'why': traceback.format_exc()}
    about = {'case': number, 'factors': answer['factors'], 'trim': answer['trim']}
    return {**about, **out, 'cpu_s': time.process_time() - begun}


def main() -> None:
    """Score, and print one line for each case and the counts."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument('--cases', type=int, default=20)
    words.add_argument('--seed', type=int, default=2063)
    told = words.parse_args()
    order, counts = ChallengeRequest(told.seed, told.cases, 'rough'), Counter[str]()
    for number in range(told.cases):
        out = trial(order, number)
        counts[out['outcome']] += 1
        sys.stdout.write(json.dumps(out, default=str) + '\n')
        sys.stdout.flush()
    total = counts.total()
    sys.stdout.write(', '.join(f'{what}: {n} of {total}' for what, n in counts.items()) + '\n')


if __name__ == '__main__':
    main()

"""
Compare laws with other ways to learn an unknown force: PySINDy, and a Gaussian process.

The cases are those of test/score/laws.py, each with one more flight at twice the speed. The peers
learn the residual acceleration of the vehicle with fitted tolerances, and act on it as a law does.
One line of JSON for each case: errors after 3 s in m and rad.
"""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
import json
from pathlib import Path
import sys
import tempfile
import time
from typing import Any
import warnings

sys.path.append(str(Path(__file__).resolve().parents[1] / 'score'))

from laws import SECONDS, select_far, study_case
from lta_challenge import case as generator
from lta_challenge.case import CaseGenerator
from lta_challenge.make import load_challenge_vehicle, read_vehicle_text
from lta_challenge.outside.law_oracle import fit_law_oracle
from lta_challenge.recording import write_bag
from lta_challenge.truth_flight import PilotInputs
from lta_discovery.finding import ChannelErrors
from lta_discovery.flights.bags import read_bags
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.flights.windows import Windows
from lta_discovery.forecast.held_out import build_model_points
from lta_discovery.laws.forecast import Prepare
from lta_discovery.laws.law_file import BaseFile
from lta_discovery.laws.proposal import add_law, compare_forecasts, list_taught_flights
from lta_discovery.laws.quantities import (
    at_pieces,
    input_quantities,
    measured_states,
    Quantities,
    state_quantities,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import AXES
from lta_discovery.replay.replay import STEPS
from lta_discovery.study import (
    DiscoveryStudy,
    prepare_flight,
    StudyFlight,
    ThreeModelComparison,
)
from lta_model.vehicle import parse_vehicle, Vehicle
import numpy as np
from numpy.typing import NDArray
import pysindy
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, RBF, WhiteKernel

Array = NDArray[np.float64]
Predict = Callable[[Array], Array]  # wrench (n, 6), in deviations, from features (n, F)

FASTER = 2.0  # times the speed of the other flights
SPAN = 10  # grid periods; over which the residual acceleration is a mean
APART = 5  # grid periods between such means
MOVING = ('u', 'v', 'w', 'p', 'q', 'r')
GIVEN = ('height', 'roll', 'pitch', 'thrust_surge', 'thrust_heave', 'thrust_yaw')
THRESHOLDS = (0.02, 0.05, 0.1, 0.2, 0.4)  # of PySINDy; one is chosen by the confirming flight
SAMPLES = 400  # of the Gaussian process, whose time grows with their cube


def record_fast_flight(
    vehicle: Vehicle, study: DiscoveryStudy, strange: dict[str, Any], seed: int, number: int
) -> ThreeModelComparison:
    """Return one more flight of a case, at twice the speed."""
    plan = generator.plan_pilot_inputs

    def hurry(*args: Any) -> PilotInputs:
        inputs = plan(*args)
        return inputs._replace(setpoints=inputs.setpoints * [1.0, 1.0, FASTER])

    about = load_challenge_vehicle()
    case = CaseGenerator(about, seed, number, 'base', 'outside', SECONDS)
    generator.plan_pilot_inputs = hurry
    try:
        told = case._record_flight(case._build_case_vehicle(()), strange, 3, 'holdout')
    finally:
        generator.plan_pilot_inputs = plan
    with tempfile.TemporaryDirectory() as folder:
        write_bag(Path(folder) / 'fast', told.streams, vehicle.rotor_names, {})
        read = read_bags({'train': [Path(folder) / 'fast']})
        flight = select_usable_flights(read, vehicle).flights[0][-1]
    like = study.flights[0].flight
    ready = prepare_flight(vehicle, flight, like.knobs).with_knots(like.replay.cut.knots)
    assert study.forecasts is not None
    points = build_model_points(ready, study.nominal, study.forecasts, study.forecasts)
    return ThreeModelComparison(StudyFlight('fast', 'holdout', ready), *points)


def compute_features(quantities: Quantities) -> Array:
    """Return what the peers know of the motion, shape (..., F)."""
    turned = [trig(quantities['yaw']) for trig in (np.sin, np.cos)]
    return np.stack([*(quantities[name] for name in (*MOVING, *GIVEN)), *turned], axis=-1)


def measure_residuals(flight: FlightLinearizer, nominal: NominalVehicle) -> tuple[Array, Array]:
    """
    Return features (n, F), and the wrench that the vehicle lacks to move as measured, (n, 6).

    It is constant over `SPAN` grid periods, at whose beginning the vehicle moves as measured.
    """
    measured, usable = flight.replay.flight, flight.replay.flight.usable
    states = measured_states(flight, len(measured.time))
    first = np.arange(0, len(states) - SPAN, APART)
    first = first[[bool(usable[at : at + SPAN + 1].all()) for at in first]]
    cut = Windows(first, SPAN, states[first], np.ones((len(first), SPAN), dtype=np.bool_))
    replay = flight.replay.with_pieces(cut)
    rows = replay.build_replay_rows(nominal)
    ready = replay.compute_body_inputs(rows)
    latent = np.zeros((len(first), replay.span, AXES))
    ends = [replay.integrate_pieces(rows, ready, cut.start, latent)[:, -1, 7:]]
    for axis, push in enumerate((1e-3, 1e-3, 1e-3, 1e-4, 1e-4, 1e-4)):
        pushed = latent.copy()
        pushed[..., axis] = push
        moved = replay.integrate_pieces(rows, ready, cut.start, pushed)[:, -1, 7:]
        ends.append((moved - ends[0]) / push)
    left = states[first + SPAN, 7:] - ends[0]
    wrench = np.linalg.solve(np.stack(ends[1:], axis=-1), left[..., None])[..., 0]
    inputs = input_quantities(flight, nominal)
    middle = first + SPAN // 2
    known = state_quantities(states[middle]) | {name: inputs[name][middle] for name in inputs}
    return compute_features(known), wrench


class LearnedWrench:
    """A learned wrench along one flight."""

    def __init__(
        self, predict: Predict, flight: FlightLinearizer, nominal: NominalVehicle
    ) -> None:
        self._predict = predict
        self._known = at_pieces(flight, input_quantities(flight, nominal))

    def compute_wrench(self, states: Array) -> Array:
        """Return the wrench in each step of the pieces, shape (S, span, 6), body frame."""
        middle = states[:, STEPS // 2 :: STEPS]
        features = compute_features(state_quantities(middle) | self._known)
        flat = features.reshape(-1, features.shape[-1])
        found = np.full((len(flat), AXES), np.nan)
        # A forecast that diverges stays so
        good = np.isfinite(flat).all(axis=1) & (np.abs(flat) < 1e6).all(axis=1)
        found[good] = self._predict(flat[good])
        return np.repeat(found.reshape(*features.shape[:2], AXES), STEPS, axis=1)


@dataclass(frozen=True)
class Sides:
    """Features and wrenches of training and confirming flights, in standard deviations."""

    train: tuple[Array, Array]
    confirm: tuple[Array, Array]

    @property
    def both(self) -> tuple[Array, Array]:
        """All flights."""
        x, y = (np.concatenate(each) for each in zip(self.train, self.confirm, strict=True))
        return x, y


def fit_pysindy(sides: Sides) -> tuple[Predict, int]:
    """Return the polynomial of second degree by sequential thresholding, and its terms."""

    def fit(threshold: float, x: Array, y: Array) -> pysindy.SINDy:
        model = pysindy.SINDy(
            optimizer=pysindy.STLSQ(threshold=threshold, alpha=1.0),
            feature_library=pysindy.PolynomialLibrary(degree=2),
        )
        count = len(MOVING)
        return model.fit(x[:, :count], t=1.0, x_dot=y, u=x[:, count:])

    def predict(model: pysindy.SINDy, x: Array) -> Array:
        count = len(MOVING)
        return np.asarray(model.predict(x[:, :count], u=x[:, count:]))

    (x, y), (seen, told) = sides.train, sides.confirm
    errors = [np.mean((predict(fit(one, x, y), seen) - told) ** 2) for one in THRESHOLDS]
    best = fit(THRESHOLDS[int(np.argmin(errors))], *sides.both)
    return partial(predict, best), int(np.count_nonzero(best.coefficients()))


def fit_gaussian_process(sides: Sides) -> tuple[Predict, int]:
    """Return the mean of a Gaussian process for each axis, and the number of its samples."""
    x, y = sides.both
    some = np.linspace(0, len(x) - 1, min(SAMPLES, len(x))).astype(int)
    kernel = ConstantKernel() * RBF(np.full(x.shape[1], 3.0), (0.1, 1e3)) + WhiteKernel(0.5)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', ConvergenceWarning)
        models = [
            GaussianProcessRegressor(kernel).fit(x[some], y[some, axis]) for axis in range(AXES)
        ]
    return lambda at: np.column_stack([one.predict(at) for one in models]), len(some)


PEERS = {'PySINDy': fit_pysindy, 'Gaussian process': fit_gaussian_process}


def learn_forces(study: DiscoveryStudy) -> dict[str, tuple[Prepare, int, float]]:
    """Return what each peer learns, its number of terms, and its processor time. [s]"""
    assert study.forecasts is not None
    begun = time.process_time()
    taught = []
    for each in list_taught_flights(study):
        # Lift and sensor errors of the flight, as for any forecast
        own = build_model_points(each, study.nominal, study.forecasts, study.forecasts)
        taught.append(measure_residuals(each, own.tuned.nominal))
    prepared = time.process_time() - begun
    count = sum(one.role == 'train' for one in study.flights)
    train, confirm = (
        tuple(np.concatenate([one[k] for one in some]) for k in (0, 1))
        for some in (taught[:count], taught[count:])
    )
    middle, size = train[0].mean(axis=0), train[0].std(axis=0) + 1e-9
    usual = train[1].std(axis=0)
    sides = Sides(*(((one[0] - middle) / size, one[1] / usual) for one in (train, confirm)))
    out = {}
    for name, fit in PEERS.items():
        begun = time.process_time()
        predict, terms = fit(sides)

        def scaled(x: Array, predict: Predict = predict) -> Array:
            return predict((x - middle) / size) * usual

        out[name] = (
            partial(LearnedWrench, scaled), terms, prepared + time.process_time() - begun,
        )  # fmt: skip
    return out


def take_errors(errors: Sequence[ChannelErrors], model: str = 'after') -> tuple[float, float]:
    """Return the errors of position and attitude. [m, rad]"""
    far = select_far(tuple(errors))
    return far['position'][model], far['attitude'][model]


def compare_case(kind: str, seed: int, number: int, folder: Path | None) -> dict[str, Any]:
    """Return the errors of each way to learn a force on a case."""
    vehicle, study, answer = study_case(kind, seed, number, folder)
    name, base = answer['outside'], BaseFile(read_vehicle_text(), vehicle)
    fast = record_fast_flight(vehicle, study, answer['strange'], seed, number)
    flights = {'usual': study.comparisons, 'fast': [fast]}
    shown = {key: replace(study, comparisons=some) for key, some in flights.items()}
    forecasts, out = study.forecasts, dict[str, Any](kind=kind, seed=seed, number=number)
    assert forecasts is not None
    learned = learn_forces(study)
    begun = time.process_time()
    law = add_law(study, base, lambda _what, _part: None).finding.law
    spent = time.process_time() - begun
    assert law is not None
    for key, one in shown.items():
        oracle = fit_law_oracle(one, name, answer['strange'][name])
        errors_of = {'without': take_errors(oracle, 'tuned'), 'oracle': take_errors(oracle)}
        if law.law is not None:
            file = parse_vehicle(law.file, kind, vehicle.air_density)
            nominal, none = NominalVehicle.from_vehicle(file), np.zeros_like(forecasts.fitted.mean)
            errors = compare_forecasts(one, forecasts, None, nominal, none)
            errors_of['law'] = take_errors(errors)
        for peer, (prepare, _, _) in learned.items():
            at = forecasts.fitted.mean
            errors = compare_forecasts(one, forecasts, prepare, study.nominal, at)
            errors_of[peer] = take_errors(errors)
        out[key] = errors_of
        if key == 'usual':
            out['proposed'] = law.law is not None
            out['terms'] = {'law': len(law.tried.terms) if law.tried else 0}
            out['cpu_s'] = {'law': spent}
    out['terms'] |= {peer: each[1] for peer, each in learned.items()}
    out['cpu_s'] |= {peer: each[2] for peer, each in learned.items()}
    out['speed'] = {
        key: float(np.sqrt(np.mean(measure_speed(some[0].study_flight.flight) ** 2)))
        for key, some in flights.items()
    }
    return out


def measure_speed(flight: FlightLinearizer) -> Array:
    """Return the speed in each grid period. [m/s]"""
    position = flight.replay.flight.position
    speed = np.linalg.norm(np.diff(position[::SPAN], axis=0), axis=1) / (SPAN * PERIOD)
    return speed[np.isfinite(speed)]


def main() -> None:
    """Compare the cases that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--seed', type=int, default=3907)
    parser.add_argument('--kinds', nargs='+', required=True)
    parser.add_argument('--first', type=int, default=1, help='number of the first case')
    parser.add_argument('--studies', type=Path, help='folder that keeps the fitted studies')
    asked = parser.parse_args()
    for number, kind in enumerate(asked.kinds, asked.first):
        told = compare_case(kind, asked.seed, number, asked.studies)
        sys.stdout.write(json.dumps(told) + '\n')
        sys.stdout.flush()


if __name__ == '__main__':
    main()

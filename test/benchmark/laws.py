"""
Compare laws with what peers learn from the same unexplained force: SINDy and a Gaussian process.

All get the force and moment that a joint fit leaves unexplained at the knots of the training and
confirming flights, and the same tolerances are tried with each. Their forecasts of the held-out
flight are made as those of a law. Columns: errors after 3 s by those of the oracle that knows the
equation; terms or points; processor time; RMS force or moment where all velocities and rates are
three times those of the held-out flight, by that within.

    .venv/bin/pip install -c constraints.txt -r requirements-bench.txt
    python test/benchmark/laws.py --studies FOLDER coupling:3803:1 layers:3803:7
"""

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
import sys
import time
from typing import Any

from lta_challenge.make import read_vehicle_text
from lta_challenge.outside.law_oracle import fit_law_oracle
from lta_discovery.conclusion import FAR
from lta_discovery.finding import ChannelErrors
from lta_discovery.laws.forecast import FlightLaw, Prepare
from lta_discovery.laws.law_data import LawData
from lta_discovery.laws.law_file import BaseFile
from lta_discovery.laws.proposal import (
    add_law,
    build_refit,
    choose_parameters,
    collect_law_data,
    compare_forecasts,
    list_taught_flights,
)
from lta_discovery.laws.quantities import at_pieces, input_quantities, state_quantities
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import AXES, unchanged_vehicle_point
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.variational_equation import WIDTH
from lta_discovery.study import DiscoveryStudy
import numpy as np
from numpy.typing import NDArray
from pysindy import PolynomialLibrary, STLSQ
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, RBF, WhiteKernel

sys.path.insert(0, str(Path(__file__).parent.parent / 'score'))
from laws import study_case

Array = NDArray[np.float64]
Predict = Callable[[Array], Array]  # wrench (N, 6) from features (N, F)

NAMES = ('u', 'v', 'w', 'p', 'q', 'r', 'roll', 'pitch', 'height',
         'thrust_surge', 'thrust_heave', 'thrust_yaw')  # fmt: skip
MOTIONS = NAMES[:6]
THRESHOLDS = (0.02, 0.05, 0.1, 0.2, 0.4)  # of SINDy, in deviations of the wrench
FASTER = 3.0  # times the velocities and rates, outside of the region


class PeerWrench:
    """The wrench of a peer along one flight."""

    def __init__(
        self, predict: Predict, flight: FlightLinearizer, nominal: NominalVehicle
    ) -> None:
        self._predict = predict
        inputs = at_pieces(flight, input_quantities(flight, nominal))
        self._known = {name: np.repeat(each, STEPS, axis=1) for name, each in inputs.items()}

    def compute_wrench(self, states: Array) -> Array:
        """Return the wrench in each step of the pieces, shape (S, span, 6), body frame."""
        middle = 0.5 * (states[:, :-1] + states[:, 1:])
        seen = state_quantities(middle) | self._known
        features = np.stack([seen[name] for name in NAMES], axis=-1)
        return self._predict(features.reshape(-1, len(NAMES))).reshape(*middle.shape[:2], AXES)


def collect_samples(study: DiscoveryStudy, data: LawData) -> tuple[Array, Array, Array]:
    """Return features, unexplained wrench, and whether each is of a training flight."""
    assert study.joint is not None
    knots = data.project(np.stack([data.values[name] for name in NAMES], axis=-1))
    wrench = []
    for linear in study.joint.group.linears:
        latent = linear.point.random[:, WIDTH : WIDTH + AXES * linear.knots]
        wrench.append(np.swapaxes(latent.reshape(-1, AXES, linear.knots), 1, 2))
    train = np.zeros(knots.shape[:2], dtype=bool)
    train[data.rows['train']] = True
    return knots.reshape(-1, len(NAMES)), np.concatenate(wrench).reshape(-1, AXES), train.ravel()


def fit_sindy(x: Array, y: Array, train: NDArray[np.bool_]) -> tuple[Predict, int]:
    """Return products of two features by STLSQ, and how many; the other flight picks the threshold."""
    middle, size, usual = x.mean(axis=0), x.std(axis=0) + 1e-12, y.std(axis=0) + 1e-12
    library = PolynomialLibrary(degree=2).fit((x - middle) / size)

    def expand(features: Array) -> Array:
        return np.asarray(library.transform((features - middle) / size))

    def learn(some: NDArray[np.bool_], threshold: float) -> Array:
        found = STLSQ(threshold=threshold, alpha=1e-3).fit(expand(x[some]), y[some] / usual)
        return np.asarray(found.coef_).T

    def judge(threshold: float) -> float:
        return sum(
            float(np.sum((y[~some] / usual - expand(x[~some]) @ learn(some, threshold)) ** 2))
            for some in (train, ~train)
        )

    weights = learn(np.ones_like(train), min(THRESHOLDS, key=judge))
    return lambda features: expand(features) @ weights * usual, int(np.count_nonzero(weights))


def fit_process(x: Array, y: Array, _train: NDArray[np.bool_]) -> tuple[Predict, int]:
    """Return a Gaussian process for each axis, and its number of points."""
    middle, size, usual = x.mean(axis=0), x.std(axis=0) + 1e-12, y.std(axis=0) + 1e-12
    kernel = ConstantKernel() * RBF(np.full(x.shape[1], 2.0), (0.3, 1e3)) + WhiteKernel(0.3)
    fits = [
        GaussianProcessRegressor(kernel).fit((x - middle) / size, y[:, k] / usual[k])
        for k in range(AXES)
    ]

    def predict(features: Array) -> Array:
        parts = [fit.predict((features - middle) / size) for fit in fits]
        return np.asarray(np.stack(parts, axis=-1)) * usual

    return predict, len(x)


def select_ratios(errors: Sequence[ChannelErrors], oracle: Sequence[ChannelErrors]) -> list[float]:
    """Return the errors of position and attitude after 3 s by those of the oracle."""
    best = {one.channel: one.after for one in oracle if one.horizon_s == FAR}
    return [one.after / best[one.channel] for one in errors if one.horizon_s == FAR]


def measure_outside(study: DiscoveryStudy, prepare: Prepare) -> float:
    """Return the RMS wrench far outside of the flown region, by that within."""
    flight = study.shown[0].flown.flight
    point = unchanged_vehicle_point(study.nominal, flight.knobs, flight.replay.cut)
    states = flight.simulate_forecast(point)
    wrench, sizes = prepare(flight, study.nominal), []
    for factor in (1.0, FASTER):
        there = states.copy()
        there[..., 7:13] *= factor
        push = wrench.compute_wrench(there) / np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])
        sizes.append(float(np.sqrt(np.mean(push**2))))
    return sizes[1] / max(sizes[0], 1e-12)


def run_case(kind: str, seed: int, number: int, folder: Path | None) -> list[tuple[Any, ...]]:
    """Return the rows of one case: model, ratios, terms, processor time, size outside."""
    vehicle, study, answer = study_case(kind, seed, number, folder)
    joint, forecasts, name = study.joint, study.forecasts, answer['outside']
    assert joint is not None
    assert forecasts is not None
    oracle = fit_law_oracle(study, name, answer['strange'][name])
    begun = time.process_time()
    base = BaseFile(read_vehicle_text(), vehicle)
    found = add_law(study, base, lambda _what, _part: None).finding.law
    spent, rows = time.process_time() - begun, []
    if found is not None and found.tried is not None:
        outside = measure_outside(study, partial(FlightLaw, found.tried))
        ratios = select_ratios(found.errors, oracle)
        rows.append(('law', *ratios, len(found.tried.terms), spent, outside))
    taught, data = list_taught_flights(study), collect_law_data(study, joint)
    free = np.zeros(len(joint.fitted.mean), dtype=np.bool_)
    refit = build_refit(study, taught, joint, forecasts, free)
    for label, learn in (('SINDy', fit_sindy), ('Gaussian process', fit_process)):
        begun = time.process_time()
        predict, count = learn(*collect_samples(study, data))
        prepare: Prepare = partial(PeerWrench, predict)
        at = choose_parameters(study, refit, forecasts, joint.fitted.mean, prepare, free)
        spent = time.process_time() - begun
        errors = compare_forecasts(study, forecasts, prepare, study.nominal, at)
        outside = measure_outside(study, prepare)
        rows.append((label, *select_ratios(errors, oracle), count, spent, outside))
    return rows


def main() -> None:
    """Print the table of the cases that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('cases', nargs='+', help='KIND:SEED:NUMBER')
    parser.add_argument('--studies', type=Path, help='folder that keeps the fitted studies')
    asked = parser.parse_args()
    sys.stdout.write('| case | model | position | attitude | terms or points | s | outside |\n')
    sys.stdout.write('|---|---|---|---|---|---|---|\n')
    for case in asked.cases:
        kind, seed, number = case.split(':')
        for label, *ratios, count, spent, outside in run_case(
            kind, int(seed), int(number), asked.studies
        ):
            cells = [f'{ratio:.2f}' for ratio in ratios]
            line = [f'`{kind}`', label, *cells, str(count), f'{spent:.1f}', f'{outside:.2g}']
            sys.stdout.write(f'| {" | ".join(line)} |\n')
            sys.stdout.flush()


if __name__ == '__main__':
    main()

"""
Score the search for faint effects on chance alone: `test/score/weak_effects.py CASE` (minutes).

CASE is a folder of `lta challenge make --kind clean`. Its flights are fitted once; then the
products of their columns with what is left over are drawn anew, many times, as the linear model
has them: noise, the vehicle's tolerances and, in every second draw, one candidate at random of 3
to 6 deviations. Each draw is put to `weak_effects.choose_candidate` with several least gains. What
is counted is the best that the search could do if flights were as the model takes them to be:
linear, with white noise.
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
import sys
from typing import NamedTuple

from lta_challenge.case import ROLES
from lta_discovery.fit.evidence import per_flight_variance, ReducedFlight, wrench_floor
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.flights.bags import read_bags
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.selection.candidate_scan import column_cosines, scan_candidates
from lta_discovery.selection.effect_search import EffectSearch
from lta_discovery.selection.equivalence_classes import is_equivalent
from lta_discovery.selection.weak_effects import (
    ALIKE,
    ASKED,
    choose_candidate,
    GAIN,
    WeakCandidate,
    WeakEffectSearch,
    WITHIN,
)
from lta_discovery.study import prepare_flight
from lta_flight.sweep.statistics import wilson_interval
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
from rich.progress import track

Array = NDArray[np.float64]

SIGMAS = 3.0, 6.0  # of what is hidden
LEASTS = ((3.0, 4.5), (GAIN, WITHIN), (6.0, 7.5))  # nats; of any candidate, of one in a tolerance


class Draw(NamedTuple):
    """What was hidden, '' for nothing, and the candidates: the best first, those like it."""

    hidden: str
    hints: list[WeakCandidate]
    alike: tuple[str, ...]


class Drawing:
    """Draws what flights could have shown, about where they were fitted."""

    def __init__(self, last: JointFit, known: Sequence[FreeParameter], seed: int) -> None:
        self._prior, self._known, self._draw = last.prior, known, np.random.default_rng(seed)
        parts = [replace(last.group, pieces=(each,)) for each in last.group.pieces]
        self._sides = [each.reduce_flights(last.deviations).products[:-1, :-1] for each in parts]
        size = len(last.group.at)
        tiny = [1e-9 * np.diag(np.diag(each)) + 1e-12 * np.eye(size) for each in self._sides]
        both = zip(self._sides, tiny, strict=True)
        self._roots = [np.linalg.cholesky(0.5 * (g + g.T) + rest) for g, rest in both]
        self._open = [k for k, knob in enumerate(known) if knob.typical > 0.0]

    def _deviation(self, k: int) -> float:
        """Return the deviation with which the flights and its own tolerance leave a knob."""
        whole, free = sum(self._sides), self._prior.free
        free[k] = False
        at = np.flatnonzero(free)
        wide = np.diag(1.0 / np.diag(self._prior.covariance)[at])
        column = whole[at, k]
        inner = whole[np.ix_(at, at)] + wide
        information = float(whole[k, k] - column @ np.linalg.solve(inner, column))
        own = 0.0 if self._known[k].per_flight else self._known[k].tolerance
        return float(np.hypot(1.0 / np.sqrt(max(information, 1e-300)), own))

    def drawn(self, hide: bool) -> Draw:
        size, hidden = len(self._sides[0]), ''
        values = self._draw.normal(size=size) * np.sqrt(np.diag(self._prior.covariance))
        if hide:
            k = int(self._draw.choice(self._open))
            hidden = self._known[k].name
            strength = self._draw.uniform(*SIGMAS) * self._draw.choice([-1.0, 1.0])
            values[k] += strength * self._deviation(k)
        rights = [
            side @ values + root @ self._draw.normal(size=size)
            for side, root in zip(self._sides, self._roots, strict=True)
        ]
        whole = _reduced(sum(self._sides), sum(rights))
        first, second = (
            {
                seen.name: seen
                for seen in scan_candidates(each, np.zeros(size), self._prior, self._known)
            }
            for each in map(_reduced, self._sides, rights)
        )
        best = scan_candidates(whole, np.zeros(size), self._prior, self._known)[:ASKED]
        hints = [
            WeakCandidate(seen.name, seen.gain, (first[seen.name], second[seen.name]))
            for seen in best
            if seen.name in first and seen.name in second
        ]
        names = [hint.name for hint in hints]
        cosine = np.abs(column_cosines(whole, self._prior, names, self._known))
        alike = tuple(name for k, name in enumerate(names) if k and cosine[0, k] > ALIKE)
        return Draw(hidden, hints, alike)


def _reduced(products: Array, right: Array) -> ReducedFlight:
    """Return products with what is left over."""
    column = right[:, None]
    return ReducedFlight(np.block([[products, column], [column.T, np.zeros((1, 1))]]), 0.0)


def _named(draw: Draw, known: Sequence[FreeParameter], leasts: tuple[float, float]) -> str:
    """Return what is named, '' for nothing."""
    tolerance = {knob.name: 0.0 if knob.per_flight else knob.tolerance for knob in known}
    hints = [
        hint._replace(
            least=leasts[tolerance[hint.name] > max(side.deviation for side in hint.sides)]
        )
        for hint in draw.hints
    ]
    best = choose_candidate(hints, draw.alike)
    return best.name if best else ''


def fitted(case: Path) -> tuple[JointFit, list[FreeParameter]]:
    """Return the flights of a case as the search for faint effects begins with them."""
    vehicle = load_vehicle(str(case / 'vehicle.yaml'))
    nominal = NominalVehicle.from_vehicle(vehicle)
    known = list_free_parameters(nominal, False)
    read = select_usable_flights(
        read_bags({role: [case / role] for role in ROLES[:2]}), vehicle
    ).flights
    flights = [prepare_flight(vehicle, flight, known) for _, _, flight in read]
    bare = EffectSearch(nominal, (flights[:1], flights[1:])).run().bare
    fitter = JointFitter(nominal, flights, per_flight_variance(known), wrench_floor(nominal))
    deviations = np.sqrt(bare[0].deviations * bare[1].deviations)
    group = bare[0].group.combine_groups(bare[1].group)
    quiet = WeakEffectSearch(fitter, 1).refit_with_lower_floor(
        fitter.fit_deviations(group, bare[0].prior, deviations)
    )
    if quiet is None:
        raise SystemExit('The flights are not calm; take another case.')
    return quiet, known


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('case', type=Path)
    parser.add_argument('--draws', type=int, default=1000)
    parser.add_argument('--seed', type=int, default=1)
    asked = parser.parse_args()
    last, known = fitted(asked.case)
    drawing = Drawing(last, known, asked.seed)
    draws = [drawing.drawn(k % 2 == 1) for k in track(range(asked.draws), 'drawing')]
    clean, hidden = ([d for d in draws if bool(d.hidden) == each] for each in (False, True))
    first = sum(bool(d.hints) and _same(d.hints[0].name, d.hidden) for d in hidden)
    lines = [
        f'The hidden effect wins most in {_share(first, len(hidden))} of the draws.',
        '',
        '| least gain [nats] | within a tolerance | nothing hidden: named | exact | wrong |',
        '|---|---|---|---|---|',
    ]
    for leasts in LEASTS:
        false = sum(bool(_named(d, known, leasts)) for d in clean)
        told = [(d.hidden, _named(d, known, leasts)) for d in hidden]
        exact = sum(_same(name, true) for true, name in told if name)
        wrong = sum(not _same(name, true) for true, name in told if name)
        shares = [_share(false, len(clean)), *(_share(n, len(hidden)) for n in (exact, wrong))]
        lines.append(' | '.join(['', *map(str, leasts), *shares, '']).strip())
    sys.stdout.write('\n'.join([*lines, '']))


def _same(name: str, true: str) -> bool:
    """Tell whether two names are one to such data."""
    return is_equivalent(name, true, 'all')


def _share(hits: int, count: int) -> str:
    """Return a share with its interval."""
    _, low, high = wilson_interval(hits, count)
    return f'{hits}/{count} = {100 * hits / count:.1f} % ({100 * low:.1f} to {100 * high:.1f})'


if __name__ == '__main__':
    main()

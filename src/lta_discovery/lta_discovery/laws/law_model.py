"""Build a law from selected columns: its terms with intervals, its region, its derivatives."""

from collections.abc import Sequence
from functools import partial
from typing import Final, final, NamedTuple

from lta_config.schema.vehicle_law import coefficient_unit, HiddenState, Law, LawTerm
from lta_discovery.laws.dictionary import (
    Column,
    HIDDEN,
    list_numbers,
    move_number,
    Place,
    round_number,
)
from lta_discovery.laws.forecast import FlightLaw, Prepare
from lta_discovery.laws.forecast_refit import LawModel
from lta_discovery.laws.law_data import LawData
from lta_discovery.laws.regression import LAW_AXES
from lta_discovery.laws.selection import LawFit
from lta_discovery.selection.interval import NORMAL
from lta_model.law_arrays import evaluate_product, HIDDEN_QUANTITIES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Chosen = Sequence[tuple[Column, int]]  # columns with their axes

WEIGHTS: Final = 3.0  # deviations of the regression; prior deviation of a weight in a refit
RELATIVE: Final = 0.3  # of the weight; the least prior deviation
NUMBERS: Final = 0.2  # prior deviation of the logarithm of a scale, or of a phase
# Of the range of a quantity in the flights; other flights of the kind go as far beyond its ends
MARGIN: Final = 0.5
SMALL: Final = 0.03  # step of the derivative by a number


def list_terms(data: LawData, chosen: Chosen) -> list[tuple[Array, int]]:
    """Return the values of columns at the knots, with their axes."""
    return [(data.knots(column), axis) for column, axis in chosen]


def draft_law(data: LawData, chosen: Chosen, weights: Array, source: str) -> Law:
    """Return columns with weights as a law, without intervals and evidence."""
    hidden = next((column.hidden for column, _ in chosen if column.hidden is not None), None)
    terms = [
        LawTerm(
            axis=LAW_AXES[axis],
            coefficient=round_number(weight),
            unit=coefficient_unit(LAW_AXES[axis], column.factors, hidden),
            factors=list(column.factors),
        )
        for (column, axis), weight in zip(chosen, weights.tolist(), strict=True)
    ]
    return Law(source=source, terms=terms, hidden=hidden, region=find_region(data, terms, hidden))


def build_law(
    data: LawData, chosen: Chosen, fit: LawFit, source: str, weights: Array | None = None
) -> Law:
    """
    Return columns as a law, with the intervals and the evidence of a fit to all flights.

    Parameters
    ----------
    weights : ndarray, shape (T,), optional
        By a refit, the distance to which widens the intervals; those of the fit by default.

    """
    refitted = fit.weights if weights is None else weights
    law, every = draft_law(data, chosen, refitted, source), list_terms(data, chosen)
    halves = np.hypot(NORMAL * fit.deviation, refitted - fit.weights)
    terms = []
    for k, (term, half) in enumerate(zip(law.terms, halves.tolist(), strict=True)):
        others = [*every[:k], *every[k + 1 :]]
        # Without the term, the wrench that it explains may count as random
        rest = max(
            LawFit(data, 'all', deviations, others).evidence
            for deviations in (fit.deviations, data.joint.deviations)
        )
        ends = [round_number(float(refitted[k]) + way * half) for way in (-1.0, 1.0)]
        evidence = round_number(fit.evidence - rest)
        terms.append(term.model_copy(update={'interval': ends, 'evidence': evidence}))
    return law.model_copy(update={'terms': terms})


def find_region(
    data: LawData, terms: Sequence[LawTerm], hidden: HiddenState | None
) -> dict[str, list[float]]:
    """
    Return the range of each quantity of a law in its flights, and MARGIN beyond each end.

    Without it for heights and places of which a term is a wave that the flights do not contain in
    full: its length is that of the fit, and says nothing about where no flight was. Thrusts reach
    as far as the rotors do, since the force of a jet grows with its thrust; and a lag of first
    order as far as its drive.
    """
    factors = [factor for term in terms for factor in term.factors]
    drive = hidden.drive if hidden is not None else []
    used = {factor.quantity for factor in (*factors, *drive)}
    state = data.quantities(hidden)
    region = {}
    for name in sorted(used):
        low, high = float(np.min(state[name])), float(np.max(state[name]))
        beyond = MARGIN * (high - low)
        waves = [one for one in factors if one.quantity == name and one.form == 'sin']
        longest = max((one.scale or 0.0 for one in waves), default=0.0)
        if name != 'yaw' and longest > high - low:
            beyond = 0.0
        if name in HIDDEN_QUANTITIES and hidden is not None:
            low, high = _hidden_range(name, hidden, evaluate_product(drive, state), (low, high))
        low, high = low - max(beyond, 1e-9), high + max(beyond, 1e-9)
        least, most = data.reach.get(name, (low, high))
        region[name] = [round_number(min(low, least)), round_number(max(high, most))]
    return region


def _hidden_range(
    name: str, hidden: HiddenState, drive: Array, ends: tuple[float, float]
) -> tuple[float, float]:
    """Return the range of a hidden state or of its rate, which includes its start."""
    start = hidden.start or 0.0
    begun = start if name == HIDDEN_QUANTITIES[0] else 0.0
    low, high = min(ends[0], begun), max(ends[1], begun)
    if hidden.time_constant is None:
        return low, high
    # It stays between its start and the extremes of the drive, also those beyond the flights
    beyond = MARGIN * float(np.ptp(drive))
    least, most = float(np.min(drive)) - beyond, float(np.max(drive)) + beyond
    least, most = min(start, least), max(start, most)
    if name == HIDDEN_QUANTITIES[0]:
        return min(low, least), max(high, most)
    fastest = (most - least) / hidden.time_constant
    return min(low, -fastest), max(high, fastest)


@final
class Numbers(NamedTuple):
    """Selected columns with the numbers that a refit moves: the column, and its number."""

    chosen: Chosen
    places: Sequence[tuple[int, Place]]

    def move(self, data: LawData, steps: Array) -> Chosen:
        """Return the columns with their numbers moved; terms share the hidden state."""
        columns = [column for column, _ in self.chosen]
        for (k, place), step in zip(self.places, steps.tolist(), strict=True):
            for j, column in enumerate(columns):
                if j == k or (place[0] == HIDDEN and column.hidden is not None):
                    columns[j] = move_number(column, place, step, data.spreads)
        return [(column, axis) for column, (_, axis) in zip(columns, self.chosen, strict=True)]


def list_own_numbers(chosen: Chosen) -> list[tuple[int, Place]]:
    """Return the numbers that columns have, those of the hidden state once."""
    out: list[tuple[int, Place]] = []
    for k, (column, _) in enumerate(chosen):
        for place in list_numbers(column):
            if place[0] == HIDDEN:
                if all(there != place for _, there in out):
                    out.append((k, place))
            elif getattr(column.factors[place[0]], place[1]) is not None:
                out.append((k, place))
    return out


def build_law_model(data: LawData, chosen: Chosen, fit: LawFit) -> LawModel:
    """Return a law as a function of its weights and numbers."""
    numbers, count = Numbers(chosen, list_own_numbers(chosen)), len(chosen)

    def prepare(weights: Array) -> Prepare:
        there = numbers.move(data, weights[count:])
        return partial(FlightLaw, draft_law(data, there, weights[:count], 'a trial'))

    def evaluate(steps: Array) -> Array:
        """Return the terms in the body frame, shape (S, 6 K, T)."""
        there = numbers.move(data, steps)
        return np.stack([data.body_knots(column, axis) for column, axis in there], axis=-1)

    def differentiate(weights: Array) -> list[Array]:
        steps = weights[count:]
        columns = [evaluate(steps)]
        for small in SMALL * np.eye(len(steps)):
            change = (evaluate(steps + small) - evaluate(steps - small)) / (2.0 * SMALL)
            columns.append((change @ weights[:count])[..., None])
        return data.split_flights(np.concatenate(columns, axis=-1))

    more = len(numbers.places)
    spread = np.maximum(WEIGHTS * fit.deviation, RELATIVE * np.abs(fit.weights))
    return LawModel(
        np.concatenate([fit.weights, np.zeros(more)]),
        np.concatenate([spread, np.full(more, NUMBERS)]),
        prepare,
        differentiate,
    )

"""
Select the terms of a law by evidence, one at a time, and refine their numbers.

A column is worth its Bayes factor on all flights less its cost: the logarithm of the number of
columns of its tier and the tiers before, and something for its forms. Training and confirming
flights have to support it alone, with one weight. With every term the deviations of the remaining
wrench are fitted again, as a missing term inflates them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final, NamedTuple

from lta_config.schema.vehicle_law import REGION
from lta_discovery.laws.dictionary import Column, MOTIONS, THRUSTS, vary_numbers
from lta_discovery.laws.law_data import LawData, Side
from lta_discovery.laws.regression import LAW_AXES, TermProducts
from lta_discovery.replay.linearized_flight import AXES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Term = tuple[Array, int]  # values at the knots, shape (S, K), and axis

SIZES: Final = (2.0, 8.0, 30.0)  # noise floors; prior RMS of a term
MOST: Final = 6  # terms
WORTH: Final = 4.0  # nats beyond the cost; required of a further term
SUPPORT: Final = 1.0  # nats; required of a term on each side
BLIND: Final = 2.0  # nats; a side that expects less of a term cannot support it
SINGLE: Final = 20.0  # nats; cost of a term that one side supports alone
SHRUNK: Final = (0.5, 0.25)  # trial factors on the deviations
FITTED: Final = (0.7, 0.5, 0.35, 0.25, 0.17)  # the same, for the fit after each term
TRIED: Final = 8  # best columns of a round, whose numbers are refined
LOUD: Final = 0.5  # noise floors; deviations below it are not shrunk further
# Nats; further cost of a factor by its form
FORMS: Final = {'linear': 0.0, 'modulus': 1.0, 'positive': 2.0}
OTHER: Final = 3.0  # nats; the same of any other form
NUMBER: Final = 3.0  # nats; cost of a number that is fitted in addition
REPEATED: Final = 0.02  # of its information; a column with less beside the others repeats them
STEPS: Final = (0.35, 0.15, 0.06, 0.02)  # of numbers, in the logarithm
CLIMBS: Final = 8  # most steps of a size
# Quantities of one kind, by name
KINDS: Final = {
    **dict.fromkeys(MOTIONS, 'motion'),
    **dict.fromkeys(('roll', 'pitch'), 'tilt'),
    **dict.fromkeys('xy', 'place'),
    **dict.fromkeys(THRUSTS, 'thrust'),
}
# Axes of the wrench whose deviations shrink together, and the axes of terms tried with them
GROUPS: Final = (*(((k,), (k,)) for k in range(AXES)), ((0, 1, 2), (6, 7, 8)))


@final
class LawFit:
    """Weights of terms in the flights of a side; a constant on each axis is fitted as well."""

    def __init__(
        self, data: LawData, side: Side, deviations: Array, terms: Sequence[Term]
    ) -> None:
        self.data, self.side, self.deviations = data, side, deviations
        self.regression = data.regress(side, deviations)
        rows = data.rows[side]
        ones = np.ones((rows.stop - rows.start, self.regression.knots))
        self._terms: list[Term] = [(ones, axis) for axis in range(AXES)]
        self._terms += [(values[rows], axis) for values, axis in terms]
        self.products: TermProducts = self.regression.products(self._terms)
        self._variance = np.array([self._prior_variance(j) for j in range(len(self._terms))])
        precision = self.products.inner + np.diag(1.0 / self._variance)
        self._covariance = np.linalg.inv(precision)
        self._weights = self._covariance @ self.products.right
        logs = np.linalg.slogdet(precision)[1] + float(np.log(self._variance).sum())
        gain = 0.5 * float(self.products.right @ self._weights) - 0.5 * float(logs)
        self.evidence = self.regression.base + gain
        self._asides = [self.regression.scan(v[..., None], a)[2][:, 0] for v, a in self._terms]

    @property
    def weights(self) -> Array:
        """Weights of the terms, without the constants."""
        return self._weights[AXES:]

    @property
    def deviation(self) -> Array:
        """Standard deviations of the weights."""
        out: Array = np.sqrt(np.diag(self._covariance))[AXES:]
        return out

    @property
    def shared(self) -> Array:
        """Most probable shared parameters with these terms."""
        return self.regression.shared_parameters(self.products, self._weights)

    def _prior_variance(self, j: int) -> float:
        """Return the variance of the prior of a weight: the best of SIZES."""
        inner, right = self.products.inner[j, j], self.products.right[j]
        values, axis = self._terms[j]
        usual = self.data.axis_floor(axis) / max(float(np.sqrt(np.mean(values**2))), 1e-12)
        gains = _gain(right, inner, usual * np.array(SIZES))
        return float((usual * SIZES[int(np.argmax(gains))]) ** 2)

    def residual_products(self, basis: Array, axis: int) -> tuple[Array, Array]:
        """Return pull and information of further columns (S, K, J) of all flights, given these."""
        here = basis[self.data.rows[self.side]]
        right, diagonal, aside = self.regression.scan(here, axis)
        cross = np.stack(
            [
                self.regression.cross(here, axis, aside, values, at, beside)
                for (values, at), beside in zip(self._terms, self._asides, strict=True)
            ]
        )
        pull = right - cross.T @ self._weights
        inner = diagonal - np.einsum('kj,kl,lj->j', cross, self._covariance, cross)
        # A repetition of what is there already, which would only widen the prior of its weight
        own = np.diag(self.products.inner)[:, None]
        alike = (cross**2 > (1.0 - REPEATED) * own * diagonal).any(axis=0)
        inner[alike | (inner < REPEATED * diagonal)] = 0.0
        return pull, inner


def _gain(pull: Array, inner: Array, size: Array) -> Array:
    """Return the log evidence of a term for a prior size of its weight."""
    out: Array = 0.5 * pull**2 / (inner + size**-2.0) - 0.5 * np.log1p(size**2 * inner)
    return out


@final
class Candidate(NamedTuple):
    """A column on an axis as a further term."""

    worth: float  # log evidence less its cost [nats]
    column: Column
    axis: int
    base_terms: 'GivenTerms'
    cost: float  # with what the deviations of `base_terms` lose [nats]
    price: float  # the cost of the column alone [nats]


@final
class Choice(NamedTuple):
    """A term of the law."""

    column: Column
    axis: int
    cost: float  # [nats]


@final
@dataclass(frozen=True, slots=True)
class GivenTerms:
    """The terms so far, on both sides."""

    sides: tuple[LawFit, LawFit]

    @classmethod
    def fit(cls, data: LawData, deviations: Array, terms: Sequence[Term]) -> 'GivenTerms':
        """Fit terms on both sides."""
        train = LawFit(data, 'train', deviations, terms)
        return cls((train, LawFit(data, 'confirm', deviations, terms)))

    @property
    def evidence(self) -> float:
        """Log evidence of both sides. [nats]"""
        return self.sides[0].evidence + self.sides[1].evidence

    def gains(self, basis: Array, axis: int) -> Array:
        """
        Return the gain of the log evidence by each column as a further term, shape (J,). [nats]

        It is minus infinity for a column that training or confirming flights do not support. A
        side that did not fly what it takes, such as slips to one side, need not support it.
        """
        data = self.sides[0].data
        size = np.maximum(np.sqrt(np.mean(basis**2, axis=(0, 1))), 1e-9)
        usual = data.axis_floor(axis) / size
        parts = [side.residual_products(basis, axis) for side in self.sides]
        (a, inner_a), (b, inner_b) = parts
        defined = (inner_a > 0.0) & (inner_b > 0.0)
        # A column that is 0 in all flights of a side, as beyond a threshold that they never reach
        absent = [(pull == 0.0) & (inner == 0.0) for pull, inner in parts]
        alone_flown = (absent[0] & (inner_b > 0.0)) | (absent[1] & (inner_a > 0.0))
        # Each side must be better with the weight from the other
        weights = [
            np.where(defined, own / np.where(defined, inner, 1.0), 0.0) for own, inner in parts
        ]
        alone, expected = np.array(
            [
                (weight * own - 0.5 * weight**2 * inner, 0.5 * weight**2 * inner)
                for weight, (own, inner) in zip(weights[::-1], parts, strict=True)
            ]
        ).swapaxes(0, 1)
        agreed = (alone > SUPPORT).all(axis=0)
        # What a side did not fly it cannot support, nor can its weight judge the other side
        blind = (expected < BLIND) & (alone > -SUPPORT)
        supported = defined & (agreed | (blind[0] ^ blind[1])) | alone_flown
        single = np.where(agreed, 0.0, SINGLE)
        out = np.full(len(size), -np.inf)
        for s in SIZES:
            both = _gain(a + b, inner_a + inner_b, s * usual)
            out = np.maximum(out, np.where(supported, both - single, -np.inf))
        return out


def column_costs(columns: Sequence[Column]) -> Array:
    """Return the cost of each column: the logarithm of the number in its tier and below. [nats]"""
    tiers = np.array([column.tier for column in columns])
    count = np.array([np.sum(tiers <= tier) for tier in tiers])
    drives = [tuple(column.hidden.drive) if column.hidden else () for column in columns]
    forms = [
        sum(FORMS.get(factor.form, OTHER) for factor in (*column.factors, *drive))
        for column, drive in zip(columns, drives, strict=True)
    ]
    return np.asarray(np.log(len(LAW_AXES) * count) + np.array(forms))


def price_akin_columns(columns: Sequence[Column], costs: Array, chosen: Sequence[Column]) -> Array:
    """
    Return the costs of columns beside chosen ones, which make those akin to them likely. [nats]

    A force has a lever arm, and what acts along one axis often acts along another. So half of the
    prior is on columns with the same forms of quantities of the same kind, or with the same state.
    """
    if not chosen:
        return costs
    kinds = {_list_kinds(column) for column in chosen}
    akin = np.array([_list_kinds(column) in kinds for column in columns])
    cheap = np.log(2.0 * len(LAW_AXES) * max(int(akin.sum()), 1))
    return np.where(akin, np.minimum(costs, cheap), costs + np.log(2.0))


def _list_kinds(column: Column) -> tuple[tuple[str, str], ...]:
    """Return the kinds of quantity in a column, each with its form; those of a drive last."""
    drive = column.hidden.drive if column.hidden is not None else []
    named = [
        sorted((KINDS.get(factor.quantity, factor.quantity), factor.form) for factor in factors)
        for factors in (column.factors, drive)
    ]
    return (*named[0], *named[1])


def _count_numbers(column: Column) -> int:
    """Return how many numbers the factors of a column have."""
    return sum(len(factor.numbers) for factor in column.factors)


def _scan(
    data: LawData, current: GivenTerms, terms: Sequence[Term], columns: Sequence[Column],
    basis: Array, costs: Array,
) -> list[Candidate]:  # fmt: skip
    """Return the best further columns, also for smaller deviations of each axis."""
    out, deviations = [], current.sides[0].deviations
    body = np.flatnonzero([not column.along_map for column in columns])
    both = (basis[..., body], body), (basis, np.arange(len(columns)))
    for own, axes in GROUPS:
        loud = float(np.max(deviations[list(own)] / data.floor[list(own)])) > LOUD
        for share in (1.0, *(SHRUNK if loud else ())):
            there = current
            if share < 1.0:
                there = GivenTerms.fit(data, data.shrink(deviations, own, share), terms)
            # What smaller deviations win alone is no merit of a column
            dear = costs + max(current.evidence - there.evidence, 0.0)
            for axis in axes:
                tried, index = both[axis >= AXES]
                worth = there.gains(tried, axis) - dear[index]
                best = np.argsort(-worth)[:TRIED]
                out += [
                    Candidate(value, columns[j], axis, there, float(dear[j]), float(costs[j]))
                    for value, j in zip(worth[best].tolist(), index[best].tolist(), strict=True)
                    if math.isfinite(value)
                ]
    return sorted(out, key=lambda one: -one.worth)


def _refine(data: LawData, one: Candidate) -> Candidate:
    """Return a candidate with better numbers, by steps of the one that wins most."""
    best = one
    for step in STEPS:
        for _ in range(CLIMBS):
            others = vary_numbers(best.column, data.spreads, step)
            if not others:
                return best
            more = np.array([_count_numbers(other) for other in others])
            worth = one.base_terms.gains(data.basis(others), one.axis) - one.cost
            worth -= NUMBER * (more - _count_numbers(one.column))
            k = int(np.argmax(worth))
            if not worth[k] > best.worth:
                break
            best = best._replace(column=others[k], worth=float(worth[k]))
    return best


def adapt_deviations(
    data: LawData, current: GivenTerms, terms: Sequence[Term], axis: int
) -> GivenTerms:
    """Return the fit with the deviations on the axes of a new term fitted by trial factors."""
    best = current
    groups = [(axis,)] if axis < AXES else [(0, 1, 2), (0,), (1,), (2,)]
    for own in groups:
        begun = best.sides[0].deviations
        for share in FITTED:
            trial = GivenTerms.fit(data, data.shrink(begun, own, share), terms)
            if trial.evidence <= best.evidence:
                break
            best = trial
    return best


def select_terms(
    data: LawData, columns: Sequence[Column], deviations: Array, most: int = MOST
) -> tuple[list[tuple[Column, int]], GivenTerms]:
    """Return the selected columns with their axes, and their fit."""
    costs, basis = column_costs(columns), data.basis(columns)
    chosen: list[Choice] = []
    current = GivenTerms.fit(data, deviations, [])
    while len(chosen) < most:
        best = _choose_column(data, current, chosen, columns, basis, costs)
        if best is None:
            break
        more = [*chosen, Choice(best.column, best.axis, best.price)]
        terms = _list_terms(data, more)
        here = GivenTerms.fit(data, best.base_terms.sides[0].deviations, terms)
        there = adapt_deviations(data, here, terms, best.axis)
        left, revised = _revise(data, more, there)
        if _count_worth(left, revised) < _count_worth(chosen, current):
            # Terms that stood without the new one fell beside it
            break
        chosen, current = left, revised
        # What is dropped again would be chosen again
        if len(chosen) < len(more):
            break
    return [(one.column, one.axis) for one in chosen], current


def _count_worth(chosen: Sequence[Choice], current: GivenTerms) -> float:
    """Return the log evidence of terms less their costs. [nats]"""
    return current.evidence - sum(one.cost for one in chosen)


def _list_terms(data: LawData, chosen: Sequence[Choice]) -> list[Term]:
    """Return the values of the chosen columns."""
    return [(data.knots(one.column), one.axis) for one in chosen]


def _choose_column(
    data: LawData, current: GivenTerms, chosen: Sequence[Choice], columns: Sequence[Column],
    basis: Array, costs: Array,
) -> Candidate | None:  # fmt: skip
    """Return the best further column with refined numbers; None if none is worth it."""
    state = next((one.column.hidden for one in chosen if one.column.hidden is not None), None)
    best, ours = None, [one.column for one in chosen]
    ours = [column for k, column in enumerate(ours) if column not in ours[:k]]
    if ours:
        # The chosen columns as they were refined, for other axes
        columns, basis = [*columns, *ours], np.concatenate([basis, data.basis(ours)], axis=-1)
        costs = price_akin_columns(columns, np.concatenate([costs, column_costs(ours)]), ours)
    for each in _scan(data, current, _list_terms(data, chosen), columns, basis, costs)[:TRIED]:
        one = each
        if one.column.hidden is not None and state is not None:
            # One hidden state: a second output must be of the same
            column = replace(one.column, hidden=state)
            worth = float(one.base_terms.gains(data.basis([column]), one.axis)[0]) - one.cost
            one = one._replace(column=column, worth=worth)
        else:
            one = _refine(data, one)
        if count_quantities([*(each.column for each in chosen), one.column]) > REGION:
            continue
        if one.worth > WORTH and (best is None or one.worth > best.worth):
            best = one
    return best


def count_quantities(columns: Sequence[Column]) -> int:
    """Return on how many quantities a law with these columns depends."""
    used = [factor for column in columns for factor in column.factors]
    for column in columns:
        used += column.hidden.drive if column.hidden is not None else []
    return len({factor.quantity for factor in used})


def _revise(
    data: LawData, chosen: Sequence[Choice], current: GivenTerms
) -> tuple[list[Choice], GivenTerms]:
    """Refine each term beside the others, and drop those that are not worth their cost."""
    out = list(chosen)
    deviations = current.sides[0].deviations
    shared = sum(one.column.hidden is not None for one in out) > 1
    for one in chosen if len(chosen) > 1 else ():
        k = out.index(one)
        others = GivenTerms.fit(data, deviations, _list_terms(data, [*out[:k], *out[k + 1 :]]))
        worth = float(others.gains(data.basis([one.column]), one.axis)[0]) - one.cost
        term = Candidate(worth, one.column, one.axis, others, one.cost, one.cost)
        if not (shared and one.column.hidden is not None):
            term = _refine(data, term)
        out[k : k + 1] = [one._replace(column=term.column)] if term.worth > 0.0 else []
    return out, GivenTerms.fit(data, deviations, _list_terms(data, out))

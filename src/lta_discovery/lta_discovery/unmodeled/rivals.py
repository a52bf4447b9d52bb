"""
Compute the evidence of generic rivals, comparable with that of library effects.

Without rivals, the best library effect is accepted by default: a tether would be named drag. A
rival is a group of generic terms with weights that all pieces share. Its Bayes factor follows from
the products of the fit by linear algebra. The size of the weights is marginalized, and the
deviations of the remaining latent wrench may shrink.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import log_prior
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.unmodeled.fit_baseline import FitBaseline, GroupProducts, TermColumns
from lta_discovery.unmodeled.generic_terms import (
    compute_term_inputs,
    CONSTANT,
    FlightBoundingBox,
    list_term_groups,
    TermGroup,
)
from lta_model.effects.protocol import AXES as NAMES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIZES: Final = (3.0, 10.0, 40.0)  # noise floors; prior sizes of a group's weights
SHRUNK: Final = (1.0, 0.6, 0.35, 0.2)  # trial factors on the deviations
SETTLED: Final = 5  # number of best rivals with refitted deviations
ALONE: Final = (
    1.4,
    0.7,
    0.5,
    0.35,
    0.25,
    0.15,
    0.1,
)  # trial factors on the deviations of a rival's axes
LEAST: Final = 0.05  # noise floors; smallest deviation


@final
class GroupGain(NamedTuple):
    """Evidence of a group on one side."""

    gain: float  # log evidence [nats]
    # Of its weights, shape (J,)
    mean: Array
    covariance: Array
    deviations: Array  # of the remaining latent wrench, shape (6,) [N, N m]


@final
class GenericRival(NamedTuple):
    """A generic explanation."""

    name: str  # 'heave by height'
    gain: float  # log evidence on the training flights [nats]
    # On the confirming flights alone, and with the weights of the training flights. Gusts fit some
    # terms on each side, but not the same weights.
    confirmed: float
    carried: float
    axis: str
    axes: tuple[str, ...]
    size: float  # RMS on the main axis [N, N m]
    term: str
    share: float  # explained share of the variance on the axis

    @property
    def total_evidence(self) -> float:
        """Evidence of both sides. [nats]"""
        return self.gain + max(self.confirmed, self.carried)


@final
class GroupComparison:
    """Compare groups on jointly fitted flights."""

    def __init__(self, columns: TermColumns) -> None:
        self.standing, self._columns = columns.standing, columns
        self.known = [{group.name: group for group in each} for each in columns.known]

    def _group_evidence(self, there: GroupProducts, name: str, taught: GroupGain | None) -> float:
        """Return the log evidence with a group."""
        inner, right = there.inner[name], there.right[name]
        if taught is not None:
            return there.base + _weights_evidence(
                inner, right, taught.mean, 1.5 * taught.covariance
            )
        each = _evidence_by_size(inner, right)
        return there.base + float(np.logaddexp.reduce(each)) - float(np.log(len(SIZES)))

    def compute_group_gains(
        self, taught: Mapping[str, GroupGain] | None = None, most: int = SETTLED
    ) -> dict[str, GroupGain]:
        """
        Return the evidence of each group.

        `taught`: weights from the other side. `most`: number of best groups with refitted
        deviations.
        """
        names, now = list(self.known[0] if taught is None else taught), self.standing.deviations
        # A group may explain much of the latent wrench: try smaller deviations
        starts = [share * now for share in SHRUNK] + [np.minimum(now, 1.5 * self.standing.floor)]
        seen = [(start, self._columns.reduce_groups(start, names)) for start in starts]
        at: dict[str, tuple[float, Array, GroupProducts]] = {}
        for name in names:
            before = None if taught is None else taught[name]
            scores = [
                self._group_evidence(there, name, before) + log_prior(start, self.standing.floor)
                for start, there in seen
            ]
            k = int(np.argmax(scores))
            at[name] = scores[k], *seen[k]
        # Refitting is slow, so only for the best groups
        for name in sorted(names, key=lambda one: -at[one][0])[:most]:
            at[name] = self._fit_deviations(
                name, at[name], None if taught is None else taught[name]
            )
        base = self.standing.evidence
        return {name: self._evaluate_group(name, at[name], base, taught) for name in names}

    def _fit_deviations(
        self, name: str, at: tuple[float, Array, GroupProducts], taught: GroupGain | None
    ) -> tuple[float, Array, GroupProducts]:
        """Refit the deviations on a group's axes by trial factors."""
        axes = list(self.known[0][name].axes)
        fitted = at
        for share in ALONE:
            deviations = at[1].copy()
            least = LEAST * self.standing.floor[axes]
            deviations[axes] = np.maximum(share * deviations[axes], least)
            there = self._columns.reduce_groups(deviations, [name])
            score = self._group_evidence(there, name, taught) + log_prior(
                deviations, self.standing.floor
            )
            fitted = max(fitted, (score, deviations, there), key=lambda one: one[0])
        return fitted

    def _evaluate_group(
        self,
        name: str,
        at: tuple[float, Array, GroupProducts],
        base: float,
        taught: Mapping[str, GroupGain] | None,
    ) -> GroupGain:
        """Return the evidence of a group, and its weights."""
        score, deviations, there = at
        inner, right = there.inner[name], there.right[name]
        if taught is None:
            each = _evidence_by_size(inner, right)
            size = SIZES[int(np.argmax(each))]
            mean, wide = np.zeros(len(right)), np.eye(len(right)) * size**2 / len(right)
        else:
            mean, wide = taught[name].mean, 1.5 * taught[name].covariance
        inverse = np.linalg.inv(wide)
        covariance = np.linalg.inv(inner + inverse)
        return GroupGain(
            float(score - base), covariance @ (right + inverse @ mean), covariance, deviations
        )


def _weights_evidence(inner: Array, right: Array, mean: Array, covariance: Array) -> float:
    """Return the log evidence of weights with a prior, against weights of 0."""
    inverse = np.linalg.inv(covariance)
    pull = right + inverse @ mean
    together = inner + inverse
    square = pull @ np.linalg.solve(together, pull) - mean @ inverse @ mean
    # Occam factor: volume of the posterior by that of the prior
    logs = np.linalg.slogdet(together)[1] + np.linalg.slogdet(covariance)[1]
    return float(0.5 * square - 0.5 * logs)


def _evidence_by_size(inner: Array, right: Array) -> list[float]:
    """Return the log evidence of weights for each of SIZES."""
    count = len(right)
    return [
        _weights_evidence(inner, right, np.zeros(count), np.eye(count) * s**2 / count)
        for s in SIZES
    ]


@final
class RivalSearch:
    """Search generic rivals on the flights of a study."""

    def __init__(self, flights: Sequence[Sequence[FlightLinearizer]]) -> None:
        self.flights = flights
        places = [each.replay.flight.position for side in flights for each in side]
        self._scene = FlightBoundingBox.from_positions(
            [each[np.isfinite(each).all(axis=1)] for each in places]
        )

    def build_group_comparison(self, side: int, baseline: FitBaseline) -> GroupComparison:
        """Build the comparison of all groups on the flights of one side."""
        pairs = zip(self.flights[side], baseline.linears, strict=True)
        groups = [
            list(
                list_term_groups(
                    compute_term_inputs(flight, linear.point),
                    self._scene,
                    baseline.floor,
                    linear.knots,
                )
            )
            for flight, linear in pairs
        ]
        return GroupComparison(TermColumns(baseline, groups))

    def rank_rivals(self, standings: Sequence[FitBaseline]) -> tuple[GenericRival, ...]:
        """Return all rivals, the best first."""

        def compare_side(
            one: tuple[int, FitBaseline],
        ) -> tuple[GroupComparison, dict[str, GroupGain]]:
            comparison = self.build_group_comparison(*one)
            return comparison, comparison.compute_group_gains()

        (first, train_gains), (second, alone) = map_parallel(
            compare_side, list(enumerate(standings))
        )
        # The confirming flights with the weights of the training flights
        carried = second.compute_group_gains(train_gains)
        out = [
            _build_rival(
                [each[name] for each in first.known],
                train_gains[name],
                (alone[name].gain, carried[name].gain),
                standings[0].floor,
            )
            for name in train_gains
        ]
        return tuple(sorted(out, key=lambda rival: -rival.total_evidence))


def _build_rival(
    group: Sequence[TermGroup], taught: GroupGain, others: tuple[float, float], floor: Array
) -> GenericRival:
    """Return a rival with its size and its largest term, from the group on each flight."""
    # One row per knot, as flights may differ in their number of knots
    rows = [np.moveaxis(each.values, -1, 1) for each in group]
    values = np.concatenate([each.reshape(-1, *each.shape[2:]) for each in rows])
    each = np.sqrt(np.mean((values * taught.mean[:, None]) ** 2, axis=0))
    # Wrench of the whole group at the knots
    whole = np.einsum('rja,j->ra', values, taught.mean)
    sizes = np.sqrt(np.mean(whole**2, axis=0))
    axis = int(np.argmax(sizes / floor))
    terms = np.array(group[0].terms)
    # Down-weight the constant term: it describes a force only if nothing else does.
    weight = np.where(terms == CONSTANT, 0.2, 1.0) * each[:, axis]
    term = str(terms[int(np.argmax(weight))])
    size, rest = float(sizes[axis]), float(taught.deviations[axis])
    # Of the variance: explained by explained plus remaining
    share = size**2 / (size**2 + rest**2)
    axes = tuple(NAMES[k] for k in group[0].axes)
    return GenericRival(group[0].name, taught.gain, *others, NAMES[axis], axes, size, term, share)

"""
Rivals of the library: what a generic force would explain, in the same currency as an effect.

Without rivals the best of the library wins by default, and a tether is called drag. A rival is a
group of generic terms: the latent wrench may follow them with weights that all pieces share. What
it wins is a Bayes factor beside all nuisances, found by algebra on the products that a fit has
already; the size of its weights is averaged over, and the deviations of the rest of the latent
wrench are free to shrink where it takes over.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import log_prior
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.linearizer import FlightLinearizer
from lta_discovery.unmodeled.fit_baseline import FitBaseline, GroupProducts, TermColumns
from lta_discovery.unmodeled.generic_terms import (
    compute_term_inputs,
    CONSTANT,
    FlightBox,
    list_term_groups,
    TermGroup,
)
from lta_model.effects.protocol import AXES as NAMES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIZES: Final = (3.0, 10.0, 40.0)  # floors; of the weights of a group together
SHRUNK: Final = (1.0, 0.6, 0.35, 0.2)  # of the deviations that are looked at
SETTLED: Final = 5  # of the rivals, of which the deviations are found anew
ALONE: Final = (1.4, 0.7, 0.5, 0.35, 0.25, 0.15, 0.1)  # of those of its axes, to find them
LEAST: Final = 0.05  # floors


@final
class GroupGain(NamedTuple):
    """
    What a group wins on one flight.

    Attributes
    ----------
    gain : float
        Log evidence. [nats]
    mean, covariance : ndarray, shape (J,) and (J, J)
        Of its weights.
    deviations : ndarray, shape (6,)
        Of the latent wrench beside it. [N, N m]

    """

    gain: float
    mean: Array
    covariance: Array
    deviations: Array


@final
class GenericRival(NamedTuple):
    """
    A generic explanation.

    Attributes
    ----------
    name : str
        'heave by height'.
    gain : float
        Log evidence that it wins on the first flight. [nats]
    confirmed, carried : float
        On the other by itself, and with what the first has taught: gusts seem to follow
        something on each flight, but not the same.
    axis : str
        On which it mostly acts.
    axes : tuple of str
        On which it acts at all.
    size : float
        Root mean square of it there. [N, N m]
    term : str
        Which of its terms is the largest.
    share : float
        Of the variance on the axis, what follows it.

    """

    name: str
    gain: float
    confirmed: float
    carried: float
    axis: str
    axes: tuple[str, ...]
    size: float
    term: str
    share: float

    @property
    def total_evidence(self) -> float:
        """Evidence of both flights. [nats]"""
        return self.gain + max(self.confirmed, self.carried)


@final
class RivalContest:
    """
    The groups on flights that were fitted together, ready to be weighed.

    Parameters
    ----------
    columns : Columns
        Of all groups.

    """

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

    def compute_gains(
        self, taught: Mapping[str, GroupGain] | None = None, most: int = SETTLED
    ) -> dict[str, GroupGain]:
        """
        Return what each group wins.

        Parameters
        ----------
        taught : mapping, optional
            What another flight says of the weights.
        most : int
            How many of the best get their own deviations.

        """
        names, now = list(self.known[0] if taught is None else taught), self.standing.deviations
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
        for name in sorted(names, key=lambda one: -at[one][0])[:most]:
            at[name] = self._fit_deviations(
                name, at[name], None if taught is None else taught[name]
            )
        base = self.standing.evidence
        return {name: self._build_gain(name, at[name], base, taught) for name in names}

    def _fit_deviations(
        self, name: str, at: tuple[float, Array, GroupProducts], taught: GroupGain | None
    ) -> tuple[float, Array, GroupProducts]:
        """Return a group with the most probable deviations of what it leaves on its axes."""
        axes = list(self.known[0][name].axes)
        found = at
        for share in ALONE:
            deviations = at[1].copy()
            least = LEAST * self.standing.floor[axes]
            deviations[axes] = np.maximum(share * deviations[axes], least)
            there = self._columns.reduce_groups(deviations, [name])
            score = self._group_evidence(there, name, taught) + log_prior(
                deviations, self.standing.floor
            )
            found = max(found, (score, deviations, there), key=lambda one: one[0])
        return found

    def _build_gain(
        self,
        name: str,
        at: tuple[float, Array, GroupProducts],
        base: float,
        taught: Mapping[str, GroupGain] | None,
    ) -> GroupGain:
        """Return what a group wins, and its weights."""
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
    """Return the log evidence of weights with a prior, against none."""
    inverse = np.linalg.inv(covariance)
    pull = right + inverse @ mean
    together = inner + inverse
    square = pull @ np.linalg.solve(together, pull) - mean @ inverse @ mean
    logs = np.linalg.slogdet(together)[1] + np.linalg.slogdet(covariance)[1]
    return float(0.5 * square - 0.5 * logs)


def _evidence_by_size(inner: Array, right: Array) -> list[float]:
    """Return the log evidence of weights of each of SIZES."""
    count = len(right)
    return [
        _weights_evidence(inner, right, np.zeros(count), np.eye(count) * s**2 / count)
        for s in SIZES
    ]


@final
class RivalSearch:
    """
    Rivals of the library on the flights of one study.

    Parameters
    ----------
    flights : pair of sequences of Linearised
        Those that teach, and those that confirm.

    """

    def __init__(self, flights: Sequence[Sequence[FlightLinearizer]]) -> None:
        self.flights = flights
        places = [each.replay.flight.position for side in flights for each in side]
        self._scene = FlightBox.from_places(
            [each[np.isfinite(each).all(axis=1)] for each in places]
        )

    def build_contest(self, side: int, baseline: FitBaseline) -> RivalContest:
        """Return the flights of one side with all groups."""
        flown = zip(self.flights[side], baseline.linears, strict=True)
        known = [
            list(
                list_term_groups(
                    compute_term_inputs(flight, linear.point),
                    self._scene,
                    baseline.floor,
                    linear.knots,
                )
            )
            for flight, linear in flown
        ]
        return RivalContest(TermColumns(baseline, known))

    def rank_rivals(self, standings: Sequence[FitBaseline]) -> tuple[GenericRival, ...]:
        """
        Return all rivals, the best first.

        Parameters
        ----------
        standings : pair of Standing
            Of the flights that teach and of those that confirm, with the effects that are in the
            model now.

        """

        def run_contest(one: tuple[int, FitBaseline]) -> tuple[RivalContest, dict[str, GroupGain]]:
            made = self.build_contest(*one)
            return made, made.compute_gains()

        (first, taught), (second, alone) = map_parallel(run_contest, list(enumerate(standings)))
        carried = second.compute_gains(taught)
        out = [
            _build_rival(
                [each[name] for each in first.known],
                taught[name],
                (alone[name].gain, carried[name].gain),
                standings[0].floor,
            )
            for name in taught
        ]
        return tuple(sorted(out, key=lambda rival: -rival.total_evidence))


def _build_rival(
    group: Sequence[TermGroup], taught: GroupGain, others: tuple[float, float], floor: Array
) -> GenericRival:
    """Return a rival with its size and its largest term, from the group on each flight."""
    values = np.concatenate([each.values for each in group])
    each = np.sqrt(np.mean((values * taught.mean[:, None, None]) ** 2, axis=(0, 3)))
    whole = np.einsum('sjak,j->sak', values, taught.mean)
    sizes = np.sqrt(np.mean(whole**2, axis=(0, 2)))
    axis = int(np.argmax(sizes / floor))
    terms = np.array(group[0].terms)
    # What stays the same is a description only where there is nothing else.
    weight = np.where(terms == CONSTANT, 0.2, 1.0) * each[:, axis]
    term = str(terms[int(np.argmax(weight))])
    size, rest = float(sizes[axis]), float(taught.deviations[axis])
    share = size**2 / (size**2 + rest**2)
    axes = tuple(NAMES[k] for k in group[0].axes)
    return GenericRival(group[0].name, taught.gain, *others, NAMES[axis], axes, size, term, share)

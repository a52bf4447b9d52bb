"""
Rivals of the library: what a generic force would explain, in the same currency as an effect.

Without rivals the best of the library wins by default, and a tether is called drag. A rival is a
group of generic terms: the latent wrench may follow them with weights that all pieces share. What
it wins is a Bayes factor beside all nuisances, found by algebra on the products that a fit has
already; the size of its weights is averaged over, and the deviations of the rest of the latent
wrench are free to shrink where it takes over.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final, NamedTuple

from lta_analysis.discovery.evidence import (
    FLOOR,
    knot_precision,
    log_prior,
    PIECE_PRESSURE,
    Prior,
    STATE,
)
from lta_analysis.discovery.fit import best, Fit
from lta_analysis.discovery.generic_terms import Group, groups, met, Scene
from lta_analysis.discovery.linear import AXES, KNOTS, RANDOM
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.tangent import WIDTH
from lta_sim.effects.protocol import AXES as NAMES
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

Array = NDArray[np.float64]

SIZES: Final = (3.0, 10.0, 40.0)  # floors; of the weights of a group together
SHRUNK: Final = (1.0, 0.6, 0.35, 0.2)  # of the deviations that are looked at
SETTLED: Final = 3  # of the rivals, of which the deviations are found anew
BETTER: Final = 1.1  # of what a candidate wins ...
MARGIN: Final = 10.0  # ... and nats: by which a rival has to be better to displace it
BESIDE: Final = 8.0  # nats; that a candidate has to win beside a rival that is better
WORTH: Final = 12.0  # nats; of a rival at the end


@final
class Gain(NamedTuple):
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
class Rival(NamedTuple):
    """
    A generic explanation.

    Attributes
    ----------
    name : str
        'heave by height'.
    gain : float
        Log evidence that it wins on the first flight. [nats]
    confirmed : float
        On the other, by itself or with what the first has taught, the better one.
    axis : str
        On which it mostly acts.
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
    axis: str
    size: float
    term: str
    share: float

    @property
    def total(self) -> float:
        """Evidence of both flights. [nats]"""
        return self.gain + self.confirmed


@final
@dataclass(frozen=True, slots=True)
class _Beside:
    """Groups beside the nuisances, for one set of deviations: products of each with itself."""

    base: float
    inner: Mapping[str, Array]
    right: Mapping[str, Array]


@final
class Contest:
    """
    The groups of one fitted flight, ready to be weighed.

    Parameters
    ----------
    fitted : Fit
        The flight.
    prior : Prior
        With which it was fitted.
    known : sequence of Group
        All groups.

    """

    def __init__(self, fitted: Fit, prior: Prior, known: Sequence[Group]) -> None:
        self.fitted, self.prior = fitted, prior
        self.known = {group.name: group for group in known}
        linear = fitted.linear
        grams = linear.grams
        self._rows = -0.5 * np.log(2.0 * np.pi) * float(linear.rows.sum())
        free = np.flatnonzero(prior.free)
        self._free = free
        others = np.concatenate([RANDOM + free, [grams.shape[1] - 1]])
        self._random = grams[:, :RANDOM, :RANDOM]
        self._cross = grams[:, :RANDOM, others]
        self._others = grams[:, others[:, None], others]
        latent = slice(WIDTH, WIDTH + AXES * KNOTS)
        self._columns: dict[str, tuple[Array, Array, Array]] = {}
        for name, group in self.known.items():
            weights = np.swapaxes(group.values.reshape(*group.values.shape[:2], -1), 1, 2)
            along = grams[:, :, latent] @ weights
            own = np.swapaxes(weights, 1, 2) @ along[:, latent]
            self._columns[name] = along[:, :RANDOM], along[:, others], own

    def beside(self, deviations: Array, names: Sequence[str]) -> _Beside:
        """Return some groups beside everything else, for some deviations of the latent wrench."""
        point = self.fitted.linear.point
        precision = np.zeros((RANDOM, RANDOM))
        diagonal = np.concatenate([STATE**-2.0, np.zeros(AXES * KNOTS), [PIECE_PRESSURE**-2.0]])
        precision[np.diag_indices(RANDOM)] = diagonal
        knots = knot_precision()
        for axis, deviation in enumerate(deviations):
            at = slice(WIDTH + axis * KNOTS, WIDTH + (axis + 1) * KNOTS)
            precision[at, at] = knots / deviation**2
        pull = -point.random @ precision
        root = np.linalg.cholesky(self._random + precision)
        cross = self._cross.copy()
        cross[:, :, -1] += pull
        half = np.linalg.solve(root, cross)
        products = (self._others - np.swapaxes(half, 1, 2) @ half).sum(axis=0)
        products[-1, -1] += float(np.sum(pull * -point.random))
        logs = 0.5 * np.linalg.slogdet(precision)[1] * len(root)
        logs -= float(np.log(np.diagonal(root, axis1=1, axis2=2)).sum())
        wide = self.prior.covariance[np.ix_(self._free, self._free)]
        inverse = np.linalg.inv(wide)
        offset = (self.prior.mean - point.values)[self._free]
        inner = products[:-1, :-1] + inverse
        right = products[:-1, -1] + inverse @ offset
        lower = np.linalg.cholesky(inner)
        seen = solve_triangular(lower, right, lower=True)
        base = self._rows + logs - 0.5 * float(np.linalg.slogdet(wide)[1])
        base -= float(np.log(np.diag(lower)).sum())
        base -= 0.5 * float(products[-1, -1] + offset @ inverse @ offset - seen @ seen)
        inners, rights = {}, {}
        for name in names:
            along, aside, own = self._columns[name]
            mine = np.linalg.solve(root, along)
            both = (aside - np.swapaxes(half, 1, 2) @ mine).sum(axis=0)
            alone = (own - np.swapaxes(mine, 1, 2) @ mine).sum(axis=0)
            left = solve_triangular(lower, both[:-1], lower=True)
            inners[name] = alone - left.T @ left
            rights[name] = both[-1] - left.T @ seen
        return _Beside(base, inners, rights)

    def _won(self, there: _Beside, name: str, taught: Gain | None) -> float:
        """Return the log evidence with a group."""
        inner, right = there.inner[name], there.right[name]
        if taught is not None:
            return there.base + _gained(inner, right, taught.mean, 1.5 * taught.covariance)
        each = [_gained(inner, right, None, s**2 / len(right)) for s in SIZES]
        return there.base + float(np.logaddexp.reduce(each)) - float(np.log(len(SIZES)))

    def gains(
        self, taught: Mapping[str, Gain] | None = None, most: int = SETTLED
    ) -> dict[str, Gain]:
        """
        Return what each group wins.

        Parameters
        ----------
        taught : mapping, optional
            What another flight says of the weights.
        most : int
            How many of the best get their own deviations.

        """
        names, now = list(self.known if taught is None else taught), self.fitted.deviations
        starts = [share * now for share in SHRUNK] + [np.minimum(now, 1.5 * FLOOR)]
        seen = [(start, self.beside(start, names)) for start in starts]
        at: dict[str, tuple[float, Array, _Beside]] = {}
        for name in names:
            before = None if taught is None else taught[name]
            scores = [self._won(there, name, before) + log_prior(start) for start, there in seen]
            k = int(np.argmax(scores))
            at[name] = scores[k], *seen[k]
        for name in sorted(names, key=lambda one: -at[one][0])[:most]:
            at[name] = self._settled(name, at[name], None if taught is None else taught[name])
        base = self.fitted.evidence
        return {name: self._gain(name, at[name], base, taught) for name in names}

    def _settled(
        self, name: str, at: tuple[float, Array, _Beside], taught: Gain | None
    ) -> tuple[float, Array, _Beside]:
        """Return a group with the most probable deviations."""

        def value(deviations: Array) -> float:
            there = self.beside(deviations, [name])
            return self._won(there, name, taught) + log_prior(deviations)

        deviations, score = best(value, at[1])
        return max((score, deviations, self.beside(deviations, [name])), at, key=lambda o: o[0])

    def _gain(
        self,
        name: str,
        at: tuple[float, Array, _Beside],
        base: float,
        taught: Mapping[str, Gain] | None,
    ) -> Gain:
        """Return what a group wins, and its weights."""
        score, deviations, there = at
        inner, right = there.inner[name], there.right[name]
        if taught is None:
            each = [_gained(inner, right, None, s**2 / len(right)) for s in SIZES]
            size = SIZES[int(np.argmax(each))]
            mean, wide = np.zeros(len(right)), np.eye(len(right)) * size**2 / len(right)
        else:
            mean, wide = taught[name].mean, 1.5 * taught[name].covariance
        inverse = np.linalg.inv(wide)
        covariance = np.linalg.inv(inner + inverse)
        return Gain(
            float(score - base), covariance @ (right + inverse @ mean), covariance, deviations
        )


def _gained(inner: Array, right: Array, mean: Array | None, wide: Array | float) -> float:
    """Return the log evidence of weights with a prior, against none."""
    size = len(right)
    covariance = np.eye(size) * wide if np.isscalar(wide) else np.asarray(wide)
    inverse = np.linalg.inv(covariance)
    start = np.zeros(size) if mean is None else mean
    pull = right + inverse @ start
    together = inner + inverse
    square = pull @ np.linalg.solve(together, pull) - start @ inverse @ start
    logs = np.linalg.slogdet(together)[1] + np.linalg.slogdet(covariance)[1]
    return float(0.5 * square - 0.5 * logs)


@final
class Rivals:
    """
    Rivals of the library on the flights of one study.

    Parameters
    ----------
    flights : sequence of Linearised
        The first teaches, the others confirm.

    """

    def __init__(self, flights: Sequence[Linearised]) -> None:
        self.flights = list(flights)
        places = [flight.replay.flight.position for flight in self.flights]
        self._scene = Scene.around([each[np.isfinite(each).all(axis=1)] for each in places])

    def contests(self, fits: Sequence[Fit], prior: Prior) -> list[Contest]:
        """Return each flight with all groups."""
        out = []
        for flight, fitted in zip(self.flights, fits, strict=True):
            known = list(groups(met(flight, fitted), self._scene, FLOOR))
            out.append(Contest(fitted, prior, known))
        return out

    def found(self, fits: Sequence[Fit], prior: Prior) -> tuple[Rival, ...]:
        """
        Return all rivals, the best first.

        Parameters
        ----------
        fits : sequence of Fit
            Of the flights, with the effects that are in the model now.
        prior : Prior
            With which they were fitted.

        """
        contests = self.contests(fits, prior)
        own = [contest.gains() for contest in contests]
        carried = [contest.gains(own[0]) for contest in contests[1:]]
        out = []
        for name, first in own[0].items():
            others = [
                max(alone[name].gain, with_it[name].gain)
                for alone, with_it in zip(own[1:], carried, strict=True)
            ]
            out.append(_rival(contests[0].known[name], first, sum(others)))
        return tuple(sorted(out, key=lambda rival: -rival.total))


def _rival(group: Group, first: Gain, confirmed: float) -> Rival:
    """Return a rival with its size and its largest term."""
    each = np.sqrt(np.mean((group.values * first.mean[:, None, None]) ** 2, axis=(0, 3)))
    whole = np.einsum('sjak,j->sak', group.values, first.mean)
    sizes = np.sqrt(np.mean(whole**2, axis=(0, 2)))
    axis = int(np.argmax(sizes / FLOOR))
    term = group.terms[int(np.argmax(each[:, axis]))]
    size, rest = float(sizes[axis]), float(first.deviations[axis])
    share = size**2 / (size**2 + rest**2)
    return Rival(group.name, first.gain, confirmed, NAMES[axis], size, term, share)


def displaced(gain: float, before: Mapping[str, float], after: Mapping[str, float]) -> str:
    """
    Return the rival that takes a candidate's place, '' where the candidate stands.

    A rival that is clearly better takes it, unless the candidate has much to say beside it.

    Parameters
    ----------
    gain : float
        Log evidence that the candidate wins on all flights. [nats]
    before, after : mapping of str to float
        What each rival wins on them without the candidate, and beside it.

    """
    for name in sorted(before, key=lambda one: -before[one]):
        if before[name] <= BETTER * gain + MARGIN:
            break
        if gain + after[name] - before[name] < BESIDE:
            return name
    return ''

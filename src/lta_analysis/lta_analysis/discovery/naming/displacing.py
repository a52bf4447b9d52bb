"""
Whether a candidate of the library stands against what is outside of it.

A candidate that was confirmed may still be the nearest word for something that has none. Signs of
that: a generic rival explains clearly more (more at all, where the candidate is a coefficient of
motion, the word for whatever follows the motion), and leaves little for the candidate to say; or,
when all is named, large forces that follow something remain: on every axis on which the
candidate acts, or beside a coefficient of motion that explained something much smaller; or
anything remains, and the candidate has won little, its flights differ about it, or it is a
coefficient of motion that leaves more than it explains.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final

from lta_analysis.discovery.fit.evidence import knot_precision
from lta_analysis.discovery.fit.fit import Joint
from lta_analysis.discovery.model.knobs import PARTS
from lta_analysis.discovery.outside.rivals import Rival, Rivals
from lta_analysis.discovery.outside.standing import Standing
from lta_analysis.discovery.outside.unexplained import CLEAR, remaining
from lta_analysis.discovery.outside.verdict import standing
from lta_analysis.discovery.replay.linear import AXES, KNOTS, Linear, RANDOM
from lta_analysis.discovery.replay.linearise import Linearised
from lta_analysis.discovery.replay.tangent import WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pair = tuple[Joint, Joint]

BETTER: Final = 1.1  # of what a candidate wins ...
MARGIN: Final = 10.0  # ... and nats: by which a rival has to be better to displace it
BESIDE: Final = 11.0  # nats; that a candidate has to win beside such a rival ...
HALF: Final = 0.5  # ... and of what it wins without
SMALL: Final = 1.0  # floors; forces that no rival needs to explain
LOUD: Final = 4.0  # floors; of what remains, to put in question what was named
FOLLOWS: Final = 0.5  # of the variance of what remains; gusts have come to 0.4
FAINT: Final = 24.0  # nats; a name that won less is none beside anything that remains
SURE: Final = 80.0  # nats; with which a coefficient of motion may leave more than it explains
AGREED: Final = 2.5  # deviations; by which the sides may differ about a name beside what remains
MOST: Final = 0.4  # of a deviation; what may remain where a candidate was most of it
LESSER: Final = 0.5  # of the largest that remains; what a coefficient of motion has to explain
FREE: Final = 1e3  # floors; a latent force that can be anything
ALIKE: Final = 0.5  # of a column; what a latent force has to explain of it
NEARLY: Final = 0.85  # of what the axis explains that explains most


def bar(name: str, gain: float) -> float:
    """Return what a rival has to win to displace a candidate that won so much. [nats]"""
    motion = name.partition('.')[0] in PARTS
    return gain if motion else BETTER * gain + MARGIN


def displaced(
    gain: float, least: float, before: Mapping[str, float], after: Mapping[str, float]
) -> str:
    """
    Return the rival that takes a candidate's place, '' where the candidate stands.

    A rival that is clearly better takes it, unless the candidate has much to say beside it.

    Parameters
    ----------
    gain : float
        Log evidence that the candidate wins on all flights. [nats]
    least : float
        What a rival has to win to be clearly better: `bar`.
    before, after : mapping of str to float
        What each rival wins on them without the candidate, and beside it.

    """
    for name in sorted(before, key=lambda one: -before[one]):
        if before[name] <= least:
            break
        if gain + after[name] - before[name] < max(BESIDE, HALF * gain):
            return name
    return ''


def acts_on(linear: Linear, name: str, floor: Array) -> NDArray[np.bool_]:
    """
    Return the axes on which a knob acts: those whose latent force alone could do what it does.

    None for a knob that no force looks like, as those of sensors.
    """
    column, inverse = RANDOM + linear.names.index(name), knot_precision()
    shares = np.zeros(AXES)
    for axis in range(AXES):
        at = slice(WIDTH + axis * KNOTS, WIDTH + (axis + 1) * KNOTS)
        inner = linear.grams[:, at, at] + inverse / (FREE * floor[axis]) ** 2
        cross = linear.grams[:, at, column, None]
        shares[axis] = np.sum(cross * np.linalg.solve(inner, cross))
    shares /= max(float(linear.grams[:, column, column].sum()), 1e-300)
    acts: NDArray[np.bool_] = (shares > ALIKE) & (shares > NEARLY * shares.max())
    return acts


def partial(acts: NDArray[np.bool_], before: Array, final: Array) -> bool:
    """
    Tell whether a candidate has at most explained a part of something larger.

    Parameters
    ----------
    acts : ndarray of bool, shape (6,)
        The axes on which it acts.
    before, final : ndarray, shape (6,)
        Deviations of the latent wrench without the candidate, and at the end. [floors]

    """
    return bool(acts.any() and np.all((final > np.maximum(LOUD, MOST * before))[acts]))


def lesser(name: str, acts: NDArray[np.bool_], before: Array, final: Array) -> bool:
    """
    Tell whether a name is a coefficient of motion for little beside what has no name.

    What has none pushes on several axes at once, and drag or added mass are the words for whatever
    follows the motion: a little of it on an axis is no proof of either. Parameters are as for
    `partial`, and the candidate's name.
    """
    motion = name.partition('.')[0] in PARTS
    explained = np.sqrt(np.maximum(before**2 - final**2, 0.0))
    return motion and bool(acts.any() and explained[acts].max() < LESSER * final.max())


def minor(name: str, acts: NDArray[np.bool_], before: Array, final: Array) -> bool:
    """
    Tell whether a coefficient of motion leaves more than it explained, where it explained most.

    Parameters are as for `lesser`.
    """
    if name.partition('.')[0] not in PARTS or not acts.any():
        return False
    explained = np.sqrt(np.maximum(before**2 - final**2, 0.0))
    k = int(np.argmax(np.where(acts, explained, -1.0)))
    return bool(final[k] > max(CLEAR, explained[k]))


def apart(then: Pair, k: int) -> float:
    """Return by how much the values of a knob differ between the sides, in deviations."""
    values = [each.fitted.mean[k] for each in then]
    spread = sum(each.fitted.covariance[k, k] for each in then)
    return float(abs(values[0] - values[1]) / np.sqrt(spread)) if spread > 0.0 else 0.0


def won(before: Pair, then: Pair) -> float:
    """Return the log evidence that fits have won on others, each side by itself. [nats]"""
    return sum(new.evidence - old.evidence for old, new in zip(before, then, strict=True))


@final
class Displacing:
    """
    The rivals of all candidates of a study.

    Parameters
    ----------
    flights : pair of sequences of Linearised
        Those that teach, and those that confirm.
    floor : ndarray, shape (6,)
        Deviations of the latent wrench that are not worth speaking of.

    """

    def __init__(self, flights: Sequence[Sequence[Linearised]], floor: Array) -> None:
        self._flights, self._rivals, self._floor = flights, Rivals(flights), floor
        self._last: tuple[Pair, dict[str, float]] | None = None

    def stands(self, name: str, gain: float, fits: Pair, then: Pair) -> bool:
        """
        Tell whether a candidate stands.

        Parameters
        ----------
        name : str
            Of the candidate.
        gain : float
            Log evidence that it wins on all flights. [nats]
        fits, then : pair of Joint
            Of the flights, without it and with it.

        """
        if self._floors(fits).max() < SMALL:
            return True  # there is no force for a rival to follow
        if self._last is None or self._last[0] is not fits:
            self._last = fits, self._gains(fits)
        before = self._last[1]
        least = bar(name, gain)
        if max(before.values()) <= least:
            return True
        return not displaced(gain, least, before, self._gains(then))

    def withdrawn(self, history: Sequence[tuple[str, Pair]], last: Pair) -> tuple[str, ...]:
        """
        Return the names that were only the nearest word for a part of something else.

        Parameters
        ----------
        history : sequence of (name, pair of Joint)
            Of each effect that was named: the fits without it.
        last : pair of Joint
            With all of them.

        """
        final = self._floors(last)
        if not history or final.max() <= CLEAR:
            return ()
        linear = last[0].group.linears[0]
        structured = final.max() > LOUD and self._structured(last)
        fits, gone = [*(before for _, before in history), last], []
        for (name, before), then in zip(history, fits[1:], strict=True):
            acts, floors = acts_on(linear, name, self._floor), self._floors(before)
            part = structured and partial(acts, floors, final)
            less = structured and lesser(name, acts, floors, final)
            rest = minor(name, acts, floors, final) and won(before, then) < SURE
            weak = won(before, then) < FAINT or apart(then, linear.names.index(name)) > AGREED
            if weak or part or less or rest:
                gone.append(name)
        return tuple(gone)

    def _structured(self, fits: Pair) -> bool:
        """Tell whether what remains follows something, as gusts do not."""
        left = remaining(self._flights, [each.members for each in fits], self._floor)
        clearly = any(one.carried > FOLLOWS for one in left)
        return clearly or bool(standing(self._found(fits)))

    def _found(self, fits: Pair) -> tuple[Rival, ...]:
        """Return the rivals on some fits."""
        return self._rivals.found([Standing.of(each, self._floor) for each in fits])

    def _gains(self, fits: Pair) -> dict[str, float]:
        """Return what each rival wins on all flights."""
        return {one.name: one.total for one in self._found(fits)}

    def _floors(self, fits: Pair) -> Array:
        """Return the deviations, by the floor: geometric mean of the sides."""
        logs = np.mean([np.log(each.deviations / self._floor) for each in fits], axis=0)
        together: Array = np.exp(logs)
        return together

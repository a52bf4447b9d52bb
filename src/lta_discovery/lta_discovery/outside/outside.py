"""
What is outside the library, when everything with a name is in the model.

Axes of the latent wrench that stand clear of the floor, generic rivals that still win,
oscillations of the wrench, and lines in what is left over. A draught is told apart from that.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.finding import Verdict
from lta_discovery.fit.fit import Joint
from lta_discovery.outside.draught import Draught, draught, LEVEL, one_sided
from lta_discovery.outside.latent_series import LatentSeries
from lta_discovery.outside.oscillation import Oscillation, oscillations, taken
from lta_discovery.outside.rivals import Rival, Rivals
from lta_discovery.outside.spectral_line import Line, lines, lowest, telling
from lta_discovery.outside.standing import Standing
from lta_discovery.outside.unexplained import Remainder, remaining
from lta_discovery.outside.verdict import remains_with, sentences, swinging, verdict_of
from lta_discovery.outside.verdict import telling as telling_rivals
from lta_discovery.replay.linearise import Linearised
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FOLLOWED: Final = 300.0  # floors; a model that has to be helped by more does not follow the flight


@final
class Outside(NamedTuple):
    """
    What is outside the library.

    Attributes
    ----------
    remains : tuple of Remainder
        By axis, with what it follows, the largest first.
    rivals : tuple of Rival
        All of them, the best first.
    lines : tuple of Line
        The strongest first.
    oscillations : tuple of Oscillation
        The strongest first.
    draught : Draught, optional
        Air that moves a little by itself; neither the axes on which it pushes nor rivals that
        explain one of them are among the rest then.

    """

    remains: tuple[Remainder, ...]
    rivals: tuple[Rival, ...]
    lines: tuple[Line, ...]
    oscillations: tuple[Oscillation, ...] = ()
    draught: Draught | None = None

    @property
    def sentences(self) -> tuple[str, ...]:
        """All of it, for people."""
        return sentences(self.remains, self.lines, self.oscillations)

    @property
    def more(self) -> bool:
        """Whether there is anything, whatever was named."""
        return self.verdict(()) == 'unexplained'

    @property
    def held(self) -> bool:
        """Whether it is what remains of flights that the model follows at all."""
        return self.more and all(one.floors < FOLLOWED for one in self.remains)

    def verdict(self, named: Sequence[str]) -> Verdict:
        """Return the verdict; see `verdict_of`."""
        return verdict_of(named, self.remains, self.rivals, [*self.oscillations, *self.lines])


def outside(pair: Sequence[Sequence[Linearised]], full: Joint, floor: Array) -> Outside:
    """
    Return what is outside the library.

    Parameters
    ----------
    pair : pair of sequences of Linearised
        Flights that teach, and that confirm.
    full : Joint
        All of them in this order, with all named effects in the model.
    floor : ndarray, shape (6,)
        Deviations of the latent wrench that are not worth speaking of.

    """
    count = len(pair[0])
    sides = slice(0, count), slice(count, None)
    rivals = Rivals(pair).found([Standing.part(full, side, floor) for side in sides])
    members = full.members
    left = remaining(pair, [members[side] for side in sides], floor)
    flights = [*pair[0], *pair[1]]
    residuals = [linear.residual for linear in full.group.linears]
    times = [each.time for each in flights]
    noise = [each.replay.flight.noise for each in flights]
    knots = full.group.linears[0].knots
    seen = lines(residuals, times, noise, lowest(knots))
    nominal = full.group.linears[0].point.nominal
    inverse = nominal.model().inverse
    told = telling(seen, np.reshape(inverse, (6, 6)), floor)
    series = [LatentSeries.of(*each) for each in zip(flights, members, strict=True)]
    slow = oscillations(series, floor, knots)
    air = None
    if not (slow or told):
        winning = telling_rivals(rivals)
        air = draught(full.deviations, floor, left, winning, series, nominal)
    if air is not None:
        left = [one for one in left if one.axis not in LEVEL]
        rivals = tuple(one for one in rivals if not one_sided(one))
    remains = swinging(remains_with(left, rivals, floor), taken(slow))
    return Outside(tuple(remains), rivals, told, slow, air)

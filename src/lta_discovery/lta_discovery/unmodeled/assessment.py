"""
What is outside the library, when everything with a name is in the model.

Axes of the latent wrench that stand clear of the floor, generic rivals that still win,
oscillations of the wrench, and lines in what is left over. A draught is told apart from that.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.finding import Verdict
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.replay.linearizer import FlightLinearizer
from lta_discovery.unmodeled.draught import detect_draught, DraughtFinding, is_one_sided, LEVEL
from lta_discovery.unmodeled.fit_baseline import FitBaseline
from lta_discovery.unmodeled.latent_series import LatentSeries
from lta_discovery.unmodeled.oscillation import (
    dominant_oscillations,
    find_oscillations,
    LatentOscillation,
)
from lta_discovery.unmodeled.remainders import find_remainders, Remainder
from lta_discovery.unmodeled.rivals import GenericRival, RivalSearch
from lta_discovery.unmodeled.spectral_line import (
    find_lines,
    lowest_frequency,
    select_strong_lines,
    SpectralLine,
)
from lta_discovery.unmodeled.verdict import (
    add_oscillations,
    add_rival_terms,
    decide_verdict,
    list_sentences,
    select_evident_rivals,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FOLLOWED: Final = 300.0  # floors; a model that has to be helped by more does not follow the flight


@final
class UnmodeledForces(NamedTuple):
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
    rivals: tuple[GenericRival, ...]
    lines: tuple[SpectralLine, ...]
    oscillations: tuple[LatentOscillation, ...] = ()
    draught: DraughtFinding | None = None

    @property
    def sentences(self) -> tuple[str, ...]:
        """All of it, for people."""
        return list_sentences(self.remains, self.lines, self.oscillations)

    @property
    def has_any(self) -> bool:
        """Whether there is anything, whatever was named."""
        return self.decide_verdict(()) == 'unexplained'

    @property
    def is_trackable(self) -> bool:
        """Whether it is what remains of flights that the model follows at all."""
        return self.has_any and all(one.floors < FOLLOWED for one in self.remains)

    def decide_verdict(self, named: Sequence[str]) -> Verdict:
        """Return the verdict; see `decide_verdict`."""
        return decide_verdict(named, self.remains, self.rivals, [*self.oscillations, *self.lines])


def assess_unmodeled(
    pair: Sequence[Sequence[FlightLinearizer]], full: JointFit, floor: Array
) -> UnmodeledForces:
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
    rivals = RivalSearch(pair).rank_rivals(
        [FitBaseline.from_part(full, side, floor) for side in sides]
    )
    members = full.members
    left = find_remainders(pair, [members[side] for side in sides], floor)
    flights = [*pair[0], *pair[1]]
    residuals = [linear.residual for linear in full.group.linears]
    times = [each.time for each in flights]
    noise = [each.replay.flight.noise for each in flights]
    knots = full.group.linears[0].knots
    seen = find_lines(residuals, times, noise, lowest_frequency(knots))
    nominal = full.group.linears[0].point.nominal
    inverse = nominal.build_model().inverse
    told = select_strong_lines(seen, np.reshape(inverse, (6, 6)), floor)
    series = [LatentSeries.from_fit(*each) for each in zip(flights, members, strict=True)]
    slow = find_oscillations(series, floor, knots)
    air = None
    if not (slow or told):
        winning = select_evident_rivals(rivals)
        air = detect_draught(full.deviations, floor, left, winning, series, nominal)
    if air is not None:
        left = [one for one in left if one.axis not in LEVEL]
        rivals = tuple(one for one in rivals if not is_one_sided(one))
    remains = add_oscillations(add_rival_terms(left, rivals, floor), dominant_oscillations(slow))
    return UnmodeledForces(tuple(remains), rivals, told, slow, air)

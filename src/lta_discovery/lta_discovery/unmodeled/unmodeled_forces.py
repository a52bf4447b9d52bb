"""
Assess unmodeled forces with all named effects in the model.

Axes of the latent wrench above the noise floor, confirmed generic rivals, oscillations of the
wrench, and spectral lines of the residuals. A draught is separated from these.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple, Self

from lta_discovery.finding import Verdict
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.unmodeled.draught import detect_draught, DraughtEstimate, is_one_sided, LEVEL
from lta_discovery.unmodeled.fit_baseline import FitBaseline
from lta_discovery.unmodeled.latent_series import LatentSeries
from lta_discovery.unmodeled.oscillation import (
    dominant_oscillations,
    find_common_oscillations,
    LatentOscillation,
)
from lta_discovery.unmodeled.rivals import GenericRival, RivalSearch
from lta_discovery.unmodeled.spectral_line import (
    find_spectral_lines,
    lowest_frequency,
    select_strong_lines,
    SpectralLine,
)
from lta_discovery.unmodeled.unexplained_force import find_unexplained_forces, Remainder
from lta_discovery.unmodeled.verdict import (
    add_oscillations,
    add_rival_terms,
    decide_verdict,
    describe_unexplained_forces,
    select_evident_rivals,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FOLLOWED: Final = 300.0  # noise floors; above it the model does not follow the flight


@final
class UnmodeledForces(NamedTuple):
    """Forces outside the library."""

    remains: tuple[Remainder, ...]  # by axis, the largest first
    rivals: tuple[GenericRival, ...]  # all of them, the best first
    lines: tuple[SpectralLine, ...]  # the strongest first
    oscillations: tuple[LatentOscillation, ...] = ()  # the strongest first
    # Slow air motion. Its axes, and rivals that explain only one of them, are then not in the
    # rest.
    draught: DraughtEstimate | None = None

    @property
    def sentences(self) -> tuple[str, ...]:
        """All of them in words."""
        return describe_unexplained_forces(self.remains, self.lines, self.oscillations)

    @property
    def has_unmodeled_forces(self) -> bool:
        """Whether there are any."""
        return self.decide_verdict(()) == 'unexplained'

    @property
    def is_trackable(self) -> bool:
        """Whether there are any, in flights that the model can follow."""
        return self.has_unmodeled_forces and all(one.floors < FOLLOWED for one in self.remains)

    def without_causes(self) -> Self:
        """
        Return the forces without what they vary with.

        Where a fit predicts worse than what it began from, its latent wrench makes up for its
        wrong values, and varies with whatever these get wrong.
        """
        return self._replace(
            remains=tuple(
                one._replace(follows=(), carried=0.0, is_traced=False) for one in self.remains
            )
        )

    def decide_verdict(self, named: Sequence[str]) -> Verdict:
        """Return the verdict; see `decide_verdict`."""
        return decide_verdict(named, self.remains, self.rivals, [*self.oscillations, *self.lines])


def assess_unmodeled_forces(
    pair: Sequence[Sequence[FlightLinearizer]], full: JointFit, floor: Array
) -> UnmodeledForces:
    """
    Return the forces outside the library.

    `full`: all of them in this order, with all named effects.
    """
    count = len(pair[0])
    sides = slice(0, count), slice(count, None)
    rivals = RivalSearch(pair).rank_rivals(
        [FitBaseline.from_part(full, side, floor) for side in sides]
    )
    members = full.members
    left = find_unexplained_forces(pair, [members[side] for side in sides], floor)
    flights = [*pair[0], *pair[1]]
    residuals = [linear.residual for linear in full.group.linears]
    times = [each.time for each in flights]
    noise = [each.replay.flight.noise for each in flights]
    knots = full.group.linears[0].knots
    # Slower oscillations are followed by the latent wrench and sought there
    seen = find_spectral_lines(residuals, times, noise, lowest_frequency(knots))
    nominal = full.group.linears[0].point.nominal
    inverse = nominal.build_model().inverse
    lines = select_strong_lines(seen, np.reshape(inverse, (6, 6)), floor)
    series = [LatentSeries.from_fit(*each) for each in zip(flights, members, strict=True)]
    slow = find_common_oscillations(series, floor, knots)
    air = None
    # An oscillation is structure, so the remainder is not just a draught.
    if not (slow or lines):
        winning = select_evident_rivals(rivals)
        air = detect_draught(full.deviations, floor, left, winning, series, nominal)
    if air is not None:
        left = [one for one in left if one.axis not in LEVEL]
        # Rivals of one horizontal axis only describe the draught
        rivals = tuple(one for one in rivals if not is_one_sided(one))
    remains = add_oscillations(add_rival_terms(left, rivals, floor), dominant_oscillations(slow))
    return UnmodeledForces(tuple(remains), rivals, lines, slow, air)

"""
The paper's study of the number of photodiodes, with both estimators.

The lamp stands 3 m away, 45 degrees off its axis; the ring turns through 16 directions, and each
is read 50 times; the paper gives medians. One vehicle each: its gains are drawn once, by the seed.

What the paper says of it, and where that cannot hold: with ideal cosine diodes the weighted mean
is exact for any even ring of four or more, whatever the pedestal (`lta_vlc.bearing`); equal diodes
of any response make a ring of eight exact at all 16 directions, which are its own axes and the
middles between them. So errors in some directions and not in others can only come from a response
that is no cosine, from unequal gains, and from reflections. Steady sunlight adds nothing at the
lamp's frequency but noise: "all worse from sunlight" is noise or saturation, and "4 better than
indoors" is that reflections are missing.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
import math
from typing import Any, Final, final

from lta_studies.light.bearing.bench import BearingBench
from lta_studies.light.bearing.places import build_flight_spec, PLACES
from lta_studies.light.bearing.poses import Pose
from lta_studies.light.bearing.score import error_quantile, extract_column
import numpy as np

DIRECTIONS: Final = 16
DISTANCE: Final = 3.0  # m
# Off the lamp's axis, as the paper does not say where in its room: on the axis of a room that is
# alike to both sides nothing pulls a bearing aside.
ASIDE: Final = math.radians(45.0)
HEIGHT: Final = 0.5  # of the hull centre, that of the paper's flights [m]
READINGS: Final = 50
COUNTS: Final = (4, 8, 16)


@final
@dataclass(frozen=True, slots=True)
class RingClaim:
    """What the paper says of one ring, as far as it can be counted: directions within a limit."""

    place: str
    count: int
    sentence: str
    limit: float  # [rad]
    at_least: int


CLAIMS: Final = (
    RingClaim('indoor', 16, '16 diodes below 2 degrees', math.radians(2.0), 16),
    RingClaim('indoor', 8, '8 diodes below 4 degrees', math.radians(4.0), 12),
    RingClaim('indoor', 8, '8 diodes below 8 degrees', math.radians(8.0), 16),
)


@final
@dataclass(frozen=True, slots=True)
class RingStudy:
    """
    One ring in one place.

    Parameters
    ----------
    place : str
        Of `PLACES`.
    count : int
        Diodes.
    paper, ours : tuple of float
        Median error in each direction. [rad]
    snr : float
        Median of the best diode's.

    """

    place: str
    count: int
    paper: tuple[float, ...]
    ours: tuple[float, ...]
    snr: float

    def to_json(self) -> dict[str, Any]:
        """Return it for JSON; angles in radians."""
        return {
            'place': self.place, 'diodes': self.count, 'snr': self.snr,
            'paper': list(self.paper), 'fit': list(self.ours),
        }  # fmt: skip


def list_directions() -> list[float]:
    """Return the true directions of the lamp from the ring. [rad]"""
    return [math.tau * k / DIRECTIONS for k in range(DIRECTIONS)]


def study_rings(
    vehicle: str, readings: int, seed: int, tick: Callable[[], None]
) -> list[RingStudy]:
    """Return the study in all places, ring by ring; `tick` is called after each direction."""
    return [
        study_ring(
            BearingBench(build_flight_spec(PLACES[place], vehicle, count)),
            place,
            count,
            readings,
            seed,
            tick,
        )
        for place in PLACES
        for count in COUNTS
    ]


def study_ring(
    bench: BearingBench, place: str, count: int, readings: int, seed: int, tick: Callable[[], None]
) -> RingStudy:
    """Return what one ring makes of all directions."""
    chance = np.random.default_rng([seed, count])
    diodes = bench.draw_diodes(chance)
    paper, ours, snrs = [], [], []
    for direction in list_directions():
        pose = pose_before_lamp(bench, direction)
        told = [bench.read_block(pose, diodes, chance) for _ in range(readings)]
        paper.append(error_quantile(extract_column(told, 'paper'), 50.0))
        ours.append(error_quantile(extract_column(told, 'ours'), 50.0))
        snrs.append(float(np.median(extract_column(told, 'snr'))))
        tick()
    return RingStudy(place, count, tuple(paper), tuple(ours), float(np.median(snrs)))


def pose_before_lamp(bench: BearingBench, direction: float) -> Pose:
    """Return the level pose beside the lamp's axis with the lamp in a direction. [rad]"""
    x, y, _ = bench.scenario.goal_lamp.position.vector
    ahead_x, ahead_y, _ = bench.scenario.goal_lamp.facing.vector
    facing = math.atan2(ahead_y, ahead_x) + ASIDE
    half = 0.5 * (facing + math.pi - direction)
    # The ring sits under the hull's middle, so that level it stands where the hull does.
    return (
        x + DISTANCE * math.cos(facing), y + DISTANCE * math.sin(facing), HEIGHT,
        0.0, 0.0, math.sin(half), math.cos(half),
    )  # fmt: skip


def count_within(errors: Sequence[float], limit: float) -> int:
    """Return in how many directions the median stays below a limit."""
    return sum(error < limit for error in errors)


def judge_claims(studies: Sequence[RingStudy]) -> list[tuple[str, str, str]]:
    """Return each claim of the paper, and what became of it by its own estimator and by ours."""
    rings = {(each.place, each.count): each for each in studies}
    return [judge_claim(claim, rings[claim.place, claim.count]) for claim in CLAIMS]


def judge_claim(claim: RingClaim, ring: RingStudy) -> tuple[str, str, str]:
    """Return a claim of the paper, and in how many directions both estimators keep it."""
    paper, ours = (
        f'{count_within(errors, claim.limit)} of {DIRECTIONS}'
        for errors in (ring.paper, ring.ours)
    )
    return f'{claim.sentence}: {claim.at_least} of {DIRECTIONS}', paper, ours

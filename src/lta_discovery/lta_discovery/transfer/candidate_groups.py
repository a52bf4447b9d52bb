"""
Group the parameters of a vehicle into candidates: the directions of an effect are one candidate.

A forecast rarely distinguishes roll from pitch of an added inertia, and an effect that is present
acts in all its directions. Hull coefficients are grouped by force or moment.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Parameters that forecasts of a pose do not identify, or that differ from flight to flight.
# The moving mass is assumed to be where it is commanded.
NO_NAME: Final = frozenset(
    {'hull_lift.all', 'tracker_misalignment.yaw', 'moving_mass.x', 'moving_mass.z'}
)
# Coefficients of a hull that is not mirror-symmetric. Flights that slip to one side only cannot
# distinguish them from the slopes with the side-slip, and would be wrong in straight flight.
LOPSIDED: Final = frozenset(
    f'hull_lift.{name}'
    for name in ('side', 'side_alpha2', 'roll', 'roll_alpha', 'yaw', 'yaw_alpha')
)
# Effects of the air on a hull. They compensate each other, so that one of them alone can be wrong
# in another regime where all together are right: they are also one candidate.
AIR: Final = ('hull_lift', 'added_mass', 'added_inertia')
HULL: Final = 'hull aerodynamics'  # the name of that candidate
# Effects that act like lift, which every flight fits for itself.
SAME: Final = frozenset(
    {'gas_purity', 'ballast', 'payload', 'net_lift', 'helium_leak', 'superheat', 'rotor_fault'}
)
WIDE: Final = 3.0  # typical sizes; prior standard deviation
# Prior deviations of effects whose typical size is that of a still hall.
LOOSE: Final[dict[str, float]] = {
    'steady_wind': 0.2, 'wind_gradient': 0.2, 'tracker_misalignment': 0.03,
}  # fmt: skip
# For hulls heavier than a typical one.
HEAVY: Final[dict[str, float]] = {'added_inertia': 0.005}


@final
class CandidateGroup(NamedTuple):
    """One candidate."""

    name: str  # readable and unique
    knobs: tuple[int, ...]  # indices among all parameters


def list_candidate_groups(
    knobs: Sequence[FreeParameter], mirrored: bool = True
) -> list[CandidateGroup]:
    """
    Return the candidates that forecasts of a pose could identify, in registry order.

    `mirrored`: whether the hull is taken as mirror-symmetric.
    """
    out: dict[str, CandidateGroup] = {}
    for k, knob in enumerate(knobs):
        effect = knob.name.partition('.')[0]
        # Forecasts of a pose do not depend on the other sensors
        sensor = knob.reaches == 'reading' and effect != 'tracker_misalignment'
        if knob.typical <= 0.0 or knob.per_flight or sensor:
            continue
        if effect in SAME or knob.name in NO_NAME or (mirrored and knob.name in LOPSIDED):
            continue
        name = effect.replace('_', ' ')
        before = out.get(name, CandidateGroup(name, ()))
        out[name] = before._replace(knobs=(*before.knobs, k))
    groups = list(out.values())
    parts = [one for one in groups if one.name.replace(' ', '_') in AIR]
    # A hull whose coefficients are in other effects has none of them together
    if any(one.name == 'hull lift' for one in parts):
        groups.append(CandidateGroup(HULL, tuple(list_knobs(parts))))
    return groups


def list_knobs(groups: Sequence[CandidateGroup]) -> list[int]:
    """Return the parameters of some candidates, each once."""
    return list(dict.fromkeys(k for group in groups for k in group.knobs))


def tolerance_indices(knobs: Sequence[FreeParameter]) -> list[int]:
    """Return the indices of the toleranced parameters that all flights share."""
    return [
        k
        for k, knob in enumerate(knobs)
        if knob.tolerance > 0.0 and not knob.per_flight and knob.reaches != 'reading'
    ]


def prior_deviations(knobs: Sequence[FreeParameter], which: Sequence[int]) -> Array:
    """Return prior standard deviations, shape (K,)."""
    return np.array([_prior_deviation(knobs[k]) for k in which])


def _prior_deviation(knob: FreeParameter) -> float:
    """Return the prior standard deviation of a parameter."""
    effect = knob.name.partition('.')[0]
    # Wide enough for real vehicles, whose effects may be far from typical
    return {**LOOSE, **HEAVY}.get(effect) or max(WIDE * knob.typical, 2.0 * knob.tolerance)

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

# Groups within effects of many parameters: name, and the parameters.
PARTS: Final[dict[str, dict[str, tuple[str, ...]]]] = {
    'hull_lift': {
        'drag of the hull': ('drag', 'drag_alpha2', 'drag_beta2'),
        'side force': ('side', 'side_alpha2', 'side_beta'),
        'lift of the hull': ('lift', 'lift_alpha', 'lift_beta2'),
        'rolling moment': ('roll', 'roll_alpha', 'roll_beta'),
        'pitching moment': ('pitch', 'pitch_alpha', 'pitch_beta4'),
        'yawing moment': ('yaw', 'yaw_alpha', 'yaw_beta'),
        'damping of turns': ('roll_rate', 'pitch_rate', 'yaw_rate'),
        'aerodynamic centre': ('x', 'z'),
    },
}
# Parameters that forecasts of a pose do not identify, or that differ from flight to flight.
# The moving mass is assumed to be where it is commanded.
NO_NAME: Final = frozenset(
    {'hull_lift.all', 'tracker_misalignment.yaw', 'moving_mass.x', 'moving_mass.z'}
)
# Effects that act like lift, which every flight fits for itself.
SAME: Final = frozenset(
    {'gas_purity', 'ballast', 'payload', 'net_lift', 'helium_leak', 'superheat', 'rotor_fault'}
)
WIDE: Final = 3.0  # typical sizes; prior standard deviation
# Prior deviations of effects whose typical size is that of a still hall.
LOOSE: Final[dict[str, float]] = {
    'steady_wind': 0.2, 'wind_gradient': 0.2, 'tracker_misalignment': 0.03,
}  # fmt: skip
# Smaller prior deviations where linearization fails: for hulls heavier than a typical one.
HEAVY: Final[dict[str, float]] = {'added_inertia': 0.005}


@final
class CandidateGroup(NamedTuple):
    """
    One candidate.

    Attributes
    ----------
    name : str
        Readable and unique.
    effect : str
        Of the registry.
    knobs : tuple of int
        Indices among all parameters.

    """

    name: str
    effect: str
    knobs: tuple[int, ...]


def list_candidate_groups(knobs: Sequence[FreeParameter]) -> list[CandidateGroup]:
    """Return the candidates that forecasts of a pose could identify, in registry order."""
    out: dict[str, CandidateGroup] = {}
    for k, knob in enumerate(knobs):
        effect, _, parameter = knob.name.partition('.')
        # Forecasts of a pose do not depend on the other sensors
        sensor = knob.reaches == 'reading' and effect != 'tracker_misalignment'
        if knob.typical <= 0.0 or knob.per_flight or sensor:
            continue
        if effect in SAME or knob.name in NO_NAME:
            continue
        parts = PARTS.get(effect, {})
        part = next((words for words, names in parts.items() if parameter in names), '')
        if parts and not part:
            continue
        name = part or effect.replace('_', ' ')
        before = out.get(name, CandidateGroup(name, effect, ()))
        out[name] = before._replace(knobs=(*before.knobs, k))
    return list(out.values())


def tolerance_indices(knobs: Sequence[FreeParameter]) -> list[int]:
    """Return the indices of the toleranced parameters that all flights share."""
    return [
        k
        for k, knob in enumerate(knobs)
        if knob.tolerance > 0.0 and not knob.per_flight and knob.reaches != 'reading'
    ]


def prior_deviations(knobs: Sequence[FreeParameter], which: Sequence[int]) -> Array:
    """Return prior standard deviations for a single step, shape (K,)."""
    return np.array([_prior_deviation(knobs[k]) for k in which])


def iterated_prior_deviations(knobs: Sequence[FreeParameter], which: Sequence[int]) -> Array:
    """Return prior standard deviations for an iterated fit, shape (K,)."""
    effects = [knobs[k].name.partition('.')[0] for k in which]
    own = prior_deviations(knobs, which)
    return np.array([HEAVY.get(effect, one) for effect, one in zip(effects, own, strict=True)])


def _prior_deviation(knob: FreeParameter) -> float:
    """Return the prior standard deviation of a parameter."""
    loose = LOOSE.get(knob.name.partition('.')[0])
    # Wide enough for real vehicles, whose effects may be far from typical
    return loose or max(WIDE * knob.typical, 2.0 * knob.tolerance)

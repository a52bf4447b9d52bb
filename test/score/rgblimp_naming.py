"""What is fitted to RGBlimp's forecasts beside what has a name, and how far it may be off."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_discovery.model.parameters import FreeParameter
from lta_discovery.transfer.candidate_groups import CandidateGroup, list_knobs
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# What is fitted to forecasts alone, without a claim to a name.
EVERY: Final = (
    'steady wind', 'wind gradient', 'moving mass', 'cg height', 'cg offset', 'added mass',
    'added inertia', 'linear drag', 'rotational drag', 'rotor misalignment',
    'tracker misalignment', 'hull lift',
)  # fmt: skip
NO_NAME: Final = (
    'rotor_1.thrust', 'rotor_2.thrust', 'vehicle.roll', 'vehicle.pitch', 'vehicle.yaw',
    'moving_mass.x', 'moving_mass.z',
)  # fmt: skip
# How far those may be off that have no typical size, or one of another hall than a still one.
LOOSE: Final[Mapping[str, float]] = {
    'rotor_1.thrust': 0.3, 'rotor_2.thrust': 0.3,
    'vehicle.roll': 0.3, 'vehicle.pitch': 0.3, 'vehicle.yaw': 0.3,
    'steady_wind': 0.2, 'wind_gradient': 0.2, 'tracker_misalignment': 0.03,
}  # fmt: skip
LOOSELY: Final = 30.0  # typical sizes; of everything that is fitted to forecasts alone


def places(knobs: Sequence[FreeParameter], names: Sequence[str]) -> list[int]:
    """Return where knobs are."""
    order = [knob.name for knob in knobs]
    return [order.index(name) for name in names]


def every(knobs: Sequence[FreeParameter], groups: Sequence[CandidateGroup]) -> list[int]:
    """Return where everything is that is fitted to forecasts alone."""
    return [*list_knobs([g for g in groups if g.name in EVERY]), *places(knobs, NO_NAME)]


def within(knobs: Sequence[FreeParameter], which: Sequence[int], wide: float) -> Array:
    """Return how far knobs may be off, in typical sizes where `LOOSE` does not say."""
    return np.array([_within(knobs[k], wide) for k in which])


def _within(knob: FreeParameter, wide: float) -> float:
    """Return how far a knob may be off."""
    usual = max(wide * knob.typical, 2.0 * knob.tolerance)
    return LOOSE.get(knob.name, LOOSE.get(knob.name.partition('.')[0], usual))

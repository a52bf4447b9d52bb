"""Draw the hidden effects: names, parameters and sizes."""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_challenge.outside import OUTSIDE, STRANGE, STRUCTURED
from lta_challenge.rows import ChallengeRow
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.equivalence_classes import find_kind_classes, is_equivalent
import numpy as np

Draw = np.random.Generator

STRENGTH: Final = (2.0, 120.0)  # sigma; range of the intended strength of an effect
SIZE: Final = (0.05, 8.0)  # typical sizes; limits that have priority over the strength
# Limits beyond which a vehicle cannot fly, or is no longer the same kind of vehicle
CAPS: Final[dict[str, tuple[float, float]]] = {
    'steady_wind': (-0.35, 0.35),
    'wind_gradient': (-0.05, 0.05),
    'gas_purity': (-0.03, 0.0015),
    'ballast': (-0.0006, 0.01),
    'payload': (0.0, 0.01),
    'cg_height': (-0.04, 0.03),
    'cg_offset': (-0.02, 0.02),
    'net_lift': (-0.1, 0.004),
    'helium_leak': (0.0, 4e-4),
    'added_mass': (-0.1, 0.25),
    'added_inertia': (-0.003, 0.006),
    'quadratic_drag': (-0.06, 0.25),
    'rotational_drag': (-0.0004, 0.006),
    'munk_moment': (-0.5, 1.0),
    'motor_lag': (-0.05, 0.25),
    'thrust_scale': (-0.35, 0.3),
    'rotor_fault': (0.0, 0.4),
    'imu_bias': (-0.8, 0.8),
    'tracker_misalignment': (-0.4, 0.4),
    'motor_deadband': (0.0, 0.2),
}
CLEAR: Final = (4.0, 40.0)  # noise floors; intended strength of an effect outside the library
FAINT: Final = 2.0  # noise floors; weaker effects are drawn again


@final
class InjectedEffect(NamedTuple):
    """A hidden effect: a parameter of the library and its value."""

    knob: str
    value: float


def effect_of(knob: str) -> str:
    """Return the effect of a parameter 'EFFECT.NAME'."""
    return knob.partition('.')[0]


def list_injectable_parameters(
    knobs: Sequence[FreeParameter], row: ChallengeRow
) -> list[FreeParameter]:
    """Return the parameters that can be hidden: those that the data of a row can show."""
    classes = find_kind_classes(row.data)
    return [
        knob
        for knob in knobs
        if knob.typical > 0.0 and knob.name in classes.reach and knob.name not in classes.unseen
    ]


def _draw_size(knob: FreeParameter, row: ChallengeRow, draw: Draw) -> float:
    """Draw the size of a parameter, from a random strength and its known detectability."""
    # Strength that a change of the typical size had in an earlier study of such data
    reach = find_kind_classes(row.data).reach[knob.name][0]
    # Log-uniform: as many weak effects as strong ones
    strength = STRENGTH[0] * (STRENGTH[1] / STRENGTH[0]) ** draw.random()
    factor = min(max(strength / max(reach, 1e-3), SIZE[0]), SIZE[1])
    low, high = CAPS.get(effect_of(knob.name), (knob.low, knob.high))
    low, high = max(low, knob.low), min(high, knob.high)
    # Only signs that the bounds allow
    signs = [sign for sign in (-1.0, 1.0) if (high if sign > 0.0 else -low) > 0.0]
    value = float(draw.choice(signs)) * factor * knob.typical
    return float(min(max(value, low), high))


def choose_effects(
    knobs: Sequence[FreeParameter], count: int, row: ChallengeRow, draw: Draw
) -> tuple[InjectedEffect, ...]:
    """Draw distinguishable hidden effects; all effects are equally likely."""
    out: list[InjectedEffect] = []
    while len(out) < count:
        # Sorted, because the order of a set differs between runs and the draw must be reproducible
        effects = sorted({effect_of(knob.name) for knob in knobs})
        effect = effects[int(draw.integers(len(effects)))]
        own = [knob for knob in knobs if effect_of(knob.name) == effect]
        knob = own[int(draw.integers(len(own)))]
        if any(
            # Two effects that the data cannot distinguish would count as one
            effect_of(one.knob) == effect or is_equivalent(one.knob, knob.name, row.data)
            for one in out
        ):
            continue
        out.append(InjectedEffect(knob.name, _draw_size(knob, row, draw)))
    return tuple(out)


def draw_outside_parameters(kind: str, draw: Draw) -> dict[str, float]:
    """Draw the parameters of an effect outside the library."""
    one = STRANGE[kind]
    values = {name: float(draw.uniform(*between)) for name, between in one.usual.items()}
    return {
        parameter.name: values.get(parameter.name, parameter.null)
        for parameter in one.effect.parameters
    }


def scale_unlisted_effect(
    kind: str, parameters: Mapping[str, float], factor: float
) -> dict[str, float]:
    """Scale an effect outside the library, up to its upper bound."""
    # The first parameter of every kind is its size
    size = min(parameters['size'] * factor, STRANGE[kind].effect.parameters[0].high)
    return {**parameters, 'size': size}


def choose_outside_kind(draw: Draw, *, late: bool) -> str:
    """Draw a kind outside the library, from the early or the late ones."""
    names = sorted(name for name, one in OUTSIDE.items() if one.late == late)
    return names[int(draw.integers(len(names)))]


def draw_structured_errors(draw: Draw) -> dict[str, Mapping[str, float]]:
    """Draw the model errors that all flights of the row 'structured' have."""
    return {kind: draw_outside_parameters(kind, draw) for kind in STRUCTURED}

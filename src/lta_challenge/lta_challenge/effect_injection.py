"""Draw the hidden effects: names, parameters and sizes."""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_challenge.outside import OUTSIDE, STRANGE, STRUCTURED
from lta_challenge.rows import ChallengeRow
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.equivalence_classes import find_kind_classes, is_same_class
import numpy as np

Draw = np.random.Generator

STRENGTH: Final = (2.0, 120.0)  # deviations that an effect is to come to
SIZE: Final = (0.05, 8.0)  # typical sizes, whatever that comes to
# Beyond these a vehicle no longer flies, or no longer as itself.
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
CLEAR: Final = (4.0, 40.0)  # floors of unexplained force that something outside comes to
FAINT: Final = 2.0  # floors; what comes to less is drawn again


@final
class InjectedEffect(NamedTuple):
    """A knob of the library, turned."""

    knob: str
    value: float


def effect_of(knob: str) -> str:
    """Return the effect that a knob is of."""
    return knob.partition('.')[0]


def list_candidates(knobs: Sequence[FreeParameter], row: ChallengeRow) -> list[FreeParameter]:
    """Return what can be hidden in flights of a row: all that such data say anything of."""
    told = find_kind_classes(row.data)
    return [
        knob
        for knob in knobs
        if knob.typical > 0.0 and knob.name in told.reach and knob.name not in told.unseen
    ]


def _draw_size(knob: FreeParameter, row: ChallengeRow, draw: Draw) -> float:
    """Return how far a knob is turned: for a drawn strength, by what such data showed once."""
    reach = find_kind_classes(row.data).reach[knob.name][0]
    strength = STRENGTH[0] * (STRENGTH[1] / STRENGTH[0]) ** draw.random()
    factor = min(max(strength / max(reach, 1e-3), SIZE[0]), SIZE[1])
    low, high = CAPS.get(effect_of(knob.name), (knob.low, knob.high))
    low, high = max(low, knob.low), min(high, knob.high)
    signs = [sign for sign in (-1.0, 1.0) if (high if sign > 0.0 else -low) > 0.0]
    value = float(draw.choice(signs)) * factor * knob.typical
    return float(min(max(value, low), high))


def choose_effects(
    knobs: Sequence[FreeParameter], count: int, row: ChallengeRow, draw: Draw
) -> tuple[InjectedEffect, ...]:
    """Return some hidden effects: each effect as likely as any, no two that are one name."""
    out: list[InjectedEffect] = []
    while len(out) < count:
        effects = sorted({effect_of(knob.name) for knob in knobs})
        effect = effects[int(draw.integers(len(effects)))]
        own = [knob for knob in knobs if effect_of(knob.name) == effect]
        knob = own[int(draw.integers(len(own)))]
        if any(
            effect_of(one.knob) == effect or is_same_class(one.knob, knob.name, row.data)
            for one in out
        ):
            continue
        out.append(InjectedEffect(knob.name, _draw_size(knob, row, draw)))
    return tuple(out)


def draw_outside(kind: str, draw: Draw) -> dict[str, float]:
    """Return parameters of something outside the library, drawn."""
    one = STRANGE[kind]
    given = {name: float(draw.uniform(*between)) for name, between in one.usual.items()}
    return {known.name: given.get(known.name, known.null) for known in one.effect.parameters}


def scale_outside(kind: str, parameters: Mapping[str, float], factor: float) -> dict[str, float]:
    """Return something outside the library at another strength, as far as it can be had."""
    size = min(parameters['size'] * factor, STRANGE[kind].effect.parameters[0].high)
    return {**parameters, 'size': size}


def choose_outside(draw: Draw, *, late: bool) -> str:
    """Return a kind that is in no library, of those written early or of those written late."""
    names = sorted(name for name, one in OUTSIDE.items() if one.late == late)
    return names[int(draw.integers(len(names)))]


def draw_structured(draw: Draw) -> dict[str, Mapping[str, float]]:
    """Return what is wrong with the model in all flights of the row 'structured'."""
    return {kind: draw_outside(kind, draw) for kind in STRUCTURED}

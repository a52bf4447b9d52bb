"""
Which effects carry over: chosen one by one by what they do to regimes that were left out.

A group of knobs is one name. About the model so far, all flights are linearised once; then every
candidate is fitted without each regime in turn and judged by that regime, which is algebra on
small matrices. The best is added and everything refitted, until none is worth it.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_analysis.discovery.foresight import Foresight
from lta_analysis.discovery.knobs import Knob
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# What has one name, with what it may be off by in typical sizes of its knobs.
CANDIDATES: Final[Mapping[str, tuple[str, ...]]] = {
    'added inertia': ('added_inertia.roll', 'added_inertia.pitch', 'added_inertia.yaw'),
    'added mass': ('added_mass.surge', 'added_mass.sway', 'added_mass.heave'),
    'tilt of the tracker': ('tracker_misalignment.pitch', 'tracker_misalignment.roll'),
    'steady current': ('steady_wind.x', 'steady_wind.y', 'steady_wind.z'),
    'current gradient': tuple(
        f'wind_gradient.{each}'
        for each in ('x_x', 'x_y', 'x_z', 'y_x', 'y_y', 'y_z', 'z_x', 'z_y')
    ),
    'balance': ('cg_offset.x', 'cg_offset.y', 'cg_height.z'),
    'moving mass': ('moving_mass.mass',),
    'thrust of each rotor': ('rotor_1.thrust', 'rotor_2.thrust'),
    'direction of each rotor': (
        'rotor_misalignment.first_1', 'rotor_misalignment.second_1',
        'rotor_misalignment.first_2', 'rotor_misalignment.second_2',
    ),
    'damping of turns': (
        'hull_lift.roll_rate', 'hull_lift.pitch_rate', 'hull_lift.yaw_rate',
        'rotational_drag.roll_2', 'rotational_drag.pitch_2', 'rotational_drag.yaw_2',
    ),
    'aerodynamic centre': ('hull_lift.x', 'hull_lift.z'),
    'drag of the hull': ('hull_lift.drag', 'hull_lift.drag_alpha2', 'hull_lift.drag_beta2'),
    'side force': ('hull_lift.side', 'hull_lift.side_alpha2', 'hull_lift.side_beta'),
    'lift of the hull': ('hull_lift.lift', 'hull_lift.lift_alpha', 'hull_lift.lift_beta2'),
    'rolling moment': ('hull_lift.roll', 'hull_lift.roll_alpha', 'hull_lift.roll_beta'),
    'pitching moment': ('hull_lift.pitch', 'hull_lift.pitch_alpha', 'hull_lift.pitch_beta4'),
    'yawing moment': ('hull_lift.yaw', 'hull_lift.yaw_alpha', 'hull_lift.yaw_beta'),
}  # fmt: skip
# Fitted freely beside what is named, without a name of their own.
LEFT: Final = ('added mass', 'steady current', 'balance', 'moving mass')
REFITTED: Final = tuple(
    knob
    for name, group in CANDIDATES.items()
    for knob in group
    if 'rotor' not in name and name not in LEFT
)
ALL: Final = tuple(knob for group in CANDIDATES.values() for knob in group)
# What is fitted to forecasts alone, without a claim to a name.
EVERY: Final = (
    *ALL, 'vehicle.roll', 'vehicle.pitch', 'vehicle.yaw', 'moving_mass.x', 'moving_mass.z',
    'rotational_drag.roll', 'rotational_drag.pitch', 'rotational_drag.yaw',
    'linear_drag.surge', 'linear_drag.sway', 'linear_drag.heave',
)  # fmt: skip
# How far those may be off that have no typical size, or one of another hall than a still one.
LOOSE: Final[Mapping[str, float]] = {
    'rotor_1.thrust': 0.3, 'rotor_2.thrust': 0.3,
    'vehicle.roll': 0.3, 'vehicle.pitch': 0.3, 'vehicle.yaw': 0.3,
    'steady_wind': 0.2, 'wind_gradient': 0.2, 'tracker_misalignment': 0.03,
}  # fmt: skip
WIDE: Final = 3.0  # typical sizes; of what is named
FREE: Final = 4.0  # typical sizes; of coefficients that are refitted without a name
LOOSELY: Final = 30.0  # typical sizes; of everything that is fitted to forecasts alone
WORTH: Final = 0.015  # of the squared error of the vehicle file in regimes left out
WORST: Final = -0.12  # of that of a regime; one that promises any regime worse is not taken
MOST: Final = 6


@final
class Chosen(NamedTuple):
    """Names in the order in which they were added, and what each was worth."""

    names: tuple[str, ...]
    worth: tuple[float, ...]
    values: Array


def places(knobs: Sequence[Knob], names: Sequence[str]) -> list[int]:
    """Return where knobs are."""
    order = [knob.name for knob in knobs]
    return [order.index(name) for name in names]


def spreads(knobs: Sequence[Knob], which: Sequence[int], wide: float) -> Array:
    """Return how far knobs may be off."""
    return np.array([max(wide * knobs[k].typical, 2.0 * knobs[k].tolerance) for k in which])


def loosely(knobs: Sequence[Knob], which: Sequence[int]) -> Array:
    """Return how far knobs may be off that are fitted to forecasts alone."""
    usual = spreads(knobs, which, LOOSELY)
    names = [knobs[k].name for k in which]
    return np.array(
        [
            LOOSE.get(name, LOOSE.get(name.partition('.')[0], one))
            for name, one in zip(names, usual, strict=True)
        ]
    )


def choose(
    sight: Foresight, flights: Sequence[int], regimes: Mapping[str, Sequence[int]]
) -> Chosen:
    """
    Return the names that carry over, by some flights alone.

    Parameters
    ----------
    sight : Foresight
        About the pieces that teach.
    flights : sequence of int
        That teach.
    regimes : mapping of str to sequence of int
        Of all flights.

    """
    inside = set(flights)
    groups = [g for g in ([f for f in r if f in inside] for r in regimes.values()) if g]
    every = places(sight.knobs, ALL)
    chosen: tuple[str, ...] = ()
    worth: tuple[float, ...] = ()
    values = np.zeros(len(sight.knobs))
    first = 0.0
    while len(chosen) < MOST:
        about = sight.fit(every, np.ones(len(every)), flights, values, rounds=0)
        said = dict(zip(flights, about.said, strict=True))
        first = first or sum(one.cost for one in about.said)
        now = places(sight.knobs, [knob for name in chosen for knob in CANDIDATES[name]])
        rest = [name for name in CANDIDATES if name not in chosen]
        base = _judged(sight, said, groups, every, now, values)
        gains = {}
        for name in rest:
            more = [*now, *places(sight.knobs, CANDIDATES[name])]
            gain = _judged(sight, said, groups, every, more, values) - base
            costs = np.array([sum(said[f].cost for f in group) for group in groups])
            if (gain / costs).min() > WORST:
                gains[name] = float(gain.sum()) / len(regimes_of(groups)) / first
        best = max(gains, key=lambda name: gains[name], default='')
        if not best or gains[best] < WORTH:
            break
        chosen, worth = (*chosen, best), (*worth, gains[best])
        which = places(sight.knobs, [knob for name in chosen for knob in CANDIDATES[name]])
        values = sight.fit(which, spreads(sight.knobs, which, WIDE), flights, values, 2).values
    return Chosen(chosen, worth, values)


def regimes_of(groups: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """Return how often each flight is in a regime, once: 2 where two kinds of regime cover all."""
    seen = [f for group in groups for f in group]
    return tuple(range(max(1, round(len(seen) / len(set(seen))))))


def _judged(
    sight: Foresight,
    said: Mapping[int, object],
    groups: Sequence[Sequence[int]],
    every: Sequence[int],
    which: Sequence[int],
    values: Array,
) -> Array:
    """Return by how much each regime gets better by what the others say, in squared error."""
    if not which:
        return np.zeros(len(groups))
    at = [every.index(k) for k in which]
    grid = np.ix_(at, at)
    wall = np.diag(spreads(sight.knobs, which, WIDE) ** -2.0)
    low = np.array([sight.knobs[k].low for k in which]) - values[which]
    high = np.array([sight.knobs[k].high for k in which]) - values[which]
    products = {f: one.products[grid] for f, one in said.items()}  # type: ignore[attr-defined]
    pulls = {f: one.pull[at] for f, one in said.items()}  # type: ignore[attr-defined]
    out = []
    for group in groups:
        others = [f for f in said if f not in set(group)]
        inner = wall + sum(products[f] for f in others)
        right = sum(pulls[f] for f in others) - wall @ values[which]
        step = np.clip(np.linalg.solve(inner, right), low, high)
        n, b = sum(products[f] for f in group), sum(pulls[f] for f in group)
        out.append(float(2.0 * step @ b - step @ n @ step))
    return np.array(out)

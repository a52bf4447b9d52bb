# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Plan a layout: list positions, minimise the lamps, assign frequencies, compute reception.

To choose lamps is a set cover, which is NP-hard. A greedy solution (Chvatal, A greedy heuristic
for the set-covering problem, Mathematics of Operations Research 4, 1979) is improved by large
neighbourhood search: remove neighbouring lamps and fill the hole again. The linear relaxation
gives a lower bound.
"""

from collections.abc import Callable, Sequence
import math
from typing import Final

from lta_config.errors import BadInput
from lta_studies.light.plan.floor import (
    Array,
    FloorGrid,
    FloorPlan,
    LampMount,
    Mask,
    points_in_polygon,
    polygon_edges,
    signed_area,
    Vector,
)
from lta_studies.light.plan.frequencies import build_band, choose_frequencies, FrequencyBand
from lta_studies.light.plan.joint_snr import LightReceiver
from lta_studies.light.plan.layout import LampLayout, LayoutLamp
from lta_studies.light.plan.reception import (
    ambient_shares,
    build_lamp_link,
    compute_lamp_light,
    compute_simultaneous_snr,
    solve_required_light,
)
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

LAMP_TO_WALL = 0.05  # m between a wall and the lamp on it
FACING_DOWN = (0.0, 0.0, -1.0)
MOST_MOUNTS = 5000  # candidate positions


def list_mounts(plan: FloorPlan) -> list[LampMount]:
    """
    Return all candidate positions, existing lamps first.

    Raise `BadInput` if there are no positions, or too many.
    """
    standing = []
    for name, lamp in plan.lamps.items():
        x, y, z = lamp.position.vector
        axis = np.array(lamp.facing.vector) / np.linalg.norm(lamp.facing.vector)
        frequency = None if lamp.frequency is None else lamp.frequency.si
        standing.append(LampMount((x, y, z), _to_vector(axis), name, frequency))
    new = list_ceiling_mounts(plan) if plan.lamp.facing == 'down' else list_wall_mounts(plan)
    mounts = standing + new
    if not mounts:
        raise BadInput(
            f'{plan.name} has no position for a lamp facing {plan.lamp.facing} at a height of '
            f'{plan.lamp.height.si:g} m; make the forbidden areas smaller, change '
            'lamp.height, or reduce lamp.spacing.'
        )
    if len(mounts) > MOST_MOUNTS:
        raise BadInput(
            f'{plan.name} has {len(mounts)} possible positions for lamps, more than '
            f'{MOST_MOUNTS}; '
            'increase lamp.spacing.'
        )
    return mounts


def list_ceiling_mounts(plan: FloorPlan) -> list[LampMount]:
    """Return the positions of lamps that face down: a regular grid over the hall."""
    corners, spacing = plan.outline.corners, plan.lamp.spacing.si
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes = [
        low[k] + (np.arange(count) + 0.5) * (high[k] - low[k]) / count
        for k in (0, 1)
        # A whole number of equal intervals near the wanted spacing
        for count in [max(round(float(high[k] - low[k]) / spacing), 1)]
    ]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    allowed = points[_is_allowed(plan, points)]
    return [LampMount((float(x), float(y), plan.lamp.height.si), FACING_DOWN) for x, y in allowed]


def list_wall_mounts(plan: FloorPlan) -> list[LampMount]:
    """Return the positions of lamps that face sideways: on walls and taller obstacles."""
    faces = [_place_along_sides(plan.outline.corners, plan.lamp.spacing.si, inwards=True)]
    for obstacle in plan.obstacles.values():
        # A lamp can only hang on an obstacle that reaches its height.
        if obstacle.height.si > plan.lamp.height.si:
            faces += [
                _place_along_sides(footprint, plan.lamp.spacing.si, inwards=False)
                for footprint in obstacle.footprints
            ]
    points, axes = (np.vstack(part) for part in zip(*faces, strict=True))
    allowed = _is_allowed(plan, points)
    return [
        LampMount((float(x), float(y), plan.lamp.height.si), (float(a), float(b), 0.0))
        for (x, y), (a, b) in zip(points[allowed], axes[allowed], strict=True)
    ]


def _place_along_sides(corners: Array, spacing: float, inwards: bool) -> tuple[Array, Array]:
    """Return points just off the sides of a polygon, with the normals of the sides."""
    # The inside of a counter-clockwise polygon is to the left of its sides.
    left = 1.0 if (signed_area(corners) > 0.0) == inwards else -1.0
    points, axes = [], []
    for x0, y0, x1, y1 in polygon_edges(corners):
        side = np.array([x1 - x0, y1 - y0])
        length = float(np.hypot(*side))
        count = max(round(length / spacing), 1)
        # Unit normal: the side turned left by 90 degrees
        away = left * np.array([-side[1], side[0]]) / length
        # Middles of equal parts of the side
        parts = (np.arange(count)[:, None] + 0.5) / count
        points.append((x0, y0) + parts * side + LAMP_TO_WALL * away)
        axes.append(np.tile(away, (count, 1)))
    return np.vstack(points), np.vstack(axes)


def _is_allowed(plan: FloorPlan, points: Array) -> Mask:
    """Return which points are in the hall, not forbidden and not inside an obstacle."""
    allowed = points_in_polygon(points, plan.outline.corners)
    for area in plan.forbidden.values():
        allowed &= ~points_in_polygon(points, area.corners)
    for obstacle in plan.obstacles.values():
        if obstacle.height.si > plan.lamp.height.si:
            for footprint in obstacle.footprints:
                allowed &= ~points_in_polygon(points, footprint)
    return allowed


def _to_vector(vector: Array) -> Vector:
    x, y, z = vector.tolist()
    return x, y, z


OPTIMUM_TOLERANCE: Final = 1e-6  # tolerance of the linear program's optimum
IMPROVEMENT_TRIES: Final = 400  # iterations of the improvement
MOST_REMOVED: Final = 6  # maximum number of lamps removed at once
LEAST_WEIGHT: Final = 0.7  # random weights in [0.7, 1] vary the greedy choice

Chosen = list[int]
Whole = NDArray[np.int64]


def coverage_demand(audible: Mask, overlap: int) -> Whole:
    """Return the demand of each cell: `overlap`, or the number of lamps it can receive."""
    return np.asarray(np.minimum(audible.sum(axis=0), overlap), dtype=np.int64)


def select_greedily(
    audible: Mask, needed: Whole, existing: Chosen, most: int, weights: Array | None = None
) -> Chosen:
    """
    Select lamps greedily by the unmet demand that each covers.

    Parameters
    ----------
    audible : ndarray of bool, shape (lamps, cells)
        Whether a lamp is received in a cell.
    needed : ndarray of int, shape (cells,)
        Demand of each cell.
    existing : list of int
        Lamps that are always included.
    most : int
        Maximum number of lamps.
    weights : ndarray, shape (lamps,), optional
        Weights of the lamps; equal by default.

    """
    chosen = list(existing)
    lacking = needed - audible[chosen].sum(axis=0)
    worth = np.ones(len(audible)) if weights is None else weights.copy()
    # A lamp that is already chosen has no further worth.
    worth[chosen] = 0.0
    while len(chosen) < most and lacking.max(initial=0) > 0:
        gains = worth * audible[:, lacking > 0].sum(axis=1)
        best = int(gains.argmax())
        if gains[best] <= 0.0:
            break
        chosen.append(best)
        worth[best] = 0.0
        lacking = lacking - audible[best]
    return chosen


def improve_cover(
    audible: Mask, needed: Whole, chosen: Chosen, existing: Chosen, bound: int, chance: Generator
) -> Chosen:
    """
    Search for fewer lamps with the same coverage.

    Repeatedly removes a lamp and its neighbours and fills the hole greedily with random weights.
    A solution that is not worse is accepted.

    `audible`, `needed`, `existing`: as in `select_greedily`. `chosen`: initial solution. `bound`:
    lower bound; the search stops there.
    """
    # With a limit on the lamps the demand may be unmet; keep what the greedy choice reached.
    goal = np.minimum(audible[chosen].sum(axis=0), needed)
    best = drop_redundant_lamps(audible, goal, chosen, existing)
    for _ in range(IMPROVEMENT_TRIES):
        movable = [lamp for lamp in best if lamp not in existing]
        if len(best) <= bound or not movable:
            break
        # Neighbours: lamps that share the most cells with a random one
        shared = (audible[movable] & audible[chance.choice(movable)]).sum(axis=1)
        hole = {movable[k] for k in np.argsort(-shared)[: chance.integers(2, MOST_REMOVED + 1)]}
        rest = [lamp for lamp in best if lamp not in hole]
        weights = chance.uniform(LEAST_WEIGHT, 1.0, len(audible))
        filled = select_greedily(audible, goal, rest, len(best), weights)
        # Accept an equal number of lamps too: another layout may have a redundant one.
        if np.all(audible[filled].sum(axis=0) >= goal):
            best = drop_redundant_lamps(audible, goal, filled, existing)
    return best


def drop_redundant_lamps(audible: Mask, goal: Whole, chosen: Chosen, existing: Chosen) -> Chosen:
    """Drop lamps whose cells all receive enough others, in the order of choice."""
    count = audible[chosen].sum(axis=0)
    left = list(chosen)
    for lamp in chosen:
        if lamp not in existing and np.all(count - audible[lamp] >= goal):
            left.remove(lamp)
            count = count - audible[lamp]
    return left


def solve_lower_bound(audible: Mask, needed: Whole, existing: Chosen) -> int:
    """Return a lower bound on the number of lamps, from the linear relaxation."""
    columns, weights = merge_duplicate_cells(audible, needed)
    if not columns.size:
        return len(existing)
    least = np.zeros(len(audible))
    least[existing] = 1.0
    # Without `integrality` this is the linear relaxation.
    solution = milp(
        np.ones(len(audible)),
        bounds=Bounds(least, np.ones(len(audible))),
        constraints=LinearConstraint(csr_array(columns.T.astype(float)), lb=weights),
    )
    return math.ceil(float(solution.fun or 0.0) - OPTIMUM_TOLERANCE)


def merge_duplicate_cells(audible: Mask, needed: Whole) -> tuple[Mask, Whole]:
    """Return the unique columns with their demand, without cells that need nothing."""
    asks = needed > 0
    # Bits packed into bytes make `unique` eight times smaller.
    packed = np.vstack([np.packbits(audible[:, asks], axis=0), needed[asks].astype(np.uint8)])
    _, first = np.unique(packed, axis=1, return_index=True)
    return audible[:, asks][:, first], needed[asks][first]


PLAN_SEED: Final = 1  # random seed of the search for fewer lamps


def plan_layout(
    plan: FloorPlan,
    ear: LightReceiver,
    floor: FloorGrid,
    mounts: list[LampMount],
    overlap: int,
    most: int | None,
    measure_light: Callable[[float], Sequence[Array]] | None = None,
) -> LampLayout:
    """
    Plan the positions and frequencies of lamps.

    Parameters
    ----------
    plan, ear, floor, mounts
        Hall, receiver, cells, and candidate positions.
    overlap : int
        Number of lamps that each cell should receive.
    most : int or None
        Maximum number of lamps.
    measure_light : callable, optional
        `compute_lamp_light`, in groups of lamps, as a function of the faintest light that counts.

    Raises
    ------
    BadInput
        If no lamp can be received anywhere, or there are not enough frequencies.

    """
    # Only existing lamps have a name; they always stay.
    existing = [k for k, mount in enumerate(mounts) if mount.name]
    if most is not None and most < len(existing):
        raise BadInput(
            f'{plan.name} already has {len(existing)} lamps, more than --lamps {most}; raise '
            '--lamps.'
        )
    band = build_band(
        ear.demodulation, ear.light.sample_rate.si, ear.light.samples,
        plan.ambient.mains_frequency.si, plan.lamp.duty.si,
    )  # fmt: skip
    # Positions are chosen before frequencies: any clear frequency serves to find the light needed.
    first = choose_frequencies(band, [], 1)[0][0]
    link, share = (
        build_lamp_link(plan, ear, mounts[0], first),
        float(ambient_shares(plan, ear).mean()),
    )
    least = solve_required_light(link, share, ear.required_snr)
    light = (
        compute_lamp_light(plan, ear, floor, mounts, least)
        if measure_light is None
        else np.concatenate(measure_light(least))
    )
    # Index 0 is the light at the worst heading.
    alone = light[:, 0] >= least
    if not alone.any():
        raise BadInput(_explain_no_reception(plan, ear, least))
    # Cells that receive the same lamps are one constraint, which shrinks the problem.
    cells, needed = merge_duplicate_cells(alone, coverage_demand(alone, overlap))
    bound = solve_lower_bound(cells, needed, existing)
    chosen = select_greedily(cells, needed, existing, len(mounts) if most is None else most)
    chosen = improve_cover(
        cells, needed, chosen, existing, bound, np.random.default_rng(PLAN_SEED)
    )
    # Number the lamps from top left to bottom right.
    chosen.sort(key=lambda k: (-round(mounts[k].position[1], 3), mounts[k].position[0]))
    lamps, order = _assign_frequencies([mounts[k] for k in chosen], band)
    chosen_mounts, tones = [lamp.mount for lamp in lamps], [lamp.frequency for lamp in lamps]
    # Index 1 is the light at the best heading: 0 where the lamp is hidden.
    snr = compute_simultaneous_snr(plan, ear, floor, chosen_mounts, tones, light[chosen, 1] > 0.0)
    return LampLayout(
        plan, floor, ear, overlap, lamps, light[chosen, 0], snr, alone.sum(axis=0), len(mounts),
        least, order, bound,
    )  # fmt: skip


def _assign_frequencies(
    mounts: list[LampMount], band: FrequencyBand
) -> tuple[tuple[LayoutLamp, ...], int]:
    """Return lamps with names and frequencies, and the clear order of harmonics."""
    existing = [mount.frequency for mount in mounts if mount.frequency is not None]
    new, order = choose_frequencies(band, existing, len(mounts) - len(existing))
    coming = iter(new)
    return tuple(
        LayoutLamp(
            mount.name or f'lamp_{k}',
            mount,
            next(coming) if mount.frequency is None else mount.frequency,
        )
        for k, mount in enumerate(mounts, start=1)
    ), order


def _explain_no_reception(plan: FloorPlan, ear: LightReceiver, least: float) -> str:
    vehicle, ambient = ear.vehicle.file.name, plan.ambient.steady.si
    if math.isinf(least):
        return (
            f'{vehicle} cannot receive any lamp in {plan.name}, however bright: the ambient light '
            f'of {ambient:g} lx saturates its ADC, or the mains flicker is too strong. Plan for '
            'less ambient light, or give the diodes a smaller feedback resistor.'
        )
    return (
        f'{vehicle} receives no lamp of {plan.name} at all headings, wherever it flies: its '
        f'diodes need {least:.2g} lx without shade. Mount the lamps nearer to the altitude '
        'of the drone, or use brighter lamps.'
    )

"""Plan a layout: minimise the lamps, assign frequencies, then compute the joint reception."""

from collections.abc import Callable, Sequence
import math
from typing import Final

from lta_config.errors import BadInput
from lta_studies.light.plan.floor import FloorGrid
from lta_studies.light.plan.floor_plan import FloorPlan
from lta_studies.light.plan.frequencies import build_band, choose_frequencies, FrequencyBand
from lta_studies.light.plan.layout import LampLayout, LayoutLamp
from lta_studies.light.plan.mounts import LampMount
from lta_studies.light.plan.polygon import Array
from lta_studies.light.plan.receiver import LightReceiver
from lta_studies.light.plan.reception import (
    ambient_shares,
    build_lamp_link,
    compute_lamp_light,
    compute_simultaneous_snr,
    solve_required_light,
)
from lta_studies.light.plan.set_cover import (
    coverage_demand,
    improve_cover,
    merge_duplicate_cells,
    select_greedily,
    solve_lower_bound,
)
import numpy as np

SEED: Final = 1  # random seed of the search for fewer lamps


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
    chosen = improve_cover(cells, needed, chosen, existing, bound, np.random.default_rng(SEED))
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

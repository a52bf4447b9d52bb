"""What the flights of a comparison say together, with the spread over seeds, and why."""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.schema.comparison_file import Comparison
from lta_flight.sweep.statistics import Share, wilson
from lta_model.hover import lifting
from lta_model.vehicle import Vehicle
from lta_studies.platforms.run import ABLATION, CONTESTANT, LIMIT, Row
import numpy as np
from scipy.special import stdtrit


class Mean(NamedTuple):
    """A mean with the ends of its 95 % interval (Student's t over seeds)."""

    value: float
    low: float
    high: float


@final
@dataclass(frozen=True, slots=True)
class Cell:
    """All seeds of one entry in one manoeuvre."""

    rows: list[Row]

    @property
    def held(self) -> Share:
        """Share of the flights that did as asked."""
        return wilson(sum(row.held for row in self.rows), len(self.rows))

    def mean(self, name: str, of: str = 'metrics') -> Mean:
        """Return the mean of one figure over the seeds in which it is a number."""
        return mean([getattr(getattr(row, of), name) for row in self.rows])

    @property
    def speed(self) -> Mean:
        """Speed reached at the end. [m/s]."""
        return mean([row.speed for row in self.rows])


def mean(values: Sequence[float]) -> Mean:
    """Return a mean of what are numbers; NaN of nothing, no interval of one."""
    good = [value for value in values if math.isfinite(value)]
    if not good:
        return Mean(math.nan, math.nan, math.nan)
    middle = float(np.mean(good))
    if len(good) == 1:
        return Mean(middle, math.nan, math.nan)
    half = float(stdtrit(len(good) - 1, 0.975) * np.std(good, ddof=1) / math.sqrt(len(good)))
    return Mean(middle, middle - half, middle + half)


def cell(
    rows: Sequence[Row], kind: str, name: str, manoeuvre: str, speed: float | None = None
) -> Cell:
    """Return the flights of an entry in a manoeuvre."""
    return Cell(
        [
            row for row in rows
            if (row.job.kind, row.job.name, row.job.manoeuvre, row.job.speed)
            == (kind, name, manoeuvre, speed)
        ]
    )  # fmt: skip


def reversals(comparison: Comparison, rows: Sequence[Row]) -> list[str]:
    """Return a sentence for each ablation and manoeuvre: what the change turns, or does not."""
    told = []
    for name, ablation in comparison.ablations.items():
        title = comparison.contestants[ablation.of].title
        turned: list[str] = []
        same: list[str] = []
        for manoeuvre in ablation.manoeuvres:
            base = cell(rows, CONTESTANT, ablation.of, manoeuvre)
            changed = cell(rows, ABLATION, name, manoeuvre)
            if not base.rows or not changed.rows:
                continue
            a, b = (sum(row.held for row in part.rows) for part in (base, changed))
            text = f'{manoeuvre} ({a} of {len(base.rows)} held, then {b})'
            (turned if (2 * a > len(base.rows)) != (2 * b > len(changed.rows)) else same).append(
                text
            )
        parts = [
            *([f'reverses {", ".join(turned)}'] if turned else []),
            *([f'leaves {", ".join(same)} as they are'] if same else []),
        ]
        told.append(f'{title}; {ablation.why}: {" and ".join(parts)}.')
    return told


def fastest(comparison: Comparison, rows: Sequence[Row], name: str) -> tuple[float, float]:
    """Return the highest speed asked for up to which all were held, and the speed reached most."""
    limit = comparison.limits[name]
    held, reached = 0.0, 0.0
    unbroken = True
    for speed in limit.speeds.vector:
        found = cell(rows, LIMIT, name, limit.manoeuvre, speed)
        unbroken = unbroken and bool(found.rows) and all(row.held for row in found.rows)
        held = speed if unbroken else held
        reached = max(reached, found.speed.value)
    return held, reached


def margin(vehicle: Vehicle) -> tuple[float, float]:
    """Return the lift of all lifting rotors at full thrust, and what they have to carry. [N]"""
    own, per_newton = lifting(vehicle.rotors, vehicle.file.aero.coupling)
    full = min((rotor.full for rotor in own), default=0.0)
    return full * per_newton, vehicle.heaviness * STANDARD_GRAVITY

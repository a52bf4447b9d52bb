"""Summarize the flights of a comparison: means over seeds, ablations and top speeds."""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.schema.comparison_file import ComparisonFile
from lta_flight.sweep.statistics import ShareInterval, wilson_interval
from lta_model.propulsion import select_lifting_rotors
from lta_model.vehicle import Vehicle
from lta_studies.platforms.run import ABLATION, CONTESTANT, LIMIT, PlatformResult
import numpy as np
from scipy.special import stdtrit


class SeedMean(NamedTuple):
    """A mean with its 95 % interval (Student's t over seeds)."""

    value: float
    low: float
    high: float


@final
@dataclass(frozen=True, slots=True)
class ComparisonCell:
    """All seeds of one entry in one manoeuvre."""

    rows: list[PlatformResult]

    @property
    def success_share(self) -> ShareInterval:
        """Share of the flights that held the manoeuvre."""
        return wilson_interval(sum(row.held for row in self.rows), len(self.rows))

    def mean_metric(self, name: str, of: str = 'metrics') -> SeedMean:
        """Return the mean of one metric over the seeds where it is finite."""
        return estimate_mean([getattr(getattr(row, of), name) for row in self.rows])

    @property
    def final_speed(self) -> SeedMean:
        """Speed reached at the end. [m/s]."""
        return estimate_mean([row.speed for row in self.rows])


def estimate_mean(values: Sequence[float]) -> SeedMean:
    """Return the mean of the finite values; NaN if none, NaN interval if one."""
    good = [value for value in values if math.isfinite(value)]
    if not good:
        return SeedMean(math.nan, math.nan, math.nan)
    middle = float(np.mean(good))
    if len(good) == 1:
        return SeedMean(middle, math.nan, math.nan)
    half = float(stdtrit(len(good) - 1, 0.975) * np.std(good, ddof=1) / math.sqrt(len(good)))
    return SeedMean(middle, middle - half, middle + half)


def select_flights(
    rows: Sequence[PlatformResult],
    kind: str,
    name: str,
    manoeuvre: str,
    speed: float | None = None,
) -> ComparisonCell:
    """Return the flights of an entry in a manoeuvre."""
    return ComparisonCell(
        [
            row for row in rows
            if (row.job.kind, row.job.name, row.job.manoeuvre, row.job.speed)
            == (kind, name, manoeuvre, speed)
        ]
    )  # fmt: skip


def describe_reversals(comparison: ComparisonFile, rows: Sequence[PlatformResult]) -> list[str]:
    """Return a sentence for each ablation: which manoeuvres it reverses."""
    sentences = []
    for name, ablation in comparison.ablations.items():
        title = comparison.contestants[ablation.of].title
        turned: list[str] = []
        same: list[str] = []
        for manoeuvre in ablation.manoeuvres:
            base = select_flights(rows, CONTESTANT, ablation.of, manoeuvre)
            changed = select_flights(rows, ABLATION, name, manoeuvre)
            if not base.rows or not changed.rows:
                continue
            # Reversed: the majority of flights changes between held and not held.
            a, b = (sum(row.held for row in part.rows) for part in (base, changed))
            text = f'{manoeuvre} ({a} of {len(base.rows)} flights held, {b} with the change)'
            (turned if (2 * a > len(base.rows)) != (2 * b > len(changed.rows)) else same).append(
                text
            )
        parts = [
            *([f'changes the result of {", ".join(turned)}'] if turned else []),
            *([f'does not change the result of {", ".join(same)}'] if same else []),
        ]
        sentences.append(f'{title}; {ablation.why}: {" and ".join(parts)}.')
    return sentences


def find_top_speed(
    comparison: ComparisonFile, rows: Sequence[PlatformResult], name: str
) -> tuple[float, float]:
    """Return the commanded speed up to which all flights held, and the top speed."""
    limit = comparison.limits[name]
    held, reached = 0.0, 0.0
    unbroken = True
    for speed in limit.speeds.vector:
        flights = select_flights(rows, LIMIT, name, limit.manoeuvre, speed)
        # A speed held above one that failed does not count: the range must be continuous.
        unbroken = unbroken and bool(flights.rows) and all(row.held for row in flights.rows)
        held = speed if unbroken else held
        reached = max(reached, flights.final_speed.value)
    return held, reached


def compute_lift_margin(vehicle: Vehicle) -> tuple[float, float]:
    """Return the lift at full thrust and the weight it must carry. [N]"""
    own, per_newton = select_lifting_rotors(vehicle.rotors, vehicle.file.aero.coupling)
    # The lifting rotors share the load, so the weakest limits all.
    full = min((rotor.full_thrust for rotor in own), default=0.0)
    return full * per_newton, vehicle.heaviness * STANDARD_GRAVITY

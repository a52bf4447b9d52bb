# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Detect wrong units: degrees for radians, mm for m, g for m/s2.

A wrong unit shows as a factor between two sources of a motion, or as a size that the quantity
never has in its own unit but always in another.
"""

from collections.abc import Callable, Iterator
import re
from typing import Final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_data.data_quality import limits, roles
from lta_data.data_quality.checks.readings import (
    CORRELATED,
    find_units_by_motion,
    name_factor,
    UNIT_KIND,
)
from lta_data.data_quality.motion import PoseSeries, VectorSeries
from lta_data.data_quality.recording import (
    CheckContext,
    CheckVerdict,
    QualityFinding,
    select_first_findings,
    Severity,
)
from lta_data.even_grid import sort_samples
from lta_data.flight import Channel
from lta_data.interpretation.kinematics import find_gravity_unit, fit_scale
import numpy as np
from numpy.typing import NDArray

KIND = UNIT_KIND
PRESSURE_PER_METRE: Final = (
    1.2 * STANDARD_GRAVITY
)  # pressure drop per metre of height, at 1.2 kg/m3 [Pa/m]


class UnitSizeRule(NamedTuple):
    """Size that reveals the unit of a channel: a statistic of its values, and ranges by unit."""

    names: re.Pattern[str]
    of: Callable[[NDArray[np.float64]], float]
    units: tuple[tuple[float, float, str], ...]
    most: bool = False  # whether most of the values, not only the largest, must have the size


def median_magnitude(values: NDArray[np.float64]) -> float:
    """Return the median magnitude."""
    return float(np.median(np.abs(values)))


def upper_magnitude(values: NDArray[np.float64]) -> float:
    """Return the 99th percentile of the magnitude."""
    return float(np.percentile(np.abs(values), 99.0))


SIZE_RULES: Final = (
    UnitSizeRule(
        re.compile(r'/fluid_pressure$'), median_magnitude,
        ((300.0, 1100.0, 'hPa'), (30.0, 110.0, 'kPa'), (0.3, 1.1, 'bar')),
    ),
    UnitSizeRule(re.compile(r'^battery/voltage$'), median_magnitude, ((2500.0, 61000.0, 'mV'),)),
    # No micro-drone draws 60 A
    UnitSizeRule(re.compile(r'^(battery|panel)/current$'), median_magnitude, ((60.0, 1e5, 'mA'),)),
    UnitSizeRule(
        re.compile(r'^motors/effort[.\[]'), upper_magnitude,
        ((1.3, 100.0, '%'), (100.0, 255.0, 'of 255'), (1000.0, 65535.0, 'of 65535')), True,
    ),
    UnitSizeRule(re.compile(r'/percentage$'), median_magnitude, ((1.5, 100.0, '%'),)),
    UnitSizeRule(re.compile(r'(^|/)range/range$'), median_magnitude, ((40.0, 1e5, 'mm or cm'),)),
    UnitSizeRule(re.compile(r'\.(yaw|pitch|roll)$'), upper_magnitude, ((7.0, 361.0, 'deg'),)),
)  # fmt: skip


def find_wrong_units(evidence: CheckContext) -> CheckVerdict:
    """Find channels in a wrong unit."""
    findings: list[QualityFinding] = []
    for motion in evidence.motions:
        findings += find_units_by_motion(motion)
    # An estimate may be computed from these very sensors; prefer a tracker
    any_tracked = any(pose.tracked for pose in evidence.poses)
    for channel in evidence.recording.channels.values():
        for pose in evidence.poses:
            if pose.tracked or not any_tracked:
                findings += find_unit_by_height(pose, channel)
        findings += find_unit_by_size(channel)
    for sensor in evidence.inertials:
        if sensor.force is not None:
            findings += find_unit_by_gravity(
                sensor.force.name, sensor.force.time, sensor.force.values
            )
    return CheckVerdict(select_first_findings(findings), describe_unpaired_rates(evidence))


def describe_unpaired_rates(evidence: CheckContext) -> tuple[str, ...]:
    """Return a remark for rates that have no counterpart."""
    compared = {vector.name for motion in evidence.motions for vector in motion.vectors}
    return tuple(
        f"The unit and axes of '{sensor.rates.name}' cannot be judged: no changing attitude to "
        'compare with.'
        for sensor in evidence.inertials
        if sensor.rates is not None and sensor.rates.name not in compared
    )


def find_unit_by_height(pose: PoseSeries, channel: Channel) -> Iterator[QualityFinding]:
    """Yield a downward range or an air pressure whose size follows the height in another unit."""
    is_range = channel.field == 'range'
    if pose.position is None or not (is_range or roles.PRESSURE.match(channel.field)):
        return
    time, values = sort_samples(channel.time, channel.values[:, None]).select_complete()
    if len(time) < limits.LEAST_SAMPLES or len(pose.position.time) < limits.LEAST_SAMPLES:
        return
    # Pressure falls with height
    measured = VectorSeries('', time, values if is_range else -values / PRESSURE_PER_METRE)
    at = pose.position.time
    left, right = measured.interpolate(at), pose.position.values[:, 2:]
    fit = fit_scale(left - np.nanmean(left), right - np.nanmean(right), at)
    if np.std(right) > limits.HEIGHT_MOTION and fit.share > CORRELATED:
        kind = 'range' if is_range else 'pressure'
        span = float(at[0]), float(at[-1])
        yield from name_factor(kind, channel.name, pose.position.name, fit.ratio, span)


def find_unit_by_size(channel: Channel) -> Iterator[QualityFinding]:
    """Yield a channel whose size fits another unit."""
    for size in SIZE_RULES:
        values = channel.values[np.isfinite(channel.values)]
        if not size.names.search(channel.name) or len(values) < 10:
            continue
        typical = size.of(values)
        # Some corrupt commands are no other unit: in one, most would be above what a duty can be
        busy = np.abs(values[values != 0.0])
        if size.most and len(busy) and float(np.median(busy)) <= size.units[0][0]:
            continue
        if size.most and _stand_alone(np.abs(values) > size.units[0][0]):
            continue
        for low, high, unit in size.units:
            if low <= typical <= high:
                yield QualityFinding(
                    KIND, channel.name, float(channel.time[0]), float(channel.time[-1]),
                    f'The unit looks like {unit} (typical value {typical:.4g}), but should be '
                    f'{channel.unit or "SI"}.',
                    Severity.SUSPICIOUS, {'size': typical},
                )  # fmt: skip
                break


def _stand_alone(large: NDArray[np.bool_]) -> bool:
    """Return whether most large values stand between small ones, as corrupt ones do."""
    return float(np.sum(large[1:] & large[:-1])) < 0.5 * float(np.sum(large))


def find_unit_by_gravity(
    name: str, time: NDArray[np.float64], force: NDArray[np.float64]
) -> Iterator[QualityFinding]:
    """Yield an accelerometer that measures gravity in another unit."""
    felt = float(np.median(np.linalg.norm(force, axis=1)))
    if (unit := find_gravity_unit(felt)) not in ('', 'm/s2'):
        yield QualityFinding(
            KIND, name, float(time[0]), float(time[-1]),
            f'The unit looks like {unit}: the median acceleration with gravity is '
            f'{felt:.4g}, but in m/s2 it would be about 9.81.',
            Severity.SUSPICIOUS, {'force': felt},
        )  # fmt: skip

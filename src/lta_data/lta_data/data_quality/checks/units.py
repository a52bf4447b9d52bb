"""
Detect wrong units: degrees for radians, mm for m, g for m/s2.

A wrong unit shows as a factor between two sources of a motion, or as a size that the quantity
never has in its own unit but always in another.
"""

from collections.abc import Callable, Iterator
import re
from typing import Final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits
from lta_data.data_quality.finding import (
    CheckVerdict,
    QualityFinding,
    select_first_findings,
    Severity,
)
from lta_data.data_quality.motion_pairs import MotionPair, PairSimilarity
from lta_data.data_quality.recording import CheckContext
import numpy as np
from numpy.typing import NDArray

KIND = 'unit'
DEGREES: Final = 180.0 / np.pi
# Ratio of measured to derived values -> unit of the sensor.
FACTORS: Final[dict[str, dict[float, str]]] = {
    'rates': {DEGREES: 'deg/s', 1000.0: 'mrad/s'},
    'velocity': {1000.0: 'mm/s', 100.0: 'cm/s', 3.6: 'km/h'},
    'force': {1.0 / STANDARD_GRAVITY: 'g', 1000.0: 'mm/s2', 1000.0 / STANDARD_GRAVITY: 'mg'},
    'range': {1000.0: 'mm', 100.0: 'cm'},
    'pressure': {0.01: 'hPa', 0.001: 'kPa'},
}
# The same ratio -> unit of the pose, if that is wrong.
TURNED: Final[dict[str, dict[float, str]]] = {
    'velocity': {0.001: 'mm', 0.01: 'cm'},
    'range': {0.001: 'mm', 0.01: 'cm'},
    'pressure': {0.001: 'mm'},
    'rates': {1.0 / DEGREES: 'deg'},
}


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


SIZES: Final = (
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
    for pair, likeness in evidence.pair_similarities:
        if likeness is not None:
            findings += find_unit_by_pair(pair, likeness)
    for channel in evidence.recording.channels.values():
        findings += find_unit_by_size(channel)
    for sensor in evidence.inertials:
        if sensor.force is not None:
            findings += find_unit_by_gravity(
                sensor.force.name, sensor.force.time, sensor.force.values
            )
    return CheckVerdict(select_first_findings(findings), describe_unpaired_rates(evidence))


def describe_unpaired_rates(evidence: CheckContext) -> tuple[str, ...]:
    """Return a remark for rates that have no counterpart."""
    compared = {
        pair.sensor for pair, likeness in evidence.pair_similarities if likeness is not None
    }
    return tuple(
        f"The unit and axes of '{sensor.rates.name}' cannot be judged: no changing attitude to "
        'compare with.'
        for sensor in evidence.inertials
        if sensor.rates is not None and sensor.rates.name not in compared
    )


def find_unit_by_pair(pair: MotionPair, likeness: PairSimilarity) -> Iterator[QualityFinding]:
    """Yield the factor between the sides of a pair if it is that of a unit."""
    # All axes against all: swapped axes do not hide a wrong unit
    alike = np.abs(likeness.correlation) * likeness.moving[None, :]
    rows, columns = np.nonzero(alike >= limits.AGREE)
    if len(rows) == 0:
        return
    # A wrong unit has the same factor on all axes
    ratio = float(np.median(likeness.ratio[rows, columns]))
    for table, name in ((FACTORS, pair.sensor), (TURNED, pair.reference)):
        for factor, unit in table.get(pair.what, {}).items():
            if abs(ratio / factor - 1.0) <= limits.FACTOR_SPREAD:
                other = pair.reference if name == pair.sensor else pair.sensor
                begin, end = pair.span
                yield QualityFinding(
                    KIND, name, begin, end,
                    f'The unit looks like {unit}: the motion is {ratio:.4g} times that '
                    f"expected from '{other}'."
                    if name == pair.sensor
                    else f"The unit looks like {unit}: '{other}' moves {ratio:.4g} times as much.",
                    Severity.SUSPICIOUS, {'factor': ratio},
                )  # fmt: skip
                return


def find_unit_by_size(channel: SignalChannel) -> Iterator[QualityFinding]:
    """Yield a channel whose size fits another unit."""
    for size in SIZES:
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
    for factor, unit in FACTORS['force'].items():
        # 30 %: a slow airship accelerates little compared with gravity.
        if abs(felt / STANDARD_GRAVITY / factor - 1.0) <= 0.3:
            yield QualityFinding(
                KIND, name, float(time[0]), float(time[-1]),
                f'The unit looks like {unit}: the median acceleration with gravity is '
                f'{felt:.4g}, but in m/s2 it would be about 9.81.',
                Severity.SUSPICIOUS, {'force': felt},
            )  # fmt: skip
            return

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Represent columns that belong together: a vector, a quaternion, Euler angles or a matrix."""

from collections.abc import Mapping
from typing import Final, final, NamedTuple

from lta_data.importers.axes import LocalMap
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.column_names import parse_column_name
import numpy as np

ATTITUDES: Final = ('quaternion', 'matrix', 'euler')  # kinds of groups
GEODETIC: Final = ('lat', 'lon', 'alt')
# Factors of a fix to degrees and metres, by the unit of its altitude
FIX_SCALES: Final = {
    'm': (1.0, 1.0, 1.0), 'mm': (1e-7, 1e-7, 1e-3), 'rad': (180.0 / np.pi, 180.0 / np.pi, 1.0),
}  # fmt: skip
COMMON_LENGTH_SHARE: Final = 0.9  # of the quaternions of a log that have one length
UNIT_NORM: Final = 0.02  # largest median deviation of the length of a quaternion
Columns = Mapping[str, Numbers]


@final
class ColumnGroup(NamedTuple):
    """Columns that belong together."""

    # 'position', 'velocity', 'rates', 'acceleration', 'force', 'torque' or one of ATTITUDES
    kind: str
    role: str  # 'truth', 'estimate', 'setpoint', or '' if the names do not say
    # x, y, z; of a quaternion as the log has them; of Euler angles roll, pitch, yaw, or yaw alone;
    # of force and torque those that the log has
    columns: tuple[str, ...]
    axes: tuple[str, ...]  # the axis in the name of each
    unit: str  # as in the names, '' if they do not say
    reason: str  # why it has this kind
    rise: float = 1.0  # factor of the third column to the unit of the others: an altitude in feet

    @property
    def is_geodetic(self) -> bool:
        """Whether a position is in latitude, longitude and altitude."""
        return self.axes == GEODETIC

    @property
    def stem_words(self) -> frozenset[str]:
        """Return the words in the names of its columns, without axes and units."""
        return frozenset(word for one in self.columns for word in parse_column_name(one).stem)

    @property
    def words(self) -> frozenset[str]:
        """Return the same, also without an index at their end."""
        return frozenset(word for one in self.columns for word in parse_column_name(one).words)

    def stack(self, table: Columns) -> Numbers:
        """Return the numbers, shape (n, columns); a latitude becomes a place in metres."""
        rows = np.stack([table[name] for name in self.columns], axis=1).astype(np.float64)
        if self.rise != 1.0:
            rows *= [1.0, 1.0, self.rise]
        if self.is_geodetic:
            return LocalMap().project(rows * np.array(FIX_SCALES[self.unit]))
        return rows


def find_turn(angles: Numbers) -> str:
    """Return the unit of angles that jump by a full turn, 'rad' or 'deg'; '' without a jump."""
    for unit, turn in (('rad', 2.0 * np.pi), ('deg', 360.0)):
        for one in np.atleast_2d(np.asarray(angles, dtype=np.float64).T):
            finite = one[np.isfinite(one)]
            if not len(finite) or np.ptp(finite) > 1.01 * turn:
                continue
            if (np.abs(np.diff(finite)) > 0.8 * turn).any():
                return unit
    return ''


def measure_length(rows: Numbers) -> float:
    """Return the length of logged quaternions; 1 where they have it, or none in common."""
    lengths = np.linalg.norm(rows, axis=1)
    lengths = lengths[np.isfinite(lengths) & (lengths > 0.0)]
    usual = float(np.median(lengths)) if len(lengths) else 1.0
    alike = np.abs(lengths / usual - 1.0) < UNIT_NORM
    is_other = abs(usual - 1.0) > UNIT_NORM and len(lengths) and alike.mean() > COMMON_LENGTH_SHARE
    return float(f'{usual:.6g}') if is_other else 1.0


def has_unit_length(rows: Numbers) -> bool:
    """Return whether rows are quaternions: of length one, and not one of four alone."""
    length = np.linalg.norm(rows, axis=1)
    good = np.isfinite(length)
    return bool(good.any() and float(np.median(np.abs(length[good] - 1.0))) < UNIT_NORM)


def is_rotation(rows: Numbers) -> bool:
    """Return whether nine numbers in each row are those of a rotation matrix."""
    finite = rows[np.isfinite(rows).all(axis=1)].astype(np.float64).reshape(-1, 3, 3)
    apart = np.abs(finite @ finite.mT - np.eye(3)).max(axis=(1, 2), initial=0.0)
    return bool(len(finite) and np.median(apart) < UNIT_NORM)

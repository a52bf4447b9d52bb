# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
View topics of a flight as pandas tables, one by one or on one clock.

The index is the time since the start of the flight, `stamp_ns` the stamp, and `attrs['units']` the
unit of each column. Yaw, pitch and roll follow each quaternion. On a common clock a column has the
latest value before each instant, which is what an onboard program would know, or is interpolated;
quaternions take the shorter way round. Integers, flags and texts always have the latest value.
Gaps are never bridged: columns are empty where no message is near enough.

A rule names a message type and one of its fields. It applies to everything inside the field unless
a deeper rule overrides it. REP-103 defines the units; topics of LTA that use a general type for
another quantity are in `OF_TOPIC`.
"""

from collections.abc import Mapping, Sequence
from functools import cache
import re
from typing import Any, Final

from lta_bag.schemas import load_jazzy_types
from lta_config.errors import BadInput, unknown_name_error
from lta_config.message_files import read_field_units
from lta_data.bag.columns import Columns, LAMP_PEAKS, name_column
from lta_data.even_grid import BRIDGED_PERIODS, check_time_span
from lta_model.attitude import to_euler_angles
import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype
from scipy.spatial.transform import Rotation

DIMENSIONLESS: Final = '1'
UNKNOWN_UNIT: Final = ''
UNIT_RULES: Final = {
    'builtin_interfaces/msg/Time': {'sec': 's', 'nanosec': 'ns'},
    'builtin_interfaces/msg/Duration': {'sec': 's', 'nanosec': 'ns'},
    'geometry_msgs/msg/Pose': {'position': 'm', 'orientation': DIMENSIONLESS},
    'geometry_msgs/msg/PointStamped': {'point': 'm'},
    'geometry_msgs/msg/QuaternionStamped': {'quaternion': DIMENSIONLESS},
    'geometry_msgs/msg/Transform': {'translation': 'm', 'rotation': DIMENSIONLESS},
    'geometry_msgs/msg/Twist': {'linear': 'm/s', 'angular': 'rad/s'},
    'geometry_msgs/msg/Accel': {'linear': 'm/s2', 'angular': 'rad/s2'},
    'geometry_msgs/msg/Wrench': {'force': 'N', 'torque': 'N m'},
    'sensor_msgs/msg/Imu': {
        'orientation': DIMENSIONLESS,
        'orientation_covariance': 'rad2',
        'angular_velocity': 'rad/s',
        'angular_velocity_covariance': 'rad2/s2',
        'linear_acceleration': 'm/s2',
        'linear_acceleration_covariance': 'm2/s4',
    },
    'sensor_msgs/msg/Range': {
        'field_of_view': 'rad',
        'min_range': 'm',
        'max_range': 'm',
        'range': 'm',
        'variance': 'm2',
    },
    'sensor_msgs/msg/FluidPressure': {'fluid_pressure': 'Pa', 'variance': 'Pa2'},
    'sensor_msgs/msg/Illuminance': {'illuminance': 'lx', 'variance': 'lx2'},
    'sensor_msgs/msg/Temperature': {'temperature': 'degC', 'variance': 'degC2'},
    'sensor_msgs/msg/RelativeHumidity': {
        'relative_humidity': DIMENSIONLESS,
        'variance': DIMENSIONLESS,
    },
    'sensor_msgs/msg/MagneticField': {'magnetic_field': 'T', 'magnetic_field_covariance': 'T2'},
    'sensor_msgs/msg/NavSatFix': {
        'latitude': 'deg',
        'longitude': 'deg',
        'altitude': 'm',
        'position_covariance': 'm2',
    },
    'sensor_msgs/msg/BatteryState': {
        'voltage': 'V',
        'temperature': 'degC',
        'current': 'A',
        'charge': 'A h',
        'capacity': 'A h',
        'design_capacity': 'A h',
        'percentage': DIMENSIONLESS,
        'cell_voltage': 'V',
        'cell_temperature': 'degC',
    },
    # For revolute joints; OF_TOPIC overrides it.
    'sensor_msgs/msg/JointState': {'position': 'rad', 'velocity': 'rad/s', 'effort': 'N m'},
    'sensor_msgs/msg/Joy': {'axes': DIMENSIONLESS, 'buttons': DIMENSIONLESS},
    'std_msgs/msg/ColorRGBA': {
        'r': DIMENSIONLESS,
        'g': DIMENSIONLESS,
        'b': DIMENSIONLESS,
        'a': DIMENSIONLESS,
    },
    'visualization_msgs/msg/Marker': {'scale': 'm', 'points': 'm'},
    'visualization_msgs/msg/UVCoordinate': {'u': DIMENSIONLESS, 'v': DIMENSIONLESS},
}
MATRICES: Final = {  # 6 x 6 covariances of three linear, then three angular components
    'geometry_msgs/msg/PoseWithCovariance': ('m2', 'm rad', 'rad2'),
    'geometry_msgs/msg/TwistWithCovariance': ('m2/s2', 'm rad/s2', 'rad2/s2'),
    'geometry_msgs/msg/AccelWithCovariance': ('m2/s4', 'm rad/s4', 'rad2/s4'),
}
OF_TOPIC: Final = {  # by relative name; overrides the message type
    'motors': {'effort': DIMENSIONLESS, 'position': 'm', 'velocity': 'm/s'},
    'wind': {'vector': 'm/s'},
    'light/bearing': {'vector': DIMENSIONLESS},
    'light/peaks': {
        'amplitude': 'ADC counts',
        'snr': DIMENSIONLESS,
        'frequency': 'Hz',
        'x': DIMENSIONLESS,
        'y': DIMENSIONLESS,
    }
    | {'z': DIMENSIONLESS},
}
_INDEX: Final = re.compile(r'\[(\d+)\]$')


def find_unit(type_name: str, path: str, topic: str = '') -> str:
    """
    Return the unit of a field in REP-103 notation ('m/s2').

    '1' for a dimensionless number, '' if unknown. `path` is that of the field:
    'pose.pose.position.x', 'effort[0]'; `topic` is the relative name, if known.
    """
    own = OF_TOPIC.get(topic, {}).get(_INDEX.sub('', path.split('.')[0]))
    return _find_type_unit(type_name, path) if own is None else own


@cache
def _collect_rules() -> dict[str, Mapping[str, str]]:
    """Return the rules by type, with those of lta_msgs from the comments of its definitions."""
    own = {
        # By the names of the columns as well
        kind: {**units, **{name_column(kind, field): unit for field, unit in units.items()}}
        for kind, units in read_field_units().items()
    }
    return {**UNIT_RULES, **own}


@cache
def _find_type_unit(type_name: str, path: str) -> str:
    """Return the unit of a field by its message type."""
    unit, kind = UNKNOWN_UNIT, type_name
    for part in path.split('.'):
        index = _INDEX.search(part)
        field = _INDEX.sub('', part)
        if kind in MATRICES and field == 'covariance' and index is not None:
            return _find_covariance_unit(MATRICES[kind], int(index.group(1)))
        unit = _collect_rules().get(kind, {}).get(field, unit)
        kind = _find_field_type(kind, field)
    return unit


def _find_covariance_unit(units: tuple[str, str, str], index: int) -> str:
    """Return the unit of an element of a row-major 6 x 6 covariance."""
    row, column = divmod(index, 6)
    return units[(row > 2) + (column > 2)]


@cache
def _find_field_type(kind: str, field: str) -> str:
    """Return the message type of a field; '' if it is not a message."""
    _, fields = load_jazzy_types().fielddefs.get(kind, ([], []))
    for name, field_type in fields:
        if name == field:
            item = (
                field_type[1][0]
                if field_type[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE)
                else field_type
            )
            return str(item[1]) if item[0] is Nodetype.NAME else ''
    return ''


TIME_INDEX: Final = 'time'
STAMP_COLUMN: Final = 'stamp_ns'
FIXED_UNITS: Final = {STAMP_COLUMN: 'ns', TIME_INDEX: 's'}
QUATERNION_AXES: Final = ('x', 'y', 'z', 'w')
EULER_PARTS: Final = ('yaw', 'pitch', 'roll')
ALIGN_METHODS: Final = ('linear', 'previous')
DENSE: Final = 20.0  # rows of an even clock per message of the longest topic, at most
# Columns without use on another clock
OWN_COLUMNS: Final = re.compile(r'^(clock|stamp)\.|^stamp_ns$|(^|/|\.)header\.|covariance($|\[|/)')
NAMED_ELEMENT: Final = re.compile(r'(\w+)\[(\d+)\]')

Stamps = NDArray[np.int64]
Table = Any  # a pandas.DataFrame; pandas has no types


def name_columns(
    numbers: Columns, texts: Columns, kind: str, topic: str
) -> tuple[Columns, dict[str, str]]:
    """
    Return the columns of a topic, with the angles of quaternions, and their units.

    'effort[0]' is 'effort.left' if all messages name their element 0 'left'.
    """
    joints = name_joints(numbers, texts)
    columns = {joints.get(path, path): values for path, values in numbers.items()}
    units = {joints.get(path, path): find_unit(kind, path, topic) for path in numbers}
    columns, units = _add_angles(columns | texts, units)
    return columns, {name: unit for name, unit in units.items() if unit}


def name_joints(numbers: Columns, texts: Columns) -> dict[str, str]:
    """Return the names of elements by their paths; none if two would have one name."""
    joints = {}
    for path in numbers:
        element = NAMED_ELEMENT.fullmatch(path)
        names = texts.get(f'name[{element[2]}]') if element else None
        if element and names is not None and len(names) and names[0] and (names == names[0]).all():
            joints[path] = f'{element[1]}.{names[0]}'
    return joints if len({*joints.values()}) == len(joints) else {}


def name_point_columns(
    fields: Mapping[str, NDArray[np.float64]], topic: str
) -> tuple[Columns, dict[str, str]]:
    """Return the columns of lamp peaks, 'snr[0]' of the first point, and their units."""
    columns = {
        f'{field}[{index}]': column
        for field, rows in fields.items()
        for index, column in enumerate(rows.T)
    }
    units = {name: find_unit(LAMP_PEAKS, name.partition('[')[0], topic) for name in columns}
    return columns, units


def _add_angles(columns: Columns, units: Mapping[str, str]) -> tuple[Columns, dict[str, str]]:
    """Return columns and units with yaw, pitch and roll behind each quaternion."""
    every: Columns = {}
    added = dict(units)
    for name, values in columns.items():
        every[name] = values
        turn, _, axis = name.rpartition('.')
        if axis == 'w' and all(f'{turn}.{one}' in columns for one in QUATERNION_AXES):
            rows = np.stack([columns[f'{turn}.{one}'] for one in QUATERNION_AXES], axis=1)
            for angle, numbers in zip(
                EULER_PARTS, to_euler_angles(rows.astype(float)), strict=True
            ):
                every[f'{turn}.{angle}'] = numbers
                added[f'{turn}.{angle}'] = 'rad'
    return every, added


def build_table(
    topic: str, start: int, stamps: Stamps, columns: Columns, units: Mapping[str, str]
) -> Table:
    """Return columns over time as a `pandas.DataFrame`; `start` is the stamp at time 0 [ns]."""
    import pandas  # half a second, which most commands do not need

    # Subtract as integers first: float64 does not resolve 1 ns in times since 1970
    index = pandas.Index((stamps - start).astype(np.float64) * 1e-9, name=TIME_INDEX)
    table = pandas.DataFrame({STAMP_COLUMN: stamps, **columns}, index=index)
    table.attrs = {'topic': topic, 'start': start, 'units': FIXED_UNITS | dict(units)}
    return table


def get_column(table: Table, name: str) -> NDArray[Any]:
    """Return a column of a topic; raise `BadInput` with the known ones if there is none."""
    if name not in table:
        raise unknown_name_error(f'column of {table.attrs["topic"]}', name, [*table])
    values: NDArray[Any] = table[name].to_numpy()
    return values


def stack_components(table: Table, path: str) -> NDArray[np.float64]:
    """
    Return x, y, z and, if present, w of a field, shape (n, 3) or (n, 4); errors as `get_column`.

    `path` is, for example, 'pose.pose.position' or 'pose.pose.orientation'.
    """
    axes = QUATERNION_AXES if f'{path}.w' in table else QUATERNION_AXES[:3]
    parts = [get_column(table, f'{path}.{axis}') for axis in axes]
    return np.stack(parts, axis=1).astype(np.float64)


def group_points(table: Table) -> dict[str, NDArray[np.float64]]:
    """Return the fields of a table of lamp peaks, each of shape (n, points)."""
    fields = dict.fromkeys(name.partition('[')[0] for name in table if name.endswith(']'))
    return {field: table.filter(regex=rf'^{field}\[').to_numpy() for field in fields}


def align_tables(
    tables: Sequence[Table], clock: Stamps, method: str = 'previous', gap: float | None = None
) -> Table:
    """
    Return tables of one flight as one on another clock.

    Parameters
    ----------
    tables : sequence of pandas.DataFrame
        As `build_table` returns them.
    clock : ndarray of int64, shape (n,)
        Stamps of the new rows, in order. [ns]
    method : str
        'previous' or 'linear'.
    gap : float, optional
        Maximum gap of a topic; three of its median periods by default. [s]

    Returns
    -------
    pandas.DataFrame
        Columns named 'odom/pose.pose.position.x', without headers and covariances. NaN, or ''
        for texts, in gaps.

    Raises
    ------
    BadInput
        If the method is unknown, or the gap is not above zero.

    """
    if method not in ALIGN_METHODS:
        raise unknown_name_error('method', method, [*ALIGN_METHODS])
    if gap is not None and not _is_within(gap, np.inf):
        raise BadInput(
            f'The maximum gap is {gap!r}, but must be a number above 0; give it in seconds.'
        )
    columns: Columns = {}
    units: dict[str, str] = {}
    for table in tables:
        topic = table.attrs['topic']
        for name, values in _resample(table, clock, method == 'linear', gap).items():
            columns[f'{topic}/{name}'] = values
            units[f'{topic}/{name}'] = table.attrs['units'].get(name, '')
    name = ' + '.join(table.attrs['topic'] for table in tables)
    return build_table(name, tables[0].attrs['start'], clock, *_add_angles(columns, units))


def sort_stamps(table: Table) -> tuple[Stamps, NDArray[np.intp]]:
    """Return stamps in order, and the row of each: the last one of equal stamps."""
    stamps = table[STAMP_COLUMN].to_numpy()
    order = np.argsort(stamps, kind='stable')
    last = np.append(np.diff(stamps[order]) > 0, True)[: len(order)]
    return stamps[order][last], order[last]


def _is_within(value: object, most: float) -> bool:
    """Return whether a value is a number above 0 and at most `most`."""
    return isinstance(value, int | float | np.number) and bool(0.0 < value <= most)


def build_even_clock(tables: Sequence[Table], rate: float) -> Stamps:
    """Return an even clock over all rows of some tables; rate in Hz [ns]."""
    if not _is_within(rate, 1e6):
        raise BadInput(
            f'The rate is {rate!r}, but must be a number above 0 and at most 1e6; give it in Hz.'
        )
    times = [table.index for table in tables if len(table)]
    if not times:
        return np.empty(0, np.int64)
    first, last = min(time.min() for time in times), max(time.max() for time in times)
    check_time_span('', last - first, 1.0 / rate, max(map(len, times)), DENSE, 'give a lower rate')
    # The tolerance keeps end points that are off by rounding.
    steps = np.arange(np.ceil(first * rate - 1e-6), np.floor(last * rate + 1e-6) + 1)
    start: int = tables[0].attrs['start']
    return start + np.rint(steps * (1e9 / rate)).astype(np.int64)


def _resample(table: Table, clock: Stamps, linear: bool, gap: float | None) -> Columns:
    """Return the columns of a table at other times, without angles; empty in gaps."""
    angles = {name for name in table if name.rpartition('.')[2] in EULER_PARTS
              and f'{name.rpartition(".")[0]}.w' in table}  # fmt: skip
    names = [name for name in table if name not in angles and not OWN_COLUMNS.search(name)]
    if not len(table):
        return {
            name: np.full(len(clock), '' if _is_text(table[name].to_numpy()) else np.nan)
            for name in names
        }
    stamps, rows = sort_stamps(table)
    usual = float(np.median(np.diff(stamps))) if len(stamps) > 1 else np.inf
    most = BRIDGED_PERIODS * usual if gap is None else gap * 1e9
    at = np.searchsorted(stamps, clock, side='right') - 1
    is_there, at = at >= 0, np.maximum(at, 0)
    share = np.zeros(len(clock))
    after = at
    if linear:
        after = np.where(stamps[at] == clock, at, np.minimum(at + 1, len(stamps) - 1))
        apart = stamps[after] - stamps[at]
        is_there &= (stamps[at] == clock) | ((after > at) & (apart <= most))
        share = np.where(is_there, (clock - stamps[at]) / np.maximum(apart, 1), 0.0)
    else:
        is_there &= clock - stamps[at] <= most
    columns: Columns = {}
    between = share > 0.0
    for name in names:
        values = table[name].to_numpy()[rows]
        columns[name] = values[at]
        # Only floats are interpolated: integers are counts or codes, texts have no mean
        if values.dtype.kind == 'f':
            change = values[after[between]] - values[at[between]]
            columns[name][between] += share[between] * change
    for turn in {name.rpartition('.')[0] for name in angles}:
        quaternions = np.stack(
            [table[f'{turn}.{axis}'].to_numpy()[rows] for axis in QUATERNION_AXES], axis=1
        )
        turned = _turn_between(quaternions[at[between]], quaternions[after[between]],
                               share[between])  # fmt: skip
        for axis, numbers in zip(QUATERNION_AXES, turned.T, strict=True):
            columns[f'{turn}.{axis}'][between] = numbers
    return columns if is_there.all() else {
        name: np.where(is_there, values, '' if _is_text(values) else np.nan)
        for name, values in columns.items()
    }  # fmt: skip


def _is_text(values: NDArray[Any]) -> bool:
    return values.dtype.kind in 'UO'


def _turn_between(
    first: NDArray[np.float64], last: NDArray[np.float64], share: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return quaternions on the shorter arc between others; NaN beside one that is not filled."""
    turned = np.full(first.shape, np.nan)
    lengths = np.linalg.norm(first, axis=1) * np.linalg.norm(last, axis=1)
    good = np.isfinite(lengths) & (lengths > 0.0)
    if good.any():
        one, other = Rotation.from_quat(first[good]), Rotation.from_quat(last[good])
        arc = share[good, None] * (one.inv() * other).as_rotvec()
        numbers = (one * Rotation.from_rotvec(arc)).as_quat()
        # q and -q are one attitude: take the nearer one
        turned[good] = (
            numbers * np.where((numbers * first[good]).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
        )
    return turned

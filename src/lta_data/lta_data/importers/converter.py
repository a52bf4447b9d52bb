# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert rows of a log to messages of one topic: units, axes and fields."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.quantity import SI_UNITS
from lta_config.schema.import_file import AppliedForce, OrientationField, ScalarField, VectorField
from lta_data.importers.axes import (
    compute_quaternions,
    convert_attitude,
    convert_to_lta_axes,
    LocalMap,
    rotate_into_body,
)
from lta_data.importers.entry_plan import (
    CdrTemplate,
    CHILD_FRAMES,
    EntryPlan,
    JOINT_DIMENSIONS,
    JOINTS,
    MessagePart,
)
from lta_data.importers.protocol import encode_label, LogTable, Numbers, Times
import numpy as np

UNKNOWN_COVARIANCE = -1.0  # first covariance element of an unknown quantity, as in sensor_msgs/Imu
STAMP_END = 2**31 * 1_000_000_000  # ROS counts the seconds of a stamp in 32 bits [ns]
CONSTANT_FIELDS = {  # constant fields by message type
    'sensor_msgs/msg/BatteryState': {'present': 1},
    'sensor_msgs/msg/Range': {'radiation_type': 1},  # infrared, as all sensors on this topic
}
HELD_TOPICS = ('motors', 'wrench_command', 'setpoint/', 'cmd_vel')  # the newest value is held
NOBODY = {'sensor_msgs/msg/BatteryState': ('design_capacity',)}  # NaN, since no log has it


class ValueOutOfBounds(BadInput):
    """A value of the log is outside the bounds that the mapping gives."""


@final
class ConvertedMessages(NamedTuple):
    """
    Messages of one topic.

    `order` and `log_times` have one number per message, `data` their bytes, `size` each, and
    `rows` the rows of the table that they come from.
    """

    topic: str
    order: Times
    log_times: Times
    data: bytes
    size: int
    rows: Times


@final
class TopicConverter:
    """
    Converts tables to the messages of one topic.

    Attributes
    ----------
    without : int
        Rows left out because no cell of the topic's columns has a number, or, of a command, all
        are empty.
    excluded : int
        Rows left out by the mapping's `where`.
    silent : list of str
        Actuators left out because they have no values.

    """

    def __init__(self, plan: EntryPlan) -> None:
        self.plan = plan
        self.without = self.excluded = 0
        self.silent: list[str] = []
        self._map = LocalMap()

    def convert(self, table: LogTable) -> ConvertedMessages:
        """
        Convert the rows of a table.

        Raise `BadInput` if a time cannot be a stamp, or a value is outside the mapping's bounds.
        """
        rows = self._find_rows(table)
        row_indices = np.flatnonzero(rows)
        chosen = table.select_rows(rows)
        if self.plan.entry.stamps == 'log':
            chosen = replace(chosen, stamps=chosen.log_times)
        _check_stamps(chosen, self.plan.topic)
        numbers: dict[str, Any] = {
            'header.stamp.sec': chosen.stamps // 1_000_000_000,
            'header.stamp.nanosec': chosen.stamps % 1_000_000_000,
        } | self.compute_numbers(chosen)
        layout = self._build_layout()
        data = layout.serialize_messages(len(chosen), numbers)
        # log_times keep the order of logging; the stamps are in the messages.
        order, times = chosen.order, chosen.log_times
        return ConvertedMessages(self.plan.topic, order, times, data, layout.size, row_indices)

    def compute_numbers(self, table: LogTable) -> dict[str, Any]:
        """Return the numbers of the messages by path: one for each row, or one for all."""
        if self.plan.target.type_name == JOINTS:
            return self._convert_joints(table)
        return self._convert_message_parts(table)

    def select_rows(self, table: LogTable) -> LogTable:
        """Return the rows that become messages."""
        return table.select_rows(self._find_rows(table))

    def _find_rows(self, table: LogTable) -> Any:
        """Return which rows become messages."""
        entry = self.plan.entry
        fits = np.ones(len(table), dtype=np.bool_)
        for name, value in entry.where.items():
            number = encode_label(value) if isinstance(value, str) else value
            fits &= table.columns[name] == number
        self.excluded += int((~fits).sum())
        columns = [name for name in entry.columns if name not in entry.where]
        if not columns:
            return fits
        # Rows without any value: logs with several rates leave the other columns empty. A command
        # that is NaN, as that of PX4's motors at rest, ends the one before it
        none = np.zeros(len(table), dtype=np.bool_)
        is_command = entry.topic.startswith(HELD_TOPICS)
        nothing = np.logical_and.reduce([
            table.empty.get(name, none) if is_command else np.isnan(table.columns[name])
            for name in columns
        ])  # fmt: skip
        self.without += int((nothing & fits).sum())
        return fits & ~nothing

    def _build_layout(self) -> CdrTemplate:
        """Return the template of the messages, once the actuators are known."""
        type_name, frame = self.plan.target
        constants: dict[str, Any] = {'header.frame_id': frame, **CHILD_FRAMES.get(type_name, {})}
        constants |= CONSTANT_FIELDS.get(type_name, {})
        constants |= dict.fromkeys(NOBODY.get(type_name, ()), np.nan)
        names = self._list_actuators()
        fields = {field for name, field, _ in self.plan.iterate_joints() if name in names}
        fields |= {'effort' for name in self.plan.thrust_laws if name in names}
        lengths = {field: len(names) for field in fields}
        if names:
            constants['name'] = names
        return CdrTemplate(type_name, constants, lengths)

    def _list_actuators(self) -> list[str]:
        return [name for name in self.plan.entry.actuators or {} if name not in self.silent]

    def _convert_joints(self, table: LogTable) -> dict[str, Any]:
        """Return the numbers of the actuators; fields without a source are NaN."""
        joint_values = {
            (name, field): _convert_number(scalar, table, 1.0)
            for name, field, scalar in self.plan.iterate_joints()
        }
        for name, (c0, c1, c2) in self.plan.thrust_laws.items():
            speed = joint_values[name, 'velocity']
            joint_values[name, 'effort'] = c0 + c1 * speed + c2 * speed * np.abs(speed)
        if self.plan.entry.drop_empty:
            valued = {
                name for (name, _), values in joint_values.items() if not np.isnan(values).all()
            }
            self.silent = [name for name in self._list_actuators() if name not in valued]
        names = self._list_actuators()
        fields = {field for name, field in joint_values if name in names}
        return {
            f'{field}[{index}]': joint_values.get((name, field), np.nan)
            for field in JOINT_DIMENSIONS
            if field in fields
            for index, name in enumerate(names)
        }

    def _convert_message_parts(self, table: LogTable) -> dict[str, Any]:
        """Return the numbers of a message by path."""
        plan, parts = self.plan, self.plan.entry.parts
        numbers: dict[str, Any] = {}
        attitude = None
        if plan.entry.orientation is not None:
            theirs = compute_quaternions(plan.entry.orientation, table)
            attitude = convert_attitude(theirs, plan.world, plan.body)
        for name, part in plan.target_parts.items():
            entry = parts.get(name)
            if entry is None:
                numbers |= _fill_unknown(part)
            elif isinstance(entry, OrientationField):
                numbers |= _split_columns(part, attitude, 'xyzw')
            elif isinstance(entry, VectorField):
                values = _convert_vector(entry, part, plan, table, attitude, self._map)
                numbers |= _split_columns(part, values, 'xyz')
            else:
                numbers[part.place] = _convert_number(entry, table, part.share)
        if plan.entry.forces:
            for name, total in zip(
                ('force', 'torque'), _sum_forces(plan.entry.forces, plan, table), strict=True
            ):
                # Beside a force or torque without a point
                for path, values in _split_columns(plan.target_parts[name], total, 'xyz').items():
                    numbers[path] = values + (numbers[path] if name in parts else 0.0)
        return numbers


def _sum_forces(
    forces: Sequence[AppliedForce], plan: EntryPlan, table: LogTable
) -> tuple[Numbers, Numbers]:
    """Return force and torque about the body's origin, in LTA's axes, shape (n, 3) each."""
    part = plan.target_parts['force']
    total = np.zeros((2, len(table), 3))
    for one in forces:
        force = _convert_vector(one, part, plan, table, None, LocalMap())
        point = np.asarray([one.at.vector], dtype=np.float64)
        arm = convert_to_lta_axes(point, plan.find_axes('body'))
        total += np.stack([force, np.cross(arm, force)])
    return total[0], total[1]


def _fill_unknown(part: MessagePart) -> dict[str, Any]:
    """Return an unknown part: NaN with -1 in its covariance; an unknown attitude is zero."""
    fill: dict[str, Any] = {part.unknown: UNKNOWN_COVARIANCE} if part.unknown else {}
    if part.kind == 'number':
        return fill | {part.place: np.nan}
    if part.kind == 'attitude':
        # An all-zero quaternion marks an unset attitude.
        return fill | {f'{part.place}.{axis}': 0.0 for axis in 'xyzw'}
    return fill | {f'{part.place}.{axis}': np.nan for axis in 'xyz'}


def _split_columns(part: MessagePart, values: Numbers | None, axes: str) -> dict[str, Any]:
    """Return the columns of an array by path."""
    if values is None:
        return {}
    return {f'{part.place}.{axis}': values[:, index] for index, axis in enumerate(axes)}


def _convert_number(scalar: ScalarField, table: LogTable, share: float) -> Numbers:
    """Return one number per row, in the message's unit."""
    if scalar.value is not None or scalar.column is None:
        constant = scalar.value.si if scalar.value is not None else np.nan
        return np.full(len(table), constant * share)
    column = table.columns[scalar.column]
    return scale_column(scalar, scalar.scale, column, scalar.column) * share


def _convert_vector(
    vector: VectorField,
    part: MessagePart,
    plan: EntryPlan,
    table: LogTable,
    attitude: Numbers | None,
    local: LocalMap,
) -> Numbers:
    """Return three numbers per row, in LTA's axes."""
    frame = vector.frame or part.frame
    if vector.value is not None or vector.columns is None:
        constant = vector.value.vector if vector.value is not None else (np.nan,) * 3
        # Shape (n, 3)
        values = np.tile(np.asarray(constant, dtype=np.float64), (len(table), 1))
    else:
        # A component without a column is never commanded
        scaled_columns = [
            scale_column(vector, scale, table.columns[name], name)
            if name is not None
            else np.zeros(len(table))
            for name, scale in zip(vector.columns, vector.scales, strict=True)
        ]
        values = np.stack(scaled_columns, axis=1)
    if vector.geodetic:
        return local.project(values)
    converted = convert_to_lta_axes(values, plan.find_axes(frame), axial=part.kind == 'axial')
    # From the world frame to the body frame
    if frame != part.frame and attitude is not None:
        return rotate_into_body(converted, attitude)
    return converted


def scale_column(
    source: ScalarField | VectorField, scale: float, raw: Numbers, column: str
) -> Numbers:
    """
    Convert a column to SI: (number + offset) * scale / over, times its unit.

    Raises
    ------
    ValueOutOfBounds
        If a value is outside the bounds that the mapping gives.
    BadInput
        If a value in SI is too large for a float.

    """
    values = raw if source.missing is None else np.where(raw == source.missing, np.nan, raw)
    if source.within is not None:
        low, high = source.within
        wrong = np.flatnonzero((values < low) | (values > high))
        if len(wrong):
            raise ValueOutOfBounds(
                # Rows count from 1 in messages
                f"Column '{column}' has {values[wrong[0]]:.6g} in row {wrong[0] + 1}, but "
                f'"within" in the mapping allows {low:g} to {high:g}; choose the right column in '
                'the mapping, or correct "within".'
            )
    numbers = _apply_factors(source, scale, values)
    wrong = np.flatnonzero(np.isinf(numbers) & np.isfinite(values))
    if len(wrong):
        raise BadInput(
            f"Column '{column}' has {values[wrong[0]]:.6g} in row {wrong[0] + 1}, which "
            'is too large with "scale", "over" and "offset" of the mapping; correct these.'
        )
    return numbers


def _apply_factors(source: ScalarField | VectorField, scale: float, values: Numbers) -> Numbers:
    """Return numbers in SI; infinite where a float is too small for them."""
    factor = scale * SI_UNITS[source.unit][1]
    with np.errstate(over='ignore'):
        if source.offset:
            values = values + source.offset
        # Skipping a factor of one keeps every bit and saves a copy.
        if factor != 1.0:
            values = values * factor
        return values if source.over == 1.0 else values / source.over


def _check_stamps(table: LogTable, topic: str) -> None:
    """Raise BadInput for times that a ROS stamp cannot hold."""
    stamps: Sequence[Times] = (table.stamps, table.log_times)
    for times in stamps:
        wrong = np.flatnonzero((times < 0) | (times >= STAMP_END))
        if len(wrong):
            seconds = times[wrong[0]] * 1e-9
            raise BadInput(
                f"Row {wrong[0] + 1} of '{topic}' is at {seconds:.6g} s, outside "
                'the range of ROS time stamps; in the mapping, correct the unit of "time", or '
                'add "start" to it.'
            )

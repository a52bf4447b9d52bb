# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The mapping file of an import: how columns of a log map to fields of our topics.

It describes the log's numbers: unit, axes, attitude convention and time. It never changes them:
nothing is smoothed, resampled or invented.
"""

import math
from typing import Annotated, Literal, Self

from lta_config.files import (
    check_exactly_one,
    find_file,
    load_file,
    Name,
    SchemaVersion,
    StrictModel,
)
from lta_config.quantity import Quantity, SI_UNITS
from pydantic import ConfigDict, Field, field_validator, model_validator

Column = Annotated[str, Field(min_length=1)]
Format = Literal['csv', 'usd', 'ulog', 'bag', 'mat', 'numpy', 'parquet', 'dataflash', 'folder']
# Formats whose tables have no time of their own
TIMED_BY_MAPPING: tuple[Format, ...] = ('csv', 'mat', 'numpy', 'parquet', 'folder')
Bound = Annotated[float, Field(ge=-math.inf, allow_inf_nan=True)]  # any number but NaN
Three = Annotated[list[Column], Field(min_length=3, max_length=3)]

# Our x, y, z in terms of the log's. We use ENU for the world and FLU for the body
FIELD_AXES: dict[str, tuple[str, str, str]] = {
    'ENU': ('x', 'y', 'z'),
    'FLU': ('x', 'y', 'z'),
    'NED': ('y', 'x', '-z'),
    'FRD': ('x', '-y', '-z'),
    'NWU': ('-y', 'x', 'z'),
    'Y_UP': ('x', '-z', 'y'),  # OptiTrack, right-handed
    'OPTICAL': ('z', '-x', '-y'),  # a camera: x right, y down, z forward; to FLU
}
LAST_SECOND = 2.0**31  # s; the first time after those that a ROS time stamp can hold
NANOSECOND = 1e-9  # s; the resolution of a ROS time stamp
SOURCE_AXES = ('x', 'y', 'z', '-x', '-y', '-z')


def _parse_axes(value: object) -> tuple[str, ...]:
    """Return axes as our x, y, z in terms of the log's."""
    if isinstance(value, str):
        if value not in FIELD_AXES:
            raise ValueError(
                f'is "{value}", but must be one of {", ".join(FIELD_AXES)}, or a list such as '
                '[x, -y, -z]'
            )
        return FIELD_AXES[value]
    listed = tuple(value) if isinstance(value, list | tuple) else ()
    fits = len(listed) == 3 and all(axis in SOURCE_AXES for axis in listed)
    # The last character is the axis without its sign
    if not fits or len({str(axis)[-1] for axis in listed}) != 3:
        raise ValueError(
            'must be a list of x, y and z, each once and with an optional sign, such as [x, -y, '
            '-z]'
        )
    return tuple(str(axis) for axis in listed)


class _WithAxes(StrictModel):
    """Axes by name, or written as our x, y, z in terms of the log's: `[x, -y, -z]`."""

    world: tuple[str, ...] | None = None
    body: tuple[str, ...] | None = None

    @field_validator('world', 'body', mode='before')
    @classmethod
    def _check_axes(cls, value: object) -> tuple[str, ...] | None:
        return None if value is None else _parse_axes(value)


class _InUnit(StrictModel):
    """A number as logged: SI = (number + offset) * scale / over, in `unit`."""

    model_config = ConfigDict(allow_inf_nan=False)

    unit: str = '1'
    over: Annotated[float, Field(gt=0.0)] = 1.0
    offset: float = 0.0
    # The number that means "no value"
    missing: Annotated[float, Field(allow_inf_nan=True)] | None = None
    within: tuple[Bound, Bound] | None = None  # bounds of the logged numbers

    @field_validator('unit')
    @classmethod
    def _check_unit(cls, unit: str) -> str:
        if unit not in SI_UNITS:
            raise ValueError(
                f'is "{unit}", which is not a known unit; known: {", ".join(SI_UNITS)}'
            )
        return unit

    @field_validator('within', mode='before')
    @classmethod
    def _parse_bounds(cls, value: object) -> object:
        return tuple(value) if isinstance(value, list) else value


class ScalarField(_InUnit):
    """One number: from a column, or constant."""

    scale: float = 1.0
    column: Column | None = None
    value: Quantity | None = None

    @model_validator(mode='after')
    def _check_source(self) -> Self:
        check_exactly_one(self, 'column', 'value')
        return self


class VectorField(_InUnit):
    """
    Three numbers in the axes of `frame`; by default the frame of the message type.

    A force or torque may lack columns, which are then null: these components are zero. `scale` may
    be a list, with the factor of each column. A `geodetic` position has latitude and longitude in
    degrees and an altitude; it becomes east, north and up from its first fix.
    """

    scale: float | tuple[float, float, float] = 1.0
    columns: Annotated[list[Column | None], Field(min_length=3, max_length=3)] | None = None
    value: Quantity | None = None
    frame: Literal['world', 'body'] | None = None
    geodetic: bool = False

    @field_validator('scale', mode='before')
    @classmethod
    def _parse_scale(cls, value: object) -> object:
        return tuple(value) if isinstance(value, list) else value

    @property
    def scales(self) -> tuple[float, float, float]:
        """Return the factor of each column."""
        return self.scale if isinstance(self.scale, tuple) else (self.scale,) * 3

    @model_validator(mode='after')
    def _check_source(self) -> Self:
        check_exactly_one(self, 'columns', 'value')
        if self.columns == [None, None, None]:
            raise ValueError('has no column at all; give one, or leave the vector out')
        if self.value is not None and len(self.value.vector) != 3:
            raise ValueError(
                f'has a "value" with {len(self.value.vector)} numbers, but needs 3 (x, y and z)'
            )
        return self


class OrientationField(StrictModel):
    """
    Attitude from body to world, in one of four forms.

    `euler` has one angle per letter of `sequence`, in that order. Upper-case letters are rotations
    about the body's axes (intrinsic), lower-case ones about the world's (extrinsic).
    """

    quaternion: Annotated[list[Column], Field(min_length=4, max_length=4)] | None = None
    order: Literal['xyzw', 'wxyz'] = 'xyzw'
    # By which quaternions are divided: 1073741824 of an IMU that logs integers
    length: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = 1.0
    euler: Annotated[list[Column], Field(min_length=1, max_length=3)] | None = None
    sequence: Annotated[str, Field(pattern=r'^([XYZ]{1,3}|[xyz]{1,3})$')] = 'ZYX'
    signs: list[Literal[1, -1]] | None = None
    # Added to the angles behind their signs, in `unit`: 90 turns a compass heading into a yaw
    offsets: list[float] | None = None
    rotation_vector: Three | None = None
    matrix: Annotated[list[Column], Field(min_length=9, max_length=9)] | None = None
    unit: Literal['rad', 'deg'] = 'rad'
    direction: Literal['body to world', 'world to body'] = 'body to world'

    @model_validator(mode='after')
    def _check_form(self) -> Self:
        check_exactly_one(self, 'quaternion', 'euler', 'rotation_vector', 'matrix')
        if self.euler is None:
            return self
        if len(self.euler) != len(self.sequence):
            raise ValueError(
                f'has {len(self.euler)} columns in "euler" for the sequence {self.sequence}; give '
                'one column for each letter'
            )
        # Two rotations in a row about one axis are a single rotation
        if any(a == b for a, b in zip(self.sequence, self.sequence[1:], strict=False)):
            raise ValueError(
                f'has the sequence {self.sequence}, which turns twice in a row about the same '
                'axis; use for example ZYX'
            )
        for name, numbers in (('signs', self.signs), ('offsets', self.offsets)):
            if numbers is not None and len(numbers) != len(self.euler):
                raise ValueError(
                    f'has {len(numbers)} numbers in "{name}" for {len(self.euler)} angles in '
                    '"euler"; give one for each angle'
                )
        return self

    @property
    def forms(self) -> tuple[list[str] | None, ...]:
        """Return the four forms, exactly one of which is set."""
        return self.quaternion, self.euler, self.rotation_vector, self.matrix

    @property
    def columns(self) -> list[str]:
        """Return the columns of the form that is set."""
        return next(form for form in self.forms if form is not None)


class ActuatorFields(StrictModel):
    """
    Commands of one actuator: duty or force as effort, place of a moving mass as position.

    `thrust` is a law c0, c1, c2 that derives the effort [N] from the speed w of a rotor [rad/s]:
    c0 + c1 w + c2 w |w|.
    """

    model_config = ConfigDict(allow_inf_nan=False)

    effort: ScalarField | None = None
    position: ScalarField | None = None
    velocity: ScalarField | None = None
    thrust: tuple[float, float, float] | None = None

    @field_validator('thrust', mode='before')
    @classmethod
    def _parse_law(cls, value: object) -> object:
        return tuple(value) if isinstance(value, list) else value

    @model_validator(mode='after')
    def _check_law(self) -> Self:
        if self.thrust is not None and (self.velocity is None or self.effort is not None):
            raise ValueError(
                'has "thrust", which derives the effort from the speed of a rotor; give '
                '"velocity", and no "effort"'
            )
        return self


class AppliedForce(VectorField):
    """A force in body axes and its point of application, in the same axes of the log."""

    at: Quantity

    @model_validator(mode='after')
    def _check_point(self) -> Self:
        if len(self.at.vector) != 3 or self.at.dimension != 'm':
            raise ValueError(
                f'has a point "at" with {len(self.at.vector)} numbers in {self.at.unit}, but '
                'needs 3 (x, y and z) in a unit of length'
            )
        return self


class TimeColumn(StrictModel):
    """The time of each row of a text: a column, or uniform from the first row on."""

    column: Column | None = None
    unit: str = 's'
    fraction: Column | None = None  # added to `column`, as nanoseconds beside whole seconds
    fraction_unit: Literal['ms', 'us', 'ns'] = 'ns'
    rate: Quantity | None = None
    step: Quantity | None = None
    start: Quantity | None = None  # added to every time; ROS takes a stamp of 0 as unset
    # A table on whose clock these times are needed: the offset of each log is estimated
    align: str | None = None

    @model_validator(mode='after')
    def _check_source(self) -> Self:
        check_exactly_one(self, 'column', 'rate', 'step')
        if self.fraction is not None and self.column is None:
            raise ValueError('has "fraction" without the "column" that it is added to')
        if self.align is not None and self.start is not None:
            raise ValueError('has both "align" and "start"; give one of them')
        if SI_UNITS.get(self.unit, ('', 0.0))[0] != 's':
            raise ValueError(f'has the unit "{self.unit}", but must be in s, ms, us or ns')
        for name, quantity, unit in (('rate', self.rate, 'Hz'), ('step', self.step, 's')):
            if quantity is not None and (quantity.dimension != unit or quantity.si <= 0.0):
                raise ValueError(f'has an invalid {name}; give a positive number in {unit}')
            # Of a rate, the time between two rows
            period = None if quantity is None else quantity.si if unit == 's' else 1 / quantity.si
            if period is not None and not NANOSECOND <= period < LAST_SECOND:
                raise ValueError(
                    f'has rows that are {period:g} s apart; give a {name} with {NANOSECOND:g} s '
                    f'to {LAST_SECOND:g} s between two rows'
                )
        if self.start is not None and self.start.dimension != 's':
            raise ValueError(
                f'has a start in {self.start.unit}, but it must be a time, as in "1 s"'
            )
        if self.start is not None and abs(self.start.si) >= LAST_SECOND:
            raise ValueError(
                f'has a start at {self.start.si:g} s; a ROS time stamp is below {LAST_SECOND:g} s'
            )
        return self

    @property
    def columns(self) -> list[str]:
        """Return the columns of the time."""
        return [one for one in (self.column, self.fraction) if one is not None]


class TopicMapping(_WithAxes):
    """One of our topics, from one table of the log; see docs/import.md."""

    topic: str
    table: str | None = None  # an event, a logged message or a topic of a bag; unset for CSV
    join: list[str] = Field(default_factory=list)
    where: dict[str, float | str] = Field(default_factory=dict)  # cells of the rows to read
    optional: bool = False
    drop_empty: bool = False
    time: TimeColumn | None = None  # of its table, if it differs from that of the mapping
    # Of a bag: times of the messages, or 'log', where another computer's clock set these
    stamps: Literal['message', 'log'] = 'message'
    actuators: dict[str, ActuatorFields] | None = None
    position: VectorField | None = None
    orientation: OrientationField | None = None
    velocity: VectorField | None = None
    rates: VectorField | None = None
    acceleration: VectorField | None = None
    force: VectorField | None = None
    torque: VectorField | None = None
    forces: list[AppliedForce] | None = None
    vector: VectorField | None = None
    voltage: ScalarField | None = None
    current: ScalarField | None = None
    temperature: ScalarField | None = None
    percentage: ScalarField | None = None
    charge: ScalarField | None = None
    capacity: ScalarField | None = None
    range: ScalarField | None = None
    minimum: ScalarField | None = None
    maximum: ScalarField | None = None
    field_of_view: ScalarField | None = None
    pressure: ScalarField | None = None
    illuminance: ScalarField | None = None

    @property
    def labels(self) -> list[str]:
        """Return the columns of `where` whose cells are words."""
        return [name for name, value in self.where.items() if isinstance(value, str)]

    @property
    def parts(self) -> dict[str, ScalarField | VectorField | OrientationField]:
        """Return the fields of the message that are set, by name."""
        fields = ((name, getattr(self, name)) for name in type(self).model_fields)
        kinds = ScalarField | VectorField | OrientationField
        return {name: part for name, part in fields if isinstance(part, kinds)}

    @property
    def columns(self) -> list[str]:
        """Every required column."""
        actuators = self.actuators or {}
        # Effort, position and velocity of each actuator
        scalars = [s for a in actuators.values() for s in (a.effort, a.position, a.velocity) if s]
        needed = list(self.where)
        for part in (*self.parts.values(), *(self.forces or []), *scalars):
            if isinstance(part, ScalarField):
                needed += [part.column] if part.column else []
            else:
                needed += [column for column in part.columns or [] if column is not None]
        # Without duplicates, in order
        return list(dict.fromkeys(needed))


class TextFormat(StrictModel):
    """The format of the lines of a text."""

    delimiter: Annotated[str, Field(min_length=1)] = ','  # one character, 'tab' or 'whitespace'
    # Decimal mark of the numbers; where it is the delimiter, too, numbers are in quotes
    decimal: Literal['.', ','] = '.'
    lists: bool = False  # whether a cell may be a list such as "[1, 2, 3]": a column for each
    comment: Annotated[str, Field(min_length=1, max_length=1)] | None = None
    skip: Annotated[int, Field(ge=0)] = 0  # lines before the one with the names
    header: list[Column] | None = None  # column names, if the text has none

    @field_validator('delimiter')
    @classmethod
    def _check_delimiter(cls, value: str) -> str:
        if len(value) > 1 and value not in ('tab', 'whitespace'):
            raise ValueError(
                f'is "{value}", but must be a single character, "tab" or "whitespace"'
            )
        return value


class ImportMapping(_WithAxes):
    """A mapping file."""

    schema_version: SchemaVersion
    name: Name
    about: str
    format: Format
    data: Literal['measured', 'simulated'] = 'measured'
    time: TimeColumn | None = None
    text: TextFormat = Field(default_factory=TextFormat)
    topics: Annotated[list[TopicMapping], Field(min_length=1)]

    @model_validator(mode='after')
    def _check_time(self) -> Self:
        timed = self.time is not None or all(entry.time for entry in self.topics)
        if self.format in TIMED_BY_MAPPING and not timed:
            raise ValueError(f'of format {self.format} needs the key "time"; add it')
        if self.format not in TIMED_BY_MAPPING and (
            self.time is not None or any(entry.time for entry in self.topics)
        ):
            raise ValueError(f'of format {self.format} must not have the key "time"; remove it')
        return self

    @model_validator(mode='after')
    def _check_csv_keys(self) -> Self:
        if self.format != 'csv':
            return self
        if any(entry.drop_empty for entry in self.topics):
            raise ValueError('of format csv must not have the key "drop_empty"; remove it')
        if any(entry.table or entry.join for entry in self.topics):
            raise ValueError('of format csv has only one table; remove "table" and "join"')
        if any(entry.time for entry in self.topics):
            raise ValueError('of format csv has only one time; remove "time" from its topics')
        return self


def load_mapping(name: str) -> tuple[ImportMapping, str]:
    """
    Return a mapping by shipped name or path, and its text.

    Raises
    ------
    BadInput
        One sentence on the first problem.

    """
    path = find_file('import mapping', name)
    return load_file(ImportMapping, path), path.read_text(encoding='utf-8')

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare two vehicle files and the figures derived from them."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml, validate_content
from lta_config.parameter_override import parse_assignment, replace_parameter
from lta_config.schema.vehicle_aero import WrenchPerNewton
from lta_config.schema.vehicle_file import VehicleFile
from lta_model import propulsion
from lta_model.propulsion import Six
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.sheet import build_sheet, list_entries, VehicleFileEntry, VehicleSheet

VEHICLE_PREFIX = 'vehicle.'  # optional path prefix, as in `lta simulate --set`
SAME_VALUE = 1e-12  # relative; absorbs the rounding of unit conversions, such as 4 g and 0.004 kg
# Groups reported as one change when added or removed, with the path depth of one group.
WHOLE_GROUPS = {'layers': 3, 'rotors': 2, 'aero.thrust_allocation': 3}
ASSUMED = 'assumed'  # how a source begins that names none
MOST_NAMED = 4  # numbers that a warning lists
TEXT_ENTRIES = ('name', 'about')  # texts without effect on the physics


@final
@dataclass(frozen=True, slots=True)
class VehicleChange:
    """An entry that differs between two files; None where a file lacks it."""

    place: str
    before: VehicleFileEntry | None
    after: VehicleFileEntry | None

    @property
    def source(self) -> str:
        """Source of the later value."""
        return self.after.source if self.after is not None else ''

    @property
    def has_stale_source(self) -> bool:
        """Whether both values name the same source, other than an assumption."""
        before = self.before.source if self.before is not None else ''
        return bool(before) and before == self.source and not before.startswith(ASSUMED)


@final
@dataclass(frozen=True, slots=True)
class FigureChange:
    """A derived figure that differs; None where a vehicle does not have it."""

    before: DerivedFigure | None
    after: DerivedFigure | None

    @property
    def figure(self) -> DerivedFigure:
        """Return the later figure, or the earlier one if the later vehicle has none."""
        figure = self.after or self.before
        if figure is None:
            raise ValueError('A FigureChange needs at least one of its figures before and after.')
        return figure

    @property
    def shift(self) -> float | None:
        """Later minus earlier value, in the unit of the figure; None if one is missing."""
        if self.before is None or self.after is None:
            return None
        a, b = self.before.value, self.after.value
        # Some figures may be infinite, such as the tumbling speed; no difference is defined
        if a is None or b is None or math.isinf(a) or math.isinf(b):
            return None
        return b - a


@final
@dataclass(frozen=True, slots=True)
class VehicleDifference:
    """Two vehicle sheets, the changed entries and the derived figures that changed."""

    before: VehicleSheet
    after: VehicleSheet
    changes: Sequence[VehicleChange]
    consequences: Sequence[FigureChange]

    @property
    def changed_effects(self) -> list[str]:
        """Names of the changed effects; the derived figures may not show their influence."""
        places = [change.place.split('.') for change in self.changes]
        # `dict.fromkeys` removes duplicates and keeps the order
        effects = [place[1] for place in places if place[0] == 'effects']
        return list(dict.fromkeys(effects))

    @property
    def stale_aero_notes(self) -> list[str]:
        """Warnings about aero values that were not updated with the rotors or the hull."""
        columns = self.after.vehicle.file.aero.thrust_allocation
        return list(find_stale_aero([change.place for change in self.changes], columns))

    @property
    def stale_source_notes(self) -> list[str]:
        """Return a warning about numbers that changed while their source did not."""
        stale = [change for change in self.changes if change.has_stale_source]
        if not stale:
            return []
        named = [f'{each.place} ("{each.source}")' for each in stale[:MOST_NAMED]]
        more = f' and {len(stale) - MOST_NAMED} more' if len(stale) > MOST_NAMED else ''
        return [
            f'Changed, but the source did not: {", ".join(named)}{more}; name the new source with '
            'lta vehicle set --source.'
        ]

    @property
    def warnings(self) -> list[str]:
        """All warnings."""
        return [*self.stale_source_notes, *self.stale_aero_notes]


def load_vehicle_variant(name: str, sets: Sequence[str] = ()) -> Vehicle:
    """
    Load a vehicle, optionally with replaced numbers.

    `name`: vehicle name or file. `sets`: PATH=VALUE as in `lta simulate --set`; the prefix
    'vehicle.' is optional. Raise `BadInput` if the file cannot be read, or a path does not exist.
    """
    # Work on the YAML content, so that replaced values pass the same validation as a file
    path = find_file('vehicle', name)
    content = load_yaml(path)
    for text in sets:
        place, value = parse_assignment(text)
        content = replace_parameter(content, place.removeprefix(VEHICLE_PREFIX), value, 'vehicle')
    where = f'{path} with {", ".join(sets)}' if sets else str(path)
    try:
        return Vehicle(validate_content(VehicleFile, content, where))
    except BadInput as error:
        text = str(error)
        # Errors of `Vehicle` itself do not name the file
        raise BadInput(text if text.startswith(where) else f'{where}: {text}') from None


def compare_vehicles(before: Vehicle, after: Vehicle) -> VehicleDifference:
    """Compare the files and the derived figures of two vehicles."""
    a, b = build_sheet(before), build_sheet(after)
    return VehicleDifference(
        a, b, find_changes(before.file, after.file), find_figure_changes(a, b)
    )


def find_changes(before: VehicleFile, after: VehicleFile) -> list[VehicleChange]:
    """Return the entries that differ, in the order of the later file."""
    a = {entry.place: entry for entry in list_entries(before)}
    b = {entry.place: entry for entry in list_entries(after)}
    # A part that only one file has is one change, not one for each of its numbers.
    for own, other in ((a, b), (b, a)):
        _merge_entries(own, other)
    places = [*b, *(place for place in a if place not in b)]
    return [
        VehicleChange(place, a.get(place), b.get(place))
        for place in places
        if place not in TEXT_ENTRIES and not has_same_value(a.get(place), b.get(place))
    ]


def _merge_entries(
    own: dict[str, VehicleFileEntry], other: Mapping[str, VehicleFileEntry]
) -> None:
    """Merge the entries of each part, rotor or column that the other file lacks into one."""
    groups: dict[str, list[VehicleFileEntry]] = {}
    for entry in own.values():
        keys = entry.place.split('.')
        for head, depth in WHOLE_GROUPS.items():
            if entry.place.startswith(f'{head}.') and len(keys) > depth:
                groups.setdefault('.'.join(keys[:depth]), []).append(entry)
    for group, parts in groups.items():
        # The other file has this part too: compare its numbers one by one
        if any(place.startswith(f'{group}.') for place in other):
            continue
        # Represent a part by its mass, the number that readers look for first.
        first = next((part for part in parts if part.place.endswith('.mass')), parts[0])
        value = first.value if first.numbers and first.place.endswith('.mass') else 'as a whole'
        for part in parts:
            del own[part.place]
        own[group] = VehicleFileEntry(group, value, first.source)


def has_same_value(a: VehicleFileEntry | None, b: VehicleFileEntry | None) -> bool:
    """Return whether two entries have the same value; their sources may differ."""
    if a is None or b is None:
        return a is b
    # Choices, such as the hull shape, are compared as text
    if not a.numbers and not b.numbers:
        return a.value == b.value
    return (
        a.unit == b.unit
        and len(a.numbers) == len(b.numbers)
        and all(
            math.isclose(x, y, rel_tol=SAME_VALUE, abs_tol=0.0)
            for x, y in zip(a.numbers, b.numbers, strict=True)
        )
    )


def find_figure_changes(a: VehicleSheet, b: VehicleSheet) -> list[FigureChange]:
    """Return the derived figures whose displayed values differ."""
    before, after = a.by_key, b.by_key
    keys = [*after, *(key for key in before if key not in after)]
    return [
        FigureChange(before.get(key), after.get(key))
        for key in keys
        # Changes below the displayed digits would appear as equal numbers
        if _rounded_value(before.get(key)) != _rounded_value(after.get(key))
    ]


def _rounded_value(figure: DerivedFigure | None) -> object:
    """Return the value, rounded as displayed."""
    if figure is None or figure.value is None:
        return None
    return round(figure.value, figure.digits) + 0.0  # turns -0.0 into 0.0


# Jets attach to the hull, so a valid column may differ from the rotor geometry. Over all shipped
# vehicles and aero files the force is at most 3.8 degrees off the rotor axis, and the moment at
# most 1.1 % of the rotor's distance from the hull centre. Reverse thrust is not compared, since
# reversed jets that hit the hull differ far more.
LARGEST_AXIS_ANGLE: Final = 10.0  # largest angle between rotor axis and force [deg]
LARGEST_SHIFT: Final = 0.05  # largest difference of the moments, relative to the rotor's distance
ALLOCATION_REMEDY: Final = (
    'delete aero.thrust_allocation, so that the columns follow from position and axis, or '
    'compute new ones with lta cfd run.'
)
OUTLINE: Final = frozenset(f'hull.{key}' for key in ('shape', 'diameter', 'height', 'length'))
ALLOCATION_PATH: Final = 'aero.thrust_allocation'
DRAGS: Final = ('aero.linear_drag', 'aero.quadratic_drag')


def find_stale_columns(file: VehicleFile) -> Iterator[str]:
    """Yield a warning for each rotor whose column does not match its position and axis."""
    for name, column in file.aero.thrust_allocation.items():
        rotor = file.rotors[name]
        plain = propulsion.geometric_column(rotor)
        distance = math.hypot(*rotor.position.vector)
        if warning := _describe_force_mismatch(name, column, plain) or _describe_moment_mismatch(
            name, column, plain, distance
        ):
            yield warning


def _describe_force_mismatch(name: str, column: WrenchPerNewton, plain: Six) -> str:
    """Return a sentence if the force is not along the rotor axis, else ''."""
    force, axis = column.force.vector, plain[:3]
    length = math.hypot(*force)
    along = sum(a * b for a, b in zip(force, axis, strict=True))
    # Compare cosines: `acos` is needed only for the message
    if length == 0.0 or along >= length * math.cos(math.radians(LARGEST_AXIS_ANGLE)):
        return ''
    angle = math.degrees(math.acos(max(-1.0, along / length)))
    return (
        f'The rotor {name} points along {_format_vector(axis, 2)}, but its column of '
        f'{ALLOCATION_PATH} pushes along {_format_vector(force, 2)}, {angle:.0f} degrees away. '
        f'The simulation uses the column; {ALLOCATION_REMEDY}'
    )


def _describe_moment_mismatch(
    name: str, column: WrenchPerNewton, plain: Six, distance: float
) -> str:
    """Return a sentence if the moment does not match the rotor geometry, else ''; in m."""
    own, of_place = column.moment.vector, plain[3:]
    if math.dist(own, of_place) <= LARGEST_SHIFT * distance:
        return ''
    there, here = (
        # Moments per newton are lengths: m to cm
        _format_vector([100.0 * number for number in each], 1)
        for each in (of_place, own)
    )
    return (
        f'From its position and axis, the rotor {name} has a moment of {there} N cm per '
        f'newton of thrust, but its column of {ALLOCATION_PATH} gives {here}. The simulation uses '
        f'the column; {ALLOCATION_REMEDY}'
    )


def _format_vector(numbers: Sequence[float], digits: int) -> str:
    """Return numbers in brackets, -0.0 as 0.0."""
    return f'({", ".join(f"{round(number, digits) + 0.0:.{digits}f}" for number in numbers)})'


def find_stale_aero(changed: Collection[str], columns: Collection[str]) -> Iterator[str]:
    """
    Yield a warning for each aero value that was not updated with the rotors or the hull.

    `changed`: paths that differ, such as 'rotors.left.position'. `columns`: names of the rotors
    that have a thrust allocation column.
    """
    held = [name for name in columns if _has_stale_column(name, changed)]
    if held:
        yield (
            f'These rotors were moved or turned, but their columns in {ALLOCATION_PATH} are '
            f'unchanged: {", ".join(held)}. The columns override positions and axes, so the '
            f'thrust does not change; {ALLOCATION_REMEDY}'
        )
    # Drag belongs to the outline of the hull; a change of its material keeps the drag
    if OUTLINE.intersection(changed) and not any(place.startswith(DRAGS) for place in changed):
        yield (
            'The shape or size of the hull has changed, but the drag in the aero block '
            'has not; compute it again with lta cfd run.'
        )


def _has_stale_column(name: str, changed: Collection[str]) -> bool:
    """Return whether the position or axis of a rotor changed but its column did not."""
    own = f'{ALLOCATION_PATH}.{name}'
    if any(place == own or place.startswith(f'{own}.') for place in changed):
        return False
    return any(f'rotors.{name}.{key}' in changed for key in ('position', 'axis'))

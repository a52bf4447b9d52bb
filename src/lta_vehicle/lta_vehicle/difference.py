"""Compare two vehicle files and the figures derived from them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml, validate_content
from lta_config.parameter_override import parse_assignment, replace_parameter
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.sheet import build_sheet, list_entries, VehicleFileEntry, VehicleSheet
from lta_vehicle.stale_aero import find_stale_aero

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
        """The later figure, or the earlier one if the later vehicle has none."""
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
        """A warning about numbers that changed while their source did not."""
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

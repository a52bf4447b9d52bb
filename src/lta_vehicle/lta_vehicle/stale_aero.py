"""
What of an aero block is of another shape: columns beside place and axis, drag beside the hull.

Columns win over places and axes, so a rotor that is moved in the file pushes as before until its
column goes or is made anew.
"""

from collections.abc import Collection, Iterator, Sequence
import math
from typing import Final

from lta_config.schema.vehicle_aero import WrenchPerNewton
from lta_config.schema.vehicle_file import VehicleFile
from lta_model import propulsion
from lta_model.propulsion import Six

# The jets of all shipped vehicles and aero files push at most 3.8 degrees off the axis of their
# rotor, since they cling to the hull; and their moment is at most 1.1 % of the rotor's distance
# from the hull centre off that of place and axis. Reversed jets that meet the hull are far off.
ASIDE: Final = 10.0  # degrees between a rotor's axis and its push
FAR: Final = 0.05  # of the rotor's distance from the hull centre, between both moments
REMEDY: Final = (
    'delete aero.thrust_allocation, so that columns follow from place and axis, or make new ones '
    'with lta cfd run.'
)
OUTLINE: Final = frozenset(f'hull.{key}' for key in ('shape', 'diameter', 'height', 'length'))
COLUMNS: Final = 'aero.thrust_allocation'
DRAGS: Final = ('aero.linear_drag', 'aero.quadratic_drag')


def find_stale_columns(file: VehicleFile) -> Iterator[str]:
    """Yield which rotors do not push as they stand and point: one of the two is out of date."""
    for name, column in file.aero.thrust_allocation.items():
        rotor = file.rotors[name]
        plain = propulsion.geometric_column(rotor)
        distance = math.hypot(*rotor.position.vector)
        if told := _describe_force_mismatch(name, column, plain) or _describe_moment_mismatch(
            name, column, plain, distance
        ):
            yield told


def _describe_force_mismatch(name: str, column: WrenchPerNewton, plain: Six) -> str:
    """Return a sentence where a column pushes aside of its rotor's axis, '' else."""
    force, axis = column.force.vector, plain[:3]
    length = math.hypot(*force)
    along = sum(a * b for a, b in zip(force, axis, strict=True))
    if length == 0.0 or along >= length * math.cos(math.radians(ASIDE)):
        return ''
    angle = math.degrees(math.acos(max(-1.0, along / length)))
    return (
        f'The rotor {name} points along {_format_vector(axis, 2)}, {angle:.0f} degrees away from '
        f'{_format_vector(force, 2)}, where its column of {COLUMNS} pushes. The column is what '
        f'flies; '
        f'{REMEDY}'
    )


def _describe_moment_mismatch(
    name: str, column: WrenchPerNewton, plain: Six, distance: float
) -> str:
    """Return a sentence where a column turns unlike place and axis, '' else; distance in m."""
    own, of_place = column.moment.vector, plain[3:]
    if math.dist(own, of_place) <= FAR * distance:
        return ''
    there, here = (
        _format_vector([100.0 * number for number in each], 1) for each in (of_place, own)
    )
    return (
        f'The rotor {name} would turn the hull by {there} N cm per newton where it stands, but '
        f'its column of {COLUMNS} says {here}. The column is what flies; {REMEDY}'
    )


def _format_vector(numbers: Sequence[float], digits: int) -> str:
    """Return numbers in brackets; -0.0 is 0.0."""
    return f'({", ".join(f"{round(number, digits) + 0.0:.{digits}f}" for number in numbers)})'


def find_stale_aero(changed: Collection[str], columns: Collection[str]) -> Iterator[str]:
    """
    Yield what of an aero block stayed, in sentences, though what it is of changed.

    Parameters
    ----------
    changed : collection of str
        Places of the file that differ, as 'rotors.left.position'.
    columns : collection of str
        Rotors that have a column.

    """
    held = [name for name in columns if _has_stale_column(name, changed)]
    if held:
        yield (
            f'{", ".join(held)}: moved or turned, but {COLUMNS} has the same columns as before, '
            f'which win over places and axes, so that nothing follows for the push; {REMEDY}'
        )
    if OUTLINE.intersection(changed) and not any(place.startswith(DRAGS) for place in changed):
        yield (
            'The hull has another shape or size, but aero has the same drag as before; make it '
            'anew with lta cfd run.'
        )


def _has_stale_column(name: str, changed: Collection[str]) -> bool:
    """Tell whether place or axis of a rotor differ and its column does not."""
    own = f'{COLUMNS}.{name}'
    if any(place == own or place.startswith(f'{own}.') for place in changed):
        return False
    return any(f'rotors.{name}.{key}' in changed for key in ('position', 'axis'))

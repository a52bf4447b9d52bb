"""
Find aero values that no longer match the rotors or the hull.

Thrust allocation columns override rotor positions and axes: a rotor that is moved in the file has
its old wrench until its column is deleted or computed again.
"""

from collections.abc import Collection, Iterator, Sequence
import math
from typing import Final

from lta_config.schema.vehicle_aero import WrenchPerNewton
from lta_config.schema.vehicle_file import VehicleFile
from lta_model import propulsion
from lta_model.propulsion import Six

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

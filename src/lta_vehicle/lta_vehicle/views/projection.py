"""
Project a vehicle to shapes in three views, in metres.

The side view has the nose to the right. The front view is seen from ahead, so that the vehicle's
left side is on the right. The top view has the nose to the right and the left side up.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final, NamedTuple

from lta_config.schema.vehicle_body import PartBlock
from lta_model import mass_properties
from lta_model.vehicle import Vehicle

Three = tuple[float, float, float]
Two = tuple[float, float]
FLATTEST = 0.4  # least height of a view, relative to its width


@final
@dataclass(frozen=True, slots=True)
class ViewDirection:
    """A viewing direction: body axes that point right, up, and towards the viewer."""

    name: str
    title: str
    right: Three
    up: Three
    towards: Three

    def project(self, place: Sequence[float]) -> Two:
        """Return right and up coordinates of a position or direction."""
        return _dot(place, self.right), _dot(place, self.up)

    def depth(self, place: Sequence[float]) -> float:
        """Return the component towards the viewer."""
        return _dot(place, self.towards)


VIEWS = (
    ViewDirection('side', 'From its right side', (1, 0, 0), (0, 0, 1), (0, -1, 0)),
    ViewDirection('front', 'From ahead', (0, 1, 0), (0, 0, 1), (1, 0, 0)),
    ViewDirection('top', 'From above', (1, 0, 0), (0, 1, 0), (0, 0, 1)),
)


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


class PartOutline(NamedTuple):
    """An ellipse or a box: centre and half sizes in the view [m], name and description."""

    kind: str  # 'ellipse' or 'box'
    middle: Two
    half: Two
    name: str
    about: str


class RotorArrow(NamedTuple):
    """A rotor: position, thrust direction in the view, and towards the viewer (-1 to 1)."""

    at: Two
    along: Two
    towards: float
    reversible: bool
    name: str


class CenterMark(NamedTuple):
    """The mark of a centre, such as CG: letters, position and description."""

    letters: str
    at: Two
    about: str


@final
@dataclass(frozen=True, slots=True)
class ViewShapes:
    """All shapes of one view. [m]"""

    view: ViewDirection
    hull: PartOutline | None
    parts: Sequence[PartOutline]
    rotors: Sequence[RotorArrow]
    marks: Sequence[CenterMark]
    arms: Sequence[tuple[Two, Two]] = ()

    @property
    def bounds(self) -> tuple[Two, Two]:
        """Lower left and upper right corner. [m]"""
        shapes = [*self.parts, *([self.hull] if self.hull else [])]
        across = [
            (s.middle[i] - s.half[i], s.middle[i] + s.half[i]) for i in (0, 1) for s in shapes
        ]
        count = len(shapes)
        points = [rotor.at for rotor in self.rotors] + [mark.at for mark in self.marks]
        ends = []
        for i in (0, 1):
            own = across[i * count : (i + 1) * count]
            values = [*(v for pair in own for v in pair), *(point[i] for point in points)]
            ends.append((min(values), max(values)))
        (left, right), (low, high) = ends
        # What is flat, such as a quadrotor from the side, still needs room to be drawn in.
        pad = max(0.0, FLATTEST * (right - left) - (high - low)) / 2.0
        return (left, low - pad), (right, high + pad)


def project_vehicle(vehicle: Vehicle, view: ViewDirection, pressure: float) -> ViewShapes:
    """
    Return the shapes of one view.

    `pressure`: distance of the centre of pressure ahead of the hull centre [m].
    """
    file = vehicle.file
    parts = [
        _part_outline(view, layer, name, part)
        for layer, parts in file.layers.items()
        for name, part in parts.items()
        if part.shape == 'box'
    ]
    rotors = [
        RotorArrow(
            view.project(r.place), view.project(r.axis), view.depth(r.axis), r.reversible, r.name
        )
        for r in vehicle.rotors
    ]
    middle = view.project([float(number) for number in vehicle.cg])
    arms = [(middle, rotor.at) for rotor in rotors]
    return ViewShapes(
        view,
        _hull_outline(vehicle, view),
        parts,
        rotors,
        _list_centers(vehicle, view, pressure),
        () if parts else arms,  # without parts, arms show what holds the rotors
    )


def _hull_outline(vehicle: Vehicle, view: ViewDirection) -> PartOutline | None:
    half = mass_properties.half_axes(vehicle.file.hull)
    if not any(half):
        return None
    about = f'hull: {vehicle.file.hull.shape} of {1e3 * vehicle.volume:.0f} l'
    return PartOutline('ellipse', (0.0, 0.0), _projected_size(view, half), 'hull', about)


def _part_outline(view: ViewDirection, layer: str, name: str, part: PartBlock) -> PartOutline:
    half = _projected_size(view, [0.5 * number for number in part.size.vector])
    about = f'{name.replace("_", " ")} ({layer.replace("_", " ")}): {1e3 * part.mass.si:.1f} g'
    return PartOutline('box', view.project(part.position.vector), half, name, about)


def _projected_size(view: ViewDirection, half: Sequence[float]) -> Two:
    across, high = view.project(half)
    # A view axis may be negative; sizes are not
    return abs(across), abs(high)


def _list_centers(vehicle: Vehicle, view: ViewDirection, pressure: float) -> Sequence[CenterMark]:
    file = vehicle.file
    cg = [float(number) for number in vehicle.cg]
    marks = [CenterMark('CG', view.project(cg), 'centre of gravity')]
    if file.hull.shape != 'none':
        middle, ahead = (0.0, 0.0, 0.0), (pressure, 0.0, 0.0)
        # One common mark where both coincide, for example in the front view
        if view.project(ahead) == view.project(middle):
            marks.append(
                CenterMark('CB, CP', view.project(middle), 'centres of buoyancy and pressure')
            )
        else:
            marks.append(CenterMark('CB', view.project(middle), 'centre of buoyancy'))
            marks.append(CenterMark('CP', view.project(ahead), 'centre of pressure'))
    if file.moving_mass:
        marks.append(
            CenterMark('moving mass', view.project(file.moving_mass.position.vector), 'at rest')
        )
    return marks

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Project a vehicle to shapes in three views, in metres.

The side view has the nose to the right. The front view is seen from ahead, so that the vehicle's
left side is on the right. The top view has the nose to the right and the left side up.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
import math
from typing import Final, final, NamedTuple

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
    """All shapes of one view [m]."""

    view: ViewDirection
    hull: PartOutline | None
    parts: Sequence[PartOutline]
    rotors: Sequence[RotorArrow]
    marks: Sequence[CenterMark]
    arms: Sequence[tuple[Two, Two]] = ()

    @property
    def corners(self) -> tuple[Two, Two]:
        """Lower left and upper right corner of what is drawn [m]."""
        points = [rotor.at for rotor in self.rotors] + [mark.at for mark in self.marks]
        for shape in (*self.parts, *([self.hull] if self.hull else [])):
            (x, y), (a, b) = shape.middle, shape.half
            points += [(x - a, y - b), (x + a, y + b)]
        across, up = zip(*points, strict=True)
        return (min(across), min(up)), (max(across), max(up))

    @property
    def bounds(self) -> tuple[Two, Two]:
        """Lower left and upper right corner of the view [m]."""
        (left, low), (right, high) = self.corners
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
        outline_part(view, layer, name, part)
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


def outline_part(view: ViewDirection, layer: str, name: str, part: PartBlock) -> PartOutline:
    """Return the outline of a box in a view."""
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


VIEWS_WIDTH: Final = 640.0  # px; of side and front view together
VIEW_GAP, VIEW_TITLE, VIEW_MARGIN = 64.0, 26.0, 34.0  # px
ARROW, DISC_RADIUS, ARROW_HEAD = (
    34.0,
    11.0,
    7.0,
)  # px: thrust at full length, half a rotor, its arrow head
CLOSE: Final = (60.0, 15.0)  # px, horizontal and vertical; letters of closer marks would touch
LETTERS: Final = (  # px; offset of the letters, by the number of marks already close by
    (-11.0, 4.0, 'end'),
    (0.0, -11.0, 'middle'),
    (0.0, 19.0, 'middle'),
    (0.0, 34.0, 'middle'),
)
LEGEND_HEIGHT, LEGEND_WIDTH = 214.0, 260.0  # px; height and width of the legend
BAR_LENGTHS: Final = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)  # m; lengths of the scale bar


def draw_three_views(vehicle: Vehicle, pressure: float) -> str:
    """
    Return side, front and top view as one SVG element.

    `pressure`: distance of the centre of pressure ahead of the hull centre [m].
    """
    side, front, top = (project_vehicle(vehicle, view, pressure) for view in VIEWS)
    wide, deep, high = _view_span(side, 0), _view_span(front, 0), _view_span(side, 1)
    tall = _view_span(top, 1)
    # One scale for all views: side and front view share the first row
    scale = (VIEWS_WIDTH - 4.0 * VIEW_MARGIN) / (wide + deep)
    x2 = wide * scale + 2.0 * VIEW_MARGIN + VIEW_GAP
    y2 = VIEW_TITLE + high * scale + 2.0 * VIEW_MARGIN + VIEW_GAP / 2
    height = y2 + VIEW_TITLE + max(tall * scale + 2.0 * VIEW_MARGIN, LEGEND_HEIGHT)
    width = x2 + max(deep * scale + 2.0 * VIEW_MARGIN, VIEW_MARGIN + LEGEND_WIDTH)
    body = [
        *_draw_view(side, VIEW_MARGIN, VIEW_TITLE + VIEW_MARGIN, scale),
        *_draw_view(front, x2 + VIEW_MARGIN, VIEW_TITLE + VIEW_MARGIN, scale),
        *_draw_view(top, VIEW_MARGIN, y2 + VIEW_TITLE + VIEW_MARGIN, scale),
        *_draw_legend(x2 + VIEW_MARGIN, y2 + VIEW_TITLE + 10.0, scale, bool(side.hull)),
    ]
    words = escape(f'Side, front and top view of {vehicle.file.name}.')
    return (
        f'<svg class="views" viewBox="0 0 {width:.0f} {height:.0f}" role="img" '
        f'aria-label="{words}">{"".join(body)}</svg>'
    )


def _view_span(shapes: ViewShapes, axis: int) -> float:
    low, high = shapes.bounds
    return max(high[axis] - low[axis], 1e-3)


def _draw_view(shapes: ViewShapes, left: float, top: float, scale: float) -> Iterator[str]:
    """Yield one view with its upper left corner at a position [px]."""
    low, high = shapes.bounds

    def to_pixels(place: Sequence[float]) -> tuple[float, float]:
        return left + (place[0] - low[0]) * scale, top + (high[1] - place[1]) * scale

    yield f'<g><text class="of" x="{left - VIEW_MARGIN + 4:.1f}" y="{top - VIEW_MARGIN - 6:.1f}">'
    yield f'{escape(shapes.view.title)}</text>'
    if shapes.hull:
        yield draw_outline(shapes.hull, to_pixels, scale, 'hull')
    for part in shapes.parts:
        yield draw_outline(part, to_pixels, scale, 'part')
    for arm in shapes.arms:
        (x1, y1), (x2, y2) = map(to_pixels, arm)
        yield f'<path class="arm" d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}"/>'
    for rotor in shapes.rotors:
        yield from draw_rotor(rotor, *to_pixels(rotor.at))
    taken: list[tuple[float, float]] = []
    letters: list[str] = []  # drawn last, on top of all symbols
    for mark in shapes.marks:
        x, y = to_pixels(mark.at)
        near = sum(abs(x - p) < CLOSE[0] and abs(y - q) < CLOSE[1] for p, q in taken)
        sign, words = _draw_center_mark(mark, x, y, min(near, len(LETTERS) - 1))
        yield sign
        letters.append(words)
        taken.append((x, y))
    yield from letters
    yield '</g>'


def draw_outline(shape: PartOutline, at: Callable[[Two], Two], scale: float, kind: str) -> str:
    """Return an ellipse or a box, at least 2.4 px wide, so that it stays visible."""
    x, y = at(shape.middle)
    a, b = max(shape.half[0] * scale, 1.2), max(shape.half[1] * scale, 1.2)
    title = f'<title>{escape(shape.about)}</title>'
    if shape.kind == 'ellipse':
        return (
            f'<ellipse class="{kind}" cx="{x:.1f}" cy="{y:.1f}" rx="{a:.1f}" ry="{b:.1f}">'
            f'{title}</ellipse>'
        )
    return (
        f'<rect class="{kind}" x="{x - a:.1f}" y="{y - b:.1f}" width="{2 * a:.1f}" '
        f'height="{2 * b:.1f}">{title}</rect>'
    )


def draw_rotor(rotor: RotorArrow, x: float, y: float) -> Iterator[str]:
    """Yield a rotor: its disc with a thrust arrow, or a ring if the thrust faces the viewer."""
    # SVG's y axis points down
    p, q = rotor.along[0], -rotor.along[1]
    seen = math.hypot(p, q)
    kind = ' both' if rotor.reversible else ''
    yield f'<g class="rotor{kind}"><title>{escape(rotor.name.replace("_", " "))}</title>'
    flat = DISC_RADIUS * abs(rotor.towards)  # a disc seen at an angle is an ellipse
    turn = math.degrees(math.atan2(q, p)) if seen > 1e-6 else 0.0
    yield (
        f'<ellipse class="disc" cx="{x:.1f}" cy="{y:.1f}" rx="{max(flat, 1.3):.1f}" '
        f'ry="{DISC_RADIUS:.1f}" transform="rotate({turn:.1f} {x:.1f} {y:.1f})"/>'
    )
    # A shorter projected axis has no visible arrow; it is drawn as a ring or a cross
    if seen > 0.15:
        yield _draw_arrow(x, y, p * ARROW, q * ARROW)
        if rotor.reversible:
            # The shorter arrow marks reverse thrust
            yield _draw_arrow(x, y, -0.6 * p * ARROW, -0.6 * q * ARROW)
    elif rotor.towards > 0.0:
        yield f'<circle class="tip" cx="{x:.1f}" cy="{y:.1f}" r="2.6"/>'
    else:
        r = 0.6 * DISC_RADIUS
        yield (
            f'<path class="shaft" d="M{x - r:.1f} {y - r:.1f}L{x + r:.1f} {y + r:.1f}'
            f'M{x - r:.1f} {y + r:.1f}L{x + r:.1f} {y - r:.1f}"/>'
        )
    yield '</g>'


def _draw_arrow(x: float, y: float, p: float, q: float) -> str:
    length = math.hypot(p, q)
    p, q = p / length, q / length
    tip = (x + p * length, y + q * length)
    neck = (tip[0] - p * ARROW_HEAD, tip[1] - q * ARROW_HEAD)
    half = 0.45 * ARROW_HEAD
    return (
        f'<path class="shaft" d="M{x:.1f} {y:.1f}L{neck[0]:.1f} {neck[1]:.1f}"/>'
        f'<path class="tip" d="M{tip[0]:.1f} {tip[1]:.1f}L{neck[0] - q * half:.1f} '
        f'{neck[1] + p * half:.1f}L{neck[0] + q * half:.1f} {neck[1] - p * half:.1f}Z"/>'
    )


def _draw_center_mark(mark: CenterMark, x: float, y: float, near: int) -> tuple[str, str]:
    """Return the symbol of a centre and its letters."""
    kind = {'CG': 'gravity', 'CP': 'pressure'}.get(mark.letters, 'buoyancy')
    if mark.letters == 'moving mass':
        kind = 'moving'
    right, down, anchor = LETTERS[near]
    return (
        f'<g class="mark {kind}"><title>{escape(mark.about)}</title>'
        f'{"".join(draw_center_symbol(kind, x, y))}</g>',
        f'<g class="mark {kind}"><text x="{x + right:.1f}" y="{y + down:.1f}" '
        f'text-anchor="{anchor}">{escape(mark.letters)}</text></g>',
    )


def draw_center_symbol(kind: str, x: float, y: float) -> Iterator[str]:
    """Yield the symbol of a centre: quartered for gravity, ring for buoyancy, else diamond."""
    if kind == 'gravity':
        yield f'<circle class="ring" cx="{x:.1f}" cy="{y:.1f}" r="7"/>'
        for r in (7, -7):  # px; two opposite quarters are filled
            yield f'<path class="full" d="M{x:.1f} {y:.1f}v{-r}a7 7 0 0 1 {r} {r}Z"/>'
    elif kind == 'buoyancy':
        yield f'<circle class="ring" cx="{x:.1f}" cy="{y:.1f}" r="6"/>'
        yield f'<circle class="full" cx="{x:.1f}" cy="{y:.1f}" r="1.8"/>'
    else:
        yield f'<path class="ring" d="M{x - 6:.1f} {y:.1f}l6 -6l6 6l-6 6Z"/>'


def _draw_legend(x: float, y: float, scale: float, hull: bool) -> Iterator[str]:
    """Yield the legend and a scale bar."""
    rows = [('gravity', 'CG: centre of gravity')]
    if hull:
        rows.append(('buoyancy', 'CB: centre of buoyancy'))
        rows.append(('pressure', 'CP: centre of pressure'))
    for k, (kind, words) in enumerate(rows):
        symbol = ''.join(draw_center_symbol(kind, x + 8, y + 24.0 * k))
        yield f'<g class="mark {kind}">{symbol}</g>'
        yield f'<text class="key" x="{x + 26:.1f}" y="{y + 4 + 24.0 * k:.1f}">{words}</text>'
    z = y + 24.0 * len(rows)
    yield f'<g class="rotor">{_draw_arrow(x - 2, z, 22, 0)}</g>'
    yield f'<text class="key" x="{x + 26:.1f}" y="{z + 4:.1f}">'
    yield 'thrust; two heads: reversible</text>'
    yield f'<g class="rotor"><circle class="disc" cx="{x + 8}" cy="{z + 24}" r="8"/>'
    yield f'<circle class="tip" cx="{x + 8}" cy="{z + 24}" r="2.4"/></g>'
    yield f'<text class="key" x="{x + 26:.1f}" y="{z + 28:.1f}">towards you; crossed: away</text>'
    # The longest round length that fits 160 px
    bar = max(step for step in BAR_LENGTHS if step * scale <= 160.0 or step == BAR_LENGTHS[0])
    end = x + bar * scale
    name = f'{bar:g} m' if bar >= 1.0 else f'{100 * bar:g} cm'
    yield f'<path class="bar-line" d="M{x:.1f} {z + 52}v8H{end:.1f}v-8"/>'
    yield f'<text class="key" x="{x:.1f}" y="{z + 76:.1f}">{name}</text>'

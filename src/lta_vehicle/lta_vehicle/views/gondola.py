"""Draw the parts below the hull, enlarged and seen from ahead, with a colour per layer."""

from collections.abc import Iterator, Sequence
from html import escape
from typing import Final, final, NamedTuple

from lta_model import mass_properties
from lta_model.vehicle import Vehicle
from lta_report.palette import TIME
from lta_vehicle.views.three_views import draw_rotor, RotorArrow, Two, VIEWS

FRONT: Final = VIEWS[1]
GONDOLA_WIDTH: Final = 660.0  # px; of the whole drawing, unless a label is longer
LETTER_WIDTH: Final = 7.2  # px, mean width of a letter of a label
MOST_WIDTH, MOST_HEIGHT = 400.0, 260.0  # px; limits of the enlarged part
LEFT_MARGIN, TOP_MARGIN, LOWER_MARGIN = 40.0, 64.0, 26.0  # px; margins
TITLE_HEIGHT: Final = 28.0  # px for the title
LABEL_DISTANCE: Final = 19.0  # px from one label to the next
LARGEST_WIDTH: Final = 0.75  # of the hull's width; wider parts are large enough in the three views
LAYER_COLOUR_COUNT: Final = len(TIME)


@final
class GondolaPart(NamedTuple):
    """A part seen from ahead: centre and half sizes [m], colour index and description."""

    middle: Two
    half: Two
    colour: int
    about: str


@final
class GondolaLabel(NamedTuple):
    """The label of a layer: text, end of its leader line [m] and colour index."""

    words: str
    at: Two
    colour: int


def draw_gondola(vehicle: Vehicle) -> str:
    """Return an SVG element, or '' without small parts below a hull."""
    half = mass_properties.half_axes(vehicle.file.hull)
    boxes, layers = _collect_parts(vehicle)
    if not any(half) or not boxes:
        return ''
    rotors = [
        RotorArrow(
            FRONT.project(r.place),
            FRONT.project(r.axis),
            FRONT.depth(r.axis),
            r.reversible,
            r.name,
        )
        for r in vehicle.rotors
        if r.place[2] < 0.0
    ]
    low, high = _bounding_box(boxes, [rotor.at for rotor in rotors])
    # Parts nearly as wide as the hull are legible in the three views already
    if high[0] - low[0] > 2.0 * LARGEST_WIDTH * half[1]:
        return ''
    scale = min(MOST_WIDTH / (high[0] - low[0]), MOST_HEIGHT / max(high[1] - low[1], 1e-3))
    height = (
        max((high[1] - low[1]) * scale, LABEL_DISTANCE * len(layers)) + TOP_MARGIN + LOWER_MARGIN
    )

    def to_pixels(place: Sequence[float]) -> Two:
        return LEFT_MARGIN + (place[0] - low[0]) * scale, TOP_MARGIN + (high[1] - place[1]) * scale

    edge = to_pixels(high)[0]
    longest = max(len(layer.words) for layer in layers)
    width = max(GONDOLA_WIDTH, edge + LEFT_MARGIN + LETTER_WIDTH * longest)
    body = [
        # A nested SVG clips the hull, which is larger than the picture
        f'<svg x="0" y="{TITLE_HEIGHT}" width="{edge + LEFT_MARGIN:.0f}" '
        f'height="{height - TITLE_HEIGHT:.0f}">',
        _draw_hull(to_pixels((0.0, 0.0)), half[1] * scale, half[2] * scale),
        '</svg>',
        # Large parts first, so that they do not hide small ones
        *(_draw_part(box, to_pixels, scale) for box in sorted(boxes, key=_box_area, reverse=True)),
        *(line for rotor in rotors for line in draw_rotor(rotor, *to_pixels(rotor.at))),
        *_draw_labels(layers, to_pixels, edge + LEFT_MARGIN),
        '<text class="of" x="4" y="16">Below the hull, from ahead, enlarged</text>',
    ]
    return (
        f'<svg class="views detail" viewBox="0 0 {width:.0f} {height:.0f}" role="img" '
        f'aria-label="Layers below the hull, enlarged.">{"".join(body)}</svg>'
    )


def _collect_parts(vehicle: Vehicle) -> tuple[list[GondolaPart], list[GondolaLabel]]:
    """Return the parts below the hull centre and a label for each layer."""
    boxes: list[GondolaPart] = []
    layers: list[GondolaLabel] = []
    for name, parts in vehicle.file.layers.items():
        own = [
            (label, part, FRONT.project(part.position.vector), FRONT.project(part.size.vector))
            for label, part in parts.items()
            if part.shape == 'box' and part.position.vector[2] < 0.0
        ]
        if not own:
            continue
        colour = len(layers) % LAYER_COLOUR_COUNT
        mass = sum(part.mass.si for _, part, _, _ in own)
        for label, part, middle, size in own:
            half = (0.5 * size[0], 0.5 * size[1])
            about = f'{label.replace("_", " ")}: {1e3 * part.mass.si:.1f} g'
            boxes.append(GondolaPart(middle, half, colour, about))
        end = max(middle[0] + 0.5 * size[0] for _, _, middle, size in own)
        # The leader line ends at the height of the layer's centre of mass
        depth = sum(part.mass.si * middle[1] for _, part, middle, _ in own) / mass
        here = '' if len(own) == len(parts) else ' here'  # the rest of the layer is above
        words = f'{name.replace("_", " ")}  {1e3 * mass:.1f} g{here}'
        layers.append(GondolaLabel(words, (end, depth), colour))
    place = vehicle.file.trim.ballast_position
    if place is not None and place.vector[2] < 0.0 and boxes:
        middle, colour = FRONT.project(place.vector), len(layers) % LAYER_COLOUR_COUNT
        # Ballast has no size in the file; draw 2 cm by 6 mm
        boxes.append(GondolaPart(middle, (0.01, 0.003), colour, 'ballast'))
        words = f'ballast  {1e3 * vehicle.ballast_mass:.1f} g'
        layers.append(GondolaLabel(words, (middle[0] + 0.01, middle[1]), colour))
    return boxes, layers


def _bounding_box(boxes: Sequence[GondolaPart], points: Sequence[Two]) -> tuple[Two, Two]:
    lows = [(b.middle[0] - b.half[0], b.middle[1] - b.half[1]) for b in boxes] + [*points]
    highs = [(b.middle[0] + b.half[0], b.middle[1] + b.half[1]) for b in boxes] + [*points]
    low = min(x for x, _ in lows), min(y for _, y in lows)
    high = max(x for x, _ in highs), max(y for _, y in highs)
    return low, high


def _box_area(box: GondolaPart) -> float:
    return box.half[0] * box.half[1]


def _draw_hull(middle: Two, wide: float, tall: float) -> str:
    x, y = middle[0], middle[1] - TITLE_HEIGHT
    return f'<ellipse class="hull" cx="{x:.1f}" cy="{y:.1f}" rx="{wide:.1f}" ry="{tall:.1f}"/>'


def _draw_part(box: GondolaPart, at: object, scale: float) -> str:
    x, y = at(box.middle)  # type: ignore[operator]
    # At least 2.4 px, so that thin parts stay visible
    a, b = max(box.half[0] * scale, 1.2), max(box.half[1] * scale, 1.2)
    return (
        f'<rect class="part layer{box.colour}" x="{x - a:.1f}" y="{y - b:.1f}" '
        f'width="{2 * a:.1f}" height="{2 * b:.1f}"><title>{escape(box.about)}</title></rect>'
    )


def _draw_labels(layers: Sequence[GondolaLabel], at: object, x: float) -> Iterator[str]:
    """Yield the labels at the right edge with their leader lines, from top to bottom."""
    ordered = sorted(layers, key=lambda layer: -layer.at[1])
    ends = [at(layer.at) for layer in ordered]  # type: ignore[operator]
    middle = sum(end[1] for end in ends) / len(ends)
    # Centre the block of labels on the parts, but keep it below the title
    first = max(middle - 0.5 * LABEL_DISTANCE * (len(ends) - 1), 30.0)
    for k, (layer, (p, q)) in enumerate(zip(ordered, ends, strict=True)):
        y = first + LABEL_DISTANCE * k
        yield f'<path class="leader layer{layer.colour}" d="M{p:.1f} {q:.1f}'
        yield f'L{x - 14:.1f} {y:.1f}H{x - 2:.1f}"/>'
        yield f'<text x="{x + 3:.1f}" y="{y + 4:.1f}">{escape(layer.words)}</text>'

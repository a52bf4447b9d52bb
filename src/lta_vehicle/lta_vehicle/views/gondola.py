# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draw the parts below the hull, enlarged and seen from ahead, with a colour per layer."""

from collections.abc import Iterator, Sequence
from html import escape
from typing import Final, final, NamedTuple

from lta_model.vehicle import Vehicle
from lta_report.palette import TIME
from lta_vehicle.views.three_views import (
    draw_outline,
    draw_rotor,
    outline_part,
    PartOutline,
    project_vehicle,
    Two,
    VIEWS,
    ViewShapes,
)

GONDOLA_WIDTH: Final = 660.0  # px; of the whole drawing, unless a label is longer
LETTER_WIDTH: Final = 7.2  # px, mean width of a letter of a label
MOST_WIDTH, MOST_HEIGHT = 400.0, 260.0  # px; limits of the enlarged part
LEFT_MARGIN, TOP_MARGIN, LOWER_MARGIN = 40.0, 64.0, 26.0  # px; margins
TITLE_HEIGHT: Final = 28.0  # px for the title
LABEL_DISTANCE: Final = 19.0  # px from one label to the next
LARGEST_WIDTH: Final = 0.75  # of the hull's width; wider parts are large enough in the three views


@final
class GondolaLayer(NamedTuple):
    """A layer below the hull: its parts, its label, and the end of its leader line [m]."""

    parts: Sequence[PartOutline]
    words: str
    at: Two


def draw_gondola(vehicle: Vehicle) -> str:
    """Return an SVG element, or '' without small parts below a hull."""
    shapes = project_vehicle(vehicle, VIEWS[1], 0.0)
    layers = _list_layers(vehicle)
    if shapes.hull is None or not layers:
        return ''
    # By area: large parts first, so that they do not hide small ones
    parts = sorted(
        ((part, k % len(TIME)) for k, layer in enumerate(layers) for part in layer.parts),
        key=lambda each: -each[0].half[0] * each[0].half[1],
    )
    rotors = [rotor for rotor in shapes.rotors if rotor.at[1] < 0.0]
    low, high = ViewShapes(shapes.view, None, [part for part, _ in parts], rotors, ()).corners
    # Parts nearly as wide as the hull are legible in the three views already
    if high[0] - low[0] > 2.0 * LARGEST_WIDTH * shapes.hull.half[0]:
        return ''
    scale = min(MOST_WIDTH / (high[0] - low[0]), MOST_HEIGHT / max(high[1] - low[1], 1e-3))
    height = (
        max((high[1] - low[1]) * scale, LABEL_DISTANCE * len(layers)) + TOP_MARGIN + LOWER_MARGIN
    )

    def to_pixels(place: Sequence[float]) -> Two:
        return LEFT_MARGIN + (place[0] - low[0]) * scale, TOP_MARGIN + (high[1] - place[1]) * scale

    edge = to_pixels(high)[0] + LEFT_MARGIN
    width = max(GONDOLA_WIDTH, edge + LETTER_WIDTH * max(len(layer.words) for layer in layers))
    body = [
        # A nested SVG clips the hull, which is larger than the picture
        f'<svg x="0" y="{TITLE_HEIGHT}" width="{edge:.0f}" height="{height - TITLE_HEIGHT:.0f}" '
        f'viewBox="0 {TITLE_HEIGHT} {edge:.0f} {height - TITLE_HEIGHT:.0f}">',
        draw_outline(shapes.hull, to_pixels, scale, 'hull'),
        '</svg>',
        *(draw_outline(part, to_pixels, scale, f'part layer{k}') for part, k in parts),
        *(line for rotor in rotors for line in draw_rotor(rotor, *to_pixels(rotor.at))),
        *_draw_labels([(layer.words, to_pixels(layer.at)) for layer in layers], edge),
        '<text class="of" x="4" y="16">Below the hull, from ahead, enlarged</text>',
    ]
    return (
        f'<svg class="views detail" viewBox="0 0 {width:.0f} {height:.0f}" role="img" '
        f'aria-label="Layers below the hull, enlarged.">{"".join(body)}</svg>'
    )


def _list_layers(vehicle: Vehicle) -> list[GondolaLayer]:
    """Return the layers with parts below the hull centre."""
    front, layers = VIEWS[1], []
    for name, parts in vehicle.file.layers.items():
        own = {
            key: part
            for key, part in parts.items()
            if part.shape == 'box' and part.position.vector[2] < 0.0
        }
        if not own:
            continue
        outlines = [outline_part(front, name, key, part) for key, part in own.items()]
        mass = sum(part.mass.si for part in own.values())
        # The leader line ends at the height of the layer's centre of mass
        depth = sum(part.mass.si * part.position.vector[2] for part in own.values()) / mass
        here = '' if len(own) == len(parts) else ' here'  # the rest of the layer is above
        words = f'{name.replace("_", " ")}  {1e3 * mass:.1f} g{here}'
        end = max(each.middle[0] + each.half[0] for each in outlines)
        layers.append(GondolaLayer(outlines, words, (end, depth)))
    place = vehicle.file.trim.ballast_position
    if place is not None and place.vector[2] < 0.0 and layers:
        x, y = front.project(place.vector)
        # Ballast has no size in the file; draw 2 cm by 6 mm
        outline = PartOutline('box', (x, y), (0.01, 0.003), 'ballast', 'ballast')
        words = f'ballast  {1e3 * vehicle.ballast_mass:.1f} g'
        layers.append(GondolaLayer([outline], words, (x + 0.01, y)))
    return layers


def _draw_labels(labels: Sequence[tuple[str, Two]], x: float) -> Iterator[str]:
    """Yield the labels at the right edge with their leader lines, from top to bottom."""
    ordered = sorted(enumerate(labels), key=lambda each: each[1][1][1])
    middle = sum(end[1] for _, end in labels) / len(labels)
    # Centre the block of labels on the parts, but keep it below the title
    first = max(middle - 0.5 * LABEL_DISTANCE * (len(labels) - 1), 30.0)
    for row, (k, (words, (p, q))) in enumerate(ordered):
        y = first + LABEL_DISTANCE * row
        yield f'<path class="leader layer{k % len(TIME)}" d="M{p:.1f} {q:.1f}'
        yield f'L{x - 14:.1f} {y:.1f}H{x - 2:.1f}"/>'
        yield f'<text x="{x + 3:.1f}" y="{y + 4:.1f}">{escape(words)}</text>'

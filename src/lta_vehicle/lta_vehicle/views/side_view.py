"""Draw the side view of a vehicle in braille dots by plotext, for terminals."""

import math
from typing import Final

from lta_vehicle.figures.mass_budget import CENTIMETRES
from lta_vehicle.figures.sheet import VehicleSheet
from lta_vehicle.views.projection import PartOutline, project_vehicle, VIEWS
import numpy as np
from numpy.typing import NDArray
import plotext
from rich.text import Text

ARROWS: Final = '→↗↑↖←↙↓↘'
MARK_COLOURS: Final = {'G': 'red', 'B': 'blue'}
TALLEST: Final = 24  # characters

Array = NDArray[np.float64]


def draw_side_view(sheet: VehicleSheet, width: int) -> Text:
    """Return the side view, nose to the right, with CG (G), CB (B) and thrust arrows."""
    cp = sheet.by_key.get('cp_x')
    ahead = 0.0 if cp is None or cp.value is None else cp.value / CENTIMETRES
    projection = project_vehicle(sheet.vehicle, VIEWS[0], ahead)
    (left, low), (right, high) = projection.bounds
    # A character has 2 by 4 braille dots; 3 dots of margin on each side
    scale = (2 * width - 6) / max(right - left, 1e-3)
    scale = min(scale, (4 * TALLEST - 6) / max(high - low, 1e-3))
    height = math.ceil(((high - low) * scale + 6) / 4)
    plotext.terminal.limit(False, False)  # `width` holds, also in a pipe
    figure = plotext.figure.clear()
    figure.theme('colorless')
    figure.plot_size(width, height)
    figure.axes(False)
    # Coordinates are dots from the lower left corner
    for axis, count in (('x', 2 * width), ('y', 4 * height)):
        figure.ruler(axis).lim(0, count - 1).frequency(0)

    def to_dots(place: tuple[float, float]) -> tuple[float, float]:
        return 3 + (place[0] - left) * scale, 3 + (place[1] - low) * scale

    def draw_letter(x: float, y: float, letter: str, colour: str) -> None:
        figure.draw(figure.text(x, y, plotext.colorize(letter, (colour, None, 'bold'))))

    for shape in (*projection.parts, *([projection.hull] if projection.hull else [])):
        x, y = trace_outline(shape, to_dots(shape.middle), scale)
        outline = figure.signal(x.tolist(), y.tolist(), marker='braille')
        outline.lines()
        figure.draw(outline)
    for arm in projection.arms:
        (x1, y1), (x2, y2) = map(to_dots, arm)
        # Every second dot: arms are dotted lines
        count = max(2, round(math.hypot(x2 - x1, y2 - y1) / 2))
        x, y = np.linspace(x1, x2, count), np.linspace(y1, y2, count)
        figure.draw(figure.signal(x.tolist(), y.tolist(), marker='braille'))
    for rotor in projection.rotors:
        # Arrows of rotors that point nearly at the viewer would be misleading
        if math.hypot(*rotor.along) > 0.3:
            turn = math.atan2(rotor.along[1], rotor.along[0])
            arrow = ARROWS[round(turn / (math.pi / 4.0)) % 8]
            across, up = to_dots(rotor.at)
            draw_letter(across + 4 * math.cos(turn), up + 5 * math.sin(turn), arrow, 'green')
    for mark in reversed(projection.marks):  # the first stays on top
        # The second letter of CG and CB
        if (letter := mark.letters[1:2].upper()) in MARK_COLOURS:
            draw_letter(*to_dots(mark.at), letter, MARK_COLOURS[letter])
    picture = Text.from_ansi(str(figure.build()))
    picture.append('side view, nose right: ', 'dim')
    picture.append('G', f'bold {MARK_COLOURS["G"]}')
    picture.append(' gravity, ', 'dim')
    if sheet.vehicle.file.hull.shape != 'none':
        picture.append('B', f'bold {MARK_COLOURS["B"]}')
        picture.append(' buoyancy', 'dim')
    return picture


def trace_outline(
    shape: PartOutline, middle: tuple[float, float], scale: float
) -> tuple[Array, Array]:
    """Return the points of the outline of an ellipse or a box."""
    turn = np.linspace(0.0, 2.0 * math.pi, 65)
    p, q = np.cos(turn), np.sin(turn)
    if shape.kind == 'box':
        most = np.maximum(abs(p), abs(q))
        # Project the circle onto the square
        p, q = p / most, q / most
    return middle[0] + shape.half[0] * scale * p, middle[1] + shape.half[1] * scale * q

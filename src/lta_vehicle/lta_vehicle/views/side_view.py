"""Draw the side view of a vehicle in braille dots, for terminals."""

import math
from typing import Final

from lta_report.braille_canvas import BrailleCanvas
from lta_vehicle.figures.mass_budget import CENTIMETRES
from lta_vehicle.figures.sheet import VehicleSheet
from lta_vehicle.views.projection import PartOutline, project_vehicle, VIEWS
from rich.text import Text

ARROWS: Final = '→↗↑↖←↙↓↘'
STYLES: Final = {'G': 'bold red', 'B': 'bold blue'}
TALLEST: Final = 24  # characters


def draw_side_view(sheet: VehicleSheet, width: int) -> Text:
    """Return the side view, nose to the right, with CG (G), CB (B) and thrust arrows."""
    cp = sheet.by_key.get('cp_x')
    ahead = 0.0 if cp is None or cp.value is None else cp.value / CENTIMETRES
    shown = project_vehicle(sheet.vehicle, VIEWS[0], ahead)
    (left, low), (right, high) = shown.bounds
    # A character has 2 by 4 braille dots; 3 dots of margin on each side
    scale = (2 * width - 6) / max(right - left, 1e-3)
    scale = min(scale, (4 * TALLEST - 6) / max(high - low, 1e-3))
    canvas = BrailleCanvas(width, math.ceil(((high - low) * scale + 6) / 4))

    def to_dots(place: tuple[float, float]) -> tuple[float, float]:
        return 3 + (place[0] - left) * scale, 3 + (high - place[1]) * scale

    for shape in (*shown.parts, *([shown.hull] if shown.hull else [])):
        draw_outline(canvas, shape, to_dots(shape.middle), scale)
    for arm in shown.arms:
        (x1, y1), (x2, y2) = map(to_dots, arm)
        count = max(2, round(math.hypot(x2 - x1, y2 - y1)))
        # Every second dot: arms are dotted lines
        for k in range(0, count + 1, 2):
            canvas.draw_dot(x1 + (x2 - x1) * k / count, y1 + (y2 - y1) * k / count)
    for mark in shown.marks:
        # The second letter of CG and CB
        if (letter := mark.letters[1:2].upper()) in STYLES:
            canvas.draw_letter(*to_dots(mark.at), letter, STYLES[letter])
    for rotor in shown.rotors:
        # Arrows of rotors that point nearly at the viewer would be misleading
        if math.hypot(*rotor.along) > 0.3:
            turn = math.atan2(rotor.along[1], rotor.along[0])
            arrow = ARROWS[round(turn / (math.pi / 4.0)) % 8]
            x, y = to_dots(rotor.at)
            canvas.draw_letter(x + 4 * math.cos(turn), y - 5 * math.sin(turn), arrow, 'bold green')
    picture = canvas.render_text()
    picture.append('side view, nose right: ', 'dim')
    picture.append('G', STYLES['G'])
    picture.append(' gravity, ', 'dim')
    if sheet.vehicle.file.hull.shape != 'none':
        picture.append('B', STYLES['B'])
        picture.append(' buoyancy', 'dim')
    return picture


def draw_outline(
    canvas: BrailleCanvas, shape: PartOutline, middle: tuple[float, float], scale: float
) -> None:
    """Draw the outline of an ellipse or a box."""
    (x, y), a, b = middle, shape.half[0] * scale, shape.half[1] * scale
    count = max(8, round(4 * (a + b)))
    for k in range(count):
        turn = 2.0 * math.pi * k / count
        p, q = math.cos(turn), math.sin(turn)
        if shape.kind == 'box':
            most = max(abs(p), abs(q))
            # Project the circle onto the square
            p, q = p / most, q / most
        canvas.draw_dot(x + a * p, y + b * q)

"""Sketch the tests of an afternoon for the pilot: how the vehicle is held, pushed or turned."""

from collections.abc import Sequence
from html import escape
import math
from typing import Final

from lta_discovery.lab_tests.design import LabTest

# Box of a sketch, with the hull in its middle. [px]
VIEW: Final = '-84 -66 168 132'
# Tests in which the vehicle turns about the vertical or moves sideways are seen from above
TOP_VIEW_TESTS: Final = ('yaw', 'sway')
HULL_OUTLINE: Final = '<ellipse rx="44" ry="30"/>'
NOSE: Final = '<path d="M44 0 l-11 -5 v10 z" class="ink"/>'
GONDOLA: Final = '<rect x="-12" y="31" width="24" height="8" class="ink"/>'
SKETCH_STYLE: Final = (
    '<style>.sketches { display: flex; flex-wrap: wrap; gap: 8px 16px; } '
    '.sketches figure { margin: 0; width: 160px; text-align: center; font-size: 13px; } '
    '.sketches svg { fill: none; stroke: var(--soft); stroke-width: 1.5; } '
    '.sketches .ink { fill: var(--soft); stroke: none; } '
    '.sketches .move { stroke: var(--accent); stroke-width: 3; } '
    '.sketches .tip { fill: var(--accent); stroke: none; }</style>'
)


def draw_sketches(tests: Sequence[LabTest]) -> str:
    """Return a row of sketches as HTML, one for each test."""
    figures = ''.join(
        f'<figure><svg viewBox="{VIEW}" role="img" aria-label="{escape(test.name)}">'
        f'{draw_sketch(test)}</svg>{escape(test.name)}<br><small>{name_view(test)}</small></figure>'
        for test in tests
    )
    return f'{SKETCH_STYLE}<div class="sketches">{figures}</div>'


def name_view(test: LabTest) -> str:
    """Return from where a test is seen."""
    if test.kind == 'spin_down' or test.axis in TOP_VIEW_TESTS:
        return 'from above, nose to the right'
    return 'from behind' if test.axis == 'roll' else 'from the right side'


def draw_sketch(test: LabTest) -> str:
    """Return the vehicle, and an arrow for what moves it."""
    view = name_view(test)
    below = '' if view.startswith('from above') else GONDOLA
    body = HULL_OUTLINE + below + ('' if view == 'from behind' else NOSE)
    way = -1.0 if test.variant == 'reverse' else 1.0
    if test.kind == 'swing':
        held = f'<g transform="rotate({math.degrees(test.tilt):.0f})">{body}</g>'
        return f'<g stroke-dasharray="3 3">{body}</g>{held}'
    if test.kind == 'spin_down' or test.axis in ('roll', 'pitch', 'yaw'):
        return body + draw_turn(way)
    if test.kind == 'step':
        # Forward is right, left and up are up in the sketch
        along, up = (48.0 * way, 0.0) if test.axis == 'surge' else (0.0, -34.0 * way)
        return body + draw_arrow(along, up)
    if test.kind == 'free_flight':
        return body + '<path d="M-72 50 q12 -18 24 0 t24 0 t24 0 t24 0 t24 0 t24 0" class="move"/>'
    return body


def draw_arrow(along: float, up: float) -> str:
    """Return a straight arrow from the edge of the hull, right and down in the sketch. [px]"""
    size = math.hypot(along, up)
    x, y = along / size, up / size
    end = (1.5 * along, 1.5 * up)
    tip = f'M{end[0] + 10 * x} {end[1] + 10 * y} l{-10 * x - 6 * y} {-10 * y + 6 * x} '
    return (
        f'<path d="M{along} {up} L{end[0]} {end[1]}" class="move"/>'
        f'<path d="{tip}l{12 * y} {-12 * x} z" class="tip"/>'
    )


def draw_turn(way: float) -> str:
    """Return an arrow around the hull; counter-clockwise in the sketch if `way` is positive."""
    return (
        f'<g transform="scale(1 {way:g})"><path d="M52 24 A58 46 0 0 0 40 -34" class="move"/>'
        '<path d="M31 -41 l4 13 l10 -9 z" class="tip"/></g>'
    )

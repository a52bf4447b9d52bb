# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sketch the tests of an afternoon for the pilot: how the vehicle is held, pushed or turned."""

from collections.abc import Sequence
from html import escape
import math
from typing import Final

from lta_discovery.lab_tests.design import LabTest

# Seen from above, where the vehicle turns about the vertical or moves sideways
TOP_VIEW: Final = 'from above, nose to the right'
SKETCH_VIEW: Final = '-84 -66 168 132'  # of a sketch, with the hull in its middle [px]
HULL: Final = '<ellipse rx="44" ry="30"/>'
NOSE: Final = '<path d="M44 0 l-11 -5 v10 z" class="ink"/>'
GONDOLA: Final = '<rect x="-12" y="31" width="24" height="8" class="ink"/>'
STYLE: Final = (
    '<style>.sketches { display: flex; flex-wrap: wrap; gap: 8px 16px; } '
    '.sketches figure { margin: 0; width: 150px; text-align: center; font-size: 13px; } '
    '.sketches svg { fill: none; stroke: var(--soft); stroke-width: 1.5; } '
    '.sketches .ink { fill: var(--soft); stroke: none; } '
    '.sketches .move { stroke: var(--accent); stroke-width: 3; } '
    '.sketches .tip { fill: var(--accent); stroke: none; }</style>'
)
# Arrows to the right and counter-clockwise
PUSH_ARROW: Final = (
    '<path d="M48 0 H70" class="move"/><path d="M82 0 l-14 -7 v14 z" class="tip"/>'
)  # fmt: skip
TURN: Final = (
    '<path d="M52 24 A58 46 0 0 0 40 -34" class="move"/>'
    '<path d="M31 -41 l4 13 l10 -9 z" class="tip"/>'
)
WANDER: Final = '<path d="M-72 50 q12 -18 24 0 t24 0 t24 0 t24 0 t24 0 t24 0" class="move"/>'


def draw_sketches(tests: Sequence[LabTest]) -> str:
    """Return a row of sketches as HTML, one for each test."""
    figures = ''.join(
        f'<figure><svg viewBox="{SKETCH_VIEW}" role="img" aria-label="{escape(test.name)}">'
        f'{draw_sketch(test)}</svg>{escape(test.name)}<br><small>{name_view(test)}</small></figure>'
        for test in tests
    )
    return f'{STYLE}<div class="sketches">{figures}</div>'


def name_view(test: LabTest) -> str:
    """Return from where a test is seen."""
    if test.kind == 'spin_down' or test.axis in ('yaw', 'sway'):
        return TOP_VIEW
    return 'from behind' if test.axis == 'roll' else 'from the right side'


def draw_sketch(test: LabTest) -> str:
    """Return the vehicle, and what moves it."""
    view = name_view(test)
    body = HULL + ('' if view == TOP_VIEW else GONDOLA) + ('' if view == 'from behind' else NOSE)
    back = test.size < 0.0
    if test.kind == 'swing':
        held = f'<g transform="rotate({math.degrees(test.tilt):.0f})">{body}</g>'
        return f'<g stroke-dasharray="3 3">{body}</g>{held}'
    if test.kind == 'spin_down' or test.axis == 'yaw':
        return f'{body}<g transform="scale(1 {-1 if back else 1})">{TURN}</g>'
    if test.kind == 'step':  # forward is right, left and up are up in the sketch
        angle = (0 if test.axis == 'surge' else -90) + (180 if back else 0)
        near = 0 if test.axis == 'surge' else -14  # the hull is lower than it is long
        return f'{body}<g transform="rotate({angle}) translate({near} 0)">{PUSH_ARROW}</g>'
    return body + (WANDER if test.kind == 'free_flight' else '')

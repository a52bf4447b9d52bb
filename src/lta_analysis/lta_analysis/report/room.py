"""The room from above: walls, the lamp and its light, the goal and the start."""

import math

from lta_analysis.report.palette import GLOW, GOOD, INK, LAMP, PAPER, scale, VEIL, WALL
from lta_sim.light.lamp import direct
from lta_sim.scenario import Scenario
import numpy as np
from plotly.graph_objects import Contour, Figure, Scatter

CELL = 0.1  # m
MOST_CELLS = 160  # along a side; a hall is drawn in larger ones
FAINTEST, BRIGHTEST = 3.0, 12.0  # log2 of lx, the ends of the shading


def word(
    figure: Figure, place: tuple[float, float], text: str, colour: str, across: float, up: float
) -> None:
    """Write a word some px beside a place on the floor."""
    figure.add_annotation(
        x=place[0],
        y=place[1],
        xshift=across,
        yshift=up,
        text=text,
        font={'color': colour, 'size': 11},
        bgcolor=VEIL,
        borderpad=1,
    )


def draw_room(figure: Figure, scenario: Scenario, height: float) -> None:
    """Draw the room of a scenario, with the light at a height. [m]"""
    figure.add_trace(glow(scenario, height))
    length, width, _ = scenario.room.size.vector
    figure.add_shape(
        type='rect', x0=-length / 2, x1=length / 2, y0=-width / 2, y1=width / 2,
        line={'color': WALL, 'width': 3}, layer='below',
    )  # fmt: skip
    draw_goal(figure, scenario)
    x, y = scenario.start.position.vector
    figure.add_trace(
        Scatter(
            x=[x], y=[y], mode='markers', name='start', hoverinfo='skip',
            marker={'symbol': 'circle-open', 'size': 10, 'color': INK, 'line': {'width': 1.5}},
        )
    )  # fmt: skip
    word(figure, (x, y), 'start', INK, 0, -16)


def draw_goal(figure: Figure, scenario: Scenario) -> None:
    """Draw the lamp, and the circle within which it counts as reached."""
    x, y, _ = scenario.lamp.position.vector
    radius, frequency = scenario.goal.radius.si, scenario.lamp.frequency.si
    ahead, left, _ = scenario.lamp.facing.vector
    facing = math.degrees(math.atan2(left, ahead))
    figure.add_shape(
        type='circle', x0=x - radius, x1=x + radius, y0=y - radius, y1=y + radius,
        line={'color': GOOD, 'width': 1.5, 'dash': 'dash'},
    )  # fmt: skip
    figure.add_trace(
        Scatter(
            x=[x], y=[y], mode='markers', name='lamp',
            marker={
                'symbol': 'triangle-up', 'size': 15, 'color': LAMP,
                'angle': 90.0 - facing, 'line': {'color': PAPER, 'width': 1.5},
            },
            hovertemplate=f'lamp, {frequency:g} Hz<extra></extra>',
        )
    )  # fmt: skip
    word(figure, (x, y), f'lamp<br>{frequency:g} Hz', LAMP, 30, 0)
    word(figure, (x, y - radius), f'goal: within {radius:g} m', GOOD, 0, -10)


def glow(scenario: Scenario, height: float) -> Contour:
    """Return the lamp's direct light at a height, a shade for each factor of two."""
    length, width, _ = scenario.room.size.vector
    x, y = (
        np.linspace(-side / 2, side / 2, min(round(side / CELL), MOST_CELLS) + 1)
        for side in (length, width)
    )
    points = np.stack([*np.meshgrid(x, y), np.full((len(y), len(x)), height)], axis=-1)
    towards = np.array(scenario.lamp.position.vector) - points
    towards /= np.maximum(np.linalg.norm(towards, axis=-1, keepdims=True), CELL)
    light = direct(scenario.light_field.lamp, points, towards)
    return Contour(
        x=x.astype(np.float32),
        y=y.astype(np.float32),
        z=np.log2(np.maximum(light, 1.0)).astype(np.float32),
        name='light of the lamp',
        colorscale=scale(GLOW),
        showscale=False,
        zmin=FAINTEST,
        zmax=BRIGHTEST,
        contours={'start': FAINTEST + 1, 'end': BRIGHTEST, 'size': 1, 'coloring': 'fill'},
        line={'width': 0},
        hoverinfo='skip',
    )

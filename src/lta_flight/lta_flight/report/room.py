"""Draw the room from above: walls, lamps with their light, goals and start."""

import math

from lta_model.light.lamp import BeaconLamp, direct_illuminance
from lta_model.scenario import Scenario
from lta_model.scenario_light import LampScene
from lta_report.curves import Array
from lta_report.palette import build_color_scale, GLOW, GOOD, INK, LAMP, PAPER, VEIL, WALL
import numpy as np
from plotly.graph_objects import Contour, Figure, Scatter

MOST_TICKS = 12
CELL = 0.1  # m, grid of the shading
MOST_CELLS_PER_SIDE = 160  # per side; a hall gets larger cells
FAINTEST_LIGHT, BRIGHTEST = 3.0, 12.0  # log2 of lx: the shading covers 8 to 4096 lx


def choose_tick_distance(side: float) -> float:
    """Return the distance of ticks along the longer side of a room. [m]"""
    return next(step for step in (1.0, 2.0, 5.0, 10.0, 50.0, side) if side <= MOST_TICKS * step)


def draw_label(
    figure: Figure, place: tuple[float, float], text: str, colour: str, across: float, up: float
) -> None:
    """Write a word at some distance in px from a point on the floor."""
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
    """Draw the room of a scenario, with the light at some height. [m]"""
    figure.add_trace(build_light_contour(scenario, height))
    length, width, _ = scenario.room.size.vector
    figure.add_shape(
        type='rect', x0=-length / 2, x1=length / 2, y0=-width / 2, y1=width / 2,
        line={'color': WALL, 'width': 3}, layer='below',
    )  # fmt: skip
    draw_goals(figure, scenario)
    for name, lamp in scenario.lamps.items():
        draw_lamp(figure, name, lamp)
    x, y = scenario.start.position.vector
    figure.add_trace(
        Scatter(
            x=[x], y=[y], mode='markers', name='start', hoverinfo='skip',
            marker={'symbol': 'circle-open', 'size': 10, 'color': INK, 'line': {'width': 1.5}},
        )
    )  # fmt: skip
    draw_label(figure, (x, y), 'start', INK, 0, -16)


def draw_goals(figure: Figure, scenario: Scenario) -> None:
    """Draw the goal circle of each target lamp."""
    radius = scenario.goal.radius.si
    for x, y in scenario.goal_places:
        figure.add_shape(
            type='circle', x0=x - radius, x1=x + radius, y0=y - radius, y1=y + radius,
            line={'color': GOOD, 'width': 1.5, 'dash': 'dash'},
        )  # fmt: skip
        draw_label(figure, (x, y - radius), f'goal: within {radius:g} m', GOOD, 0, -10)


def draw_lamp(figure: Figure, name: str, lamp: LampScene) -> None:
    """Draw a lamp with its orientation."""
    x, y, _ = lamp.position.vector
    ahead, left, _ = lamp.facing.vector
    facing, frequency = math.degrees(math.atan2(left, ahead)), lamp.frequency.si
    figure.add_trace(
        Scatter(
            x=[x], y=[y], mode='markers', name=name,
            marker={
                'symbol': 'triangle-up', 'size': 15, 'color': LAMP,
                # Plotly rotates clockwise from up, facing is counter-clockwise from x
                'angle': 90.0 - facing, 'line': {'color': PAPER, 'width': 1.5},
            },
            hovertemplate=f'{name}, {frequency:g} Hz<extra></extra>',
        )
    )  # fmt: skip
    draw_label(figure, (x, y), f'{name}<br>{frequency:g} Hz', LAMP, 30, 0)


def build_light_contour(scenario: Scenario, height: float) -> Contour:
    """Return the direct light of all lamps at some height, with a shade per factor of two."""
    length, width, _ = scenario.room.size.vector
    x, y = (
        np.linspace(-side / 2, side / 2, min(round(side / CELL), MOST_CELLS_PER_SIDE) + 1)
        for side in (length, width)
    )
    points = np.stack([*np.meshgrid(x, y), np.full((len(y), len(x)), height)], axis=-1)
    # Direct light only; reflections would hide the pattern of the lamps
    light = sum(lamp_illuminance(lamp, points) for lamp in scenario.light_field.lamps)
    return Contour(
        x=x.astype(np.float32),
        y=y.astype(np.float32),
        z=np.log2(np.maximum(light, 1.0)).astype(np.float32),
        name='light of the lamps',
        colorscale=build_color_scale(GLOW),
        showscale=False,
        zmin=FAINTEST_LIGHT,
        zmax=BRIGHTEST,
        # One contour per factor of two
        contours={'start': FAINTEST_LIGHT + 1, 'end': BRIGHTEST, 'size': 1, 'coloring': 'fill'},
        line={'width': 0},
        hoverinfo='skip',
    )


def lamp_illuminance(lamp: BeaconLamp, points: Array) -> Array:
    """
    Return the illuminance by a lamp on planes that face it.

    `points`, shape (..., 3): positions [m, map]. The result has shape (...) [lx].
    """
    towards = np.array(lamp.position) - points
    # The minimum avoids a division by zero in the lamp itself
    towards /= np.maximum(np.linalg.norm(towards, axis=-1, keepdims=True), CELL)
    return direct_illuminance(lamp, points, towards)

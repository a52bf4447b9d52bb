# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A 3-D view of flights on a page: vehicles, their paths and what they sense, at the time cursor.

`scene.js` draws it with three.js. The shapes are those of the live view; tracks are sampled at
common times and encoded as 16-bit integers.
"""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
import itertools
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.drawing.scene import BASE, draw_body, ENVELOPE, vehicle_reach
from lta_model.drawing.shapes import EllipsoidShape, NO_SHIFT, Shape, ShapeEntity
from lta_model.mass_properties import half_axes
from lta_model.vehicle import Vehicle
from lta_report.html_elements import embed_data
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SCENE_RATE: Final = 20.0  # samples per second, enough for a slow blimp
MOST_SCENE_SAMPLES: Final = 1500  # samples of a flight, to limit the size of the page
DEFAULT_RADIUS: Final = 0.5  # m, of a hull that is not known
KEYS_HELP: Final = (
    'Drag, or Shift and the arrow keys, to turn the view; plus and minus zoom, 0 resets. '
    'The left and right arrow keys move the time.'
)
NO_WEBGL: Final = (
    'This browser has no WebGL, so the 3-D view is left out; '
    'the figures below show the same flight.'
)
FAN_READOUT: Final = {'time': ('time', '\N{NO-BREAK SPACE}s', 1, 1.0)}
PACES: Final = (0.25, 0.5, 1, 2, 4)  # speeds of play, by the usual one
SCENE_TRACKS: Final = ('position', 'turn', 'thrust', 'bearing', 'wind')


@final
@dataclass(frozen=True, slots=True)
class SceneRotor:
    """Place [m] and direction of thrust of a rotor in the body frame."""

    place: tuple[float, float, float]
    axis: tuple[float, float, float]


@final
@dataclass(frozen=True, slots=True)
class SceneFlight:
    """One vehicle in the view."""

    name: str  # shown beside the view
    colour: str  # light colour of the palette
    body: ShapeEntity | None  # shapes in the body frame; None draws only the path
    position: Array  # hull centre; NaN where unknown, shape (n, 3) [m, map]
    turn: Array  # attitude as quaternion x y z w, body to map, shape (n, 4)
    rotors: Sequence[SceneRotor] = ()  # rotors with an arrow
    thrust: Array | None = None  # thrust by full thrust, signed, shape (n, rotors) [1]
    # Azimuth and elevation of the lamp in the body frame, and their standard deviations; NaN
    # without a lamp, shape (n, 4) [rad]
    bearing: Array | None = None
    wind: Array | None = None  # air velocity, shape (n, 3) [m/s, map]
    ghost: bool = False  # whether to draw the body more transparent


@final
@dataclass(frozen=True, slots=True)
class SceneSet:
    """Flights over common times [s], and the columns that the page shows beside the time."""

    time: Array
    flights: Sequence[SceneFlight]
    columns: Mapping[str, Sequence[float | None]] = field(default_factory=dict)


@final
@dataclass(frozen=True, slots=True)
class FanFlight:
    """One of several flights of a vehicle."""

    name: str  # shown beside the view
    colour: str  # light colour of the palette
    # Time since the start [s], position [m, map] and attitude x y z w, shape (n, 8)
    track: Array


def sample_times(first: float, last: float) -> Array:
    """Return the times at which tracks are sampled [s]."""
    return np.linspace(
        first, last, min(MOST_SCENE_SAMPLES, int((last - first) * SCENE_RATE) + 2)
    )  # at least two


def render_scene(
    sets: Sequence[SceneSet],
    static_shapes: Sequence[ShapeEntity],
    caption: str,
    reach: float,
    follow: bool | None = None,
) -> str:
    """
    Return the panel of a 3-D view; empty without flights.

    Parameters
    ----------
    sets : sequence of SceneSet
        The first is shown; `Scene.select` in scene.js shows others.
    static_shapes : sequence of ShapeEntity
        What does not move, in the map frame.
    caption : str
        Plain text.
    reach : float
        Largest extent of a vehicle from its centre. [m]
    follow : bool, optional
        Whether the view follows the vehicle at first; by default on long flights.

    """
    sets = [each for each in sets if len(each.time)]
    if not sets:
        return ''
    data = {
        'reach': reach,
        'follow': follow,
        'standing': [encode_shape(shape) for entity in static_shapes for shape in entity.shapes],
        'sets': [encode_set(each) for each in sets],
    }
    names = ''.join(
        f'<li><i style="--light: {each.colour}" data-colour="{each.colour}"></i>'
        f'{escape(each.name)}</li>'
        for each in sets[0].flights
    )
    return (
        '<figure class="panel scene-panel" id="panel-scene" aria-labelledby="title-scene">'
        '<h2 id="title-scene">In 3-D</h2>'
        '<div class="scene" tabindex="0" role="application" aria-roledescription="3-D view" '
        f'aria-label="{escape(caption)} {KEYS_HELP}"></div>'
        f'<p class="scene-absent absent" hidden>{NO_WEBGL}</p>'
        f'<ul class="scene-names">{names}</ul>'
        '<p class="scene-buttons"><button type="button" data-view="follow" aria-pressed="false">'
        'Follow</button> <button type="button" data-view="whole" aria-pressed="true">'
        'Whole flight</button></p>'
        f'<figcaption>{escape(caption)} <span class="scene-keys">{KEYS_HELP}</span></figcaption>'
        f'{embed_data("scene", data)}</figure>'
    )


def render_fan(
    flights: Sequence[FanFlight],
    file: VehicleFile,
    static_shapes: Sequence[ShapeEntity],
    caption: str,
) -> tuple[str, str, dict[str, Sequence[float | None]]]:
    """
    Return the 3-D view, the time bar and the track of a page with several flights of one vehicle.

    They begin at the same time, and one that has ended stays where it ended. All are empty without
    flights.
    """
    if not flights:
        return '', '', {}
    body, reach, _ = draw_vehicle(file)
    time = sample_times(0.0, max(each.track[-1, 0] for each in flights))
    scene_flights = [
        SceneFlight(
            each.name,
            each.colour,
            body,
            interpolate_columns(time, each.track[:, 0], each.track[:, 1:4]),
            interpolate_attitude(time, each.track[:, 0], each.track[:, 4:]),
            ghost=True,
        )
        for each in flights
    ]
    scene_set = SceneSet(time, scene_flights)
    panel = render_scene([scene_set], static_shapes, caption, reach, follow=False)
    return panel, render_time_bar(FAN_READOUT, 'flights'), build_scene_track(scene_set)


def render_time_bar(readout: Mapping[str, tuple[str, str, int, float]], what: str) -> str:
    """
    Return the bar with the time cursor.

    `readout`: column of the track: its name, unit, number of digits and factor. `what`: what is
    played, such as 'flight'.
    """
    cells = ''.join(
        f'<div><dt>{escape(name)}</dt><dd data-value="{column}" data-unit="{escape(unit)}" '
        f'data-digits="{digits}" data-factor="{factor:g}"></dd></div>'
        for column, (name, unit, digits, factor) in readout.items()
    )
    paces = ''.join(
        f'<option value="{pace}"{" selected" if pace == 1 else ""}>&times; {pace:g}</option>'
        for pace in PACES
    )
    return (
        '<div id="bar" hidden>'
        f'<button id="play" type="button" aria-label="Play the {what}">▶\N{VARIATION SELECTOR-15}'
        f'</button><input id="time" type="range" aria-label="Time of the {what}">'
        f'<select id="pace" aria-label="Speed of play">{paces}</select>'
        f'<dl id="readout" aria-live="off">{cells}</dl></div>'
    )


def build_scene_track(scene_set: SceneSet) -> dict[str, Sequence[float | None]]:
    """Return the track of a page whose only replay is the 3-D view."""
    time = [round(float(each), 3) for each in scene_set.time]
    # Shown first: in the middle, where flights have moved apart
    return {'time': time, 'start': [time[len(time) // 2]], **scene_set.columns}


def encode_set(scene_set: SceneSet) -> dict[str, object]:
    """Return the JSON content of a set of flights."""
    return {
        'track': build_scene_track(scene_set),
        'flights': [encode_flight(each) for each in scene_set.flights],
    }


def encode_flight(flight: SceneFlight) -> dict[str, object]:
    """Return the JSON content of a flight."""
    tracks = {name: getattr(flight, name) for name in SCENE_TRACKS}
    return {
        'name': flight.name,
        'colour': flight.colour,
        'ghost': flight.ghost,
        'body': None if flight.body is None else [encode_shape(one) for one in flight.body.shapes],
        'rotors': [[each.place, each.axis] for each in flight.rotors],
        **{
            name: [pack_column(column) for column in values.T]
            for name, values in tracks.items()
            if values is not None
        },
    }


def encode_shape(shape: Shape) -> dict[str, object]:
    """Return the JSON content of a shape."""
    return {'kind': type(shape).__name__, **shape._asdict()}


def pack_column(values: Array) -> dict[str, object]:
    """Encode a line as 16-bit integers, to be multiplied by `scale`; the minimum means NaN."""
    largest = float(np.nanmax(np.abs(values), initial=0.0)) or 1.0
    # Below 32767, so that -32768 is free to mean NaN
    factor = largest / 32000.0
    numbers = np.where(np.isfinite(values), np.round(values / factor), -32768.0).astype('<i2')
    return {'scale': factor, 'data': b64encode(numbers.tobytes()).decode()}


def draw_vehicle(file: VehicleFile | None) -> tuple[ShapeEntity, float, Vehicle | None]:
    """Return the shapes, the reach [m] and the vehicle of a vehicle file, or a plain hull."""
    if file is not None:
        try:
            vehicle = Vehicle(file)
        except BadInput:  # such as a recorded vehicle with an effect that is not installed
            radius = max(half_axes(file.hull)) or DEFAULT_RADIUS
        else:
            return draw_body(vehicle), vehicle_reach(vehicle), vehicle
    else:
        radius = DEFAULT_RADIUS
    hull = EllipsoidShape(NO_SHIFT, (2 * radius, 2 * radius, 2 * radius), ENVELOPE)
    return ShapeEntity('vehicle', BASE, (hull,)), radius, None


def interpolate_columns(at: Array, time: Array, values: Array) -> Array:
    """Return columns, shape (n, k), linearly interpolated at other times; NaN stays NaN."""
    return np.stack([np.interp(at, time, column) for column in values.T], axis=1)


def interpolate_attitude(at: Array, time: Array, attitude: Array) -> Array:
    """Return unit quaternions, shape (n, 4), interpolated at other times."""
    # q and -q are the same attitude: choose the sign nearest to the one before
    signs = np.where(np.einsum('ij,ij->i', attitude[1:], attitude[:-1]) < 0.0, -1.0, 1.0)
    aligned = attitude * np.array([1.0, *itertools.accumulate(signs, lambda a, b: a * b)])[:, None]
    turn = interpolate_columns(at, time, aligned)
    return np.asarray(turn / np.maximum(np.linalg.norm(turn, axis=1, keepdims=True), 1e-9))


def hold_columns(at: Array, time: Array, values: Array, longest: float = np.inf) -> Array:
    """Return the last values at each time; NaN before the first, or `longest` [s] after one."""
    index = np.searchsorted(time, at, side='right') - 1
    is_recent = (index >= 0) & (at - time[np.maximum(index, 0)] <= longest)
    return np.asarray(np.where(is_recent[:, None], values[np.maximum(index, 0)], np.nan))


def to_json_numbers(values: Array) -> list[float | None]:
    """Return numbers for JSON, with None for NaN."""
    return [round(float(each), 3) if np.isfinite(each) else None for each in values]

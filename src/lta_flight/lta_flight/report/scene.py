# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The 3-D view of a flight: the drone with its rotors, its bearing of the lamp, and the wind."""

from typing import Final

from lta_data.bag.recorded_flight import list_robots, open_flight
from lta_data.bag.table import get_column
from lta_flight.report.results import find_phases
from lta_flight.report.view import FlightView
from lta_model.drawing.scene import draw_static_scene
from lta_model.mass_properties import half_axes
from lta_model.vehicle import Vehicle
from lta_report.curves import Array, interpolate
from lta_report.flight_scene import (
    draw_vehicle,
    hold_columns,
    interpolate_attitude,
    interpolate_columns,
    render_scene,
    sample_times,
    SceneFlight,
    SceneRotor,
    SceneSet,
    to_json_numbers,
)
from lta_report.palette import ESTIMATE, GOOD, LAMP, TRUTH
import numpy as np

LONGEST_HOLD: Final = 0.5  # s for which a bearing, a duty or a wind is shown
SCENE_CAPTION: Final = (
    'The true motion. Orange arrows: thrust of the rotors (square root of its share). Yellow '
    'arrow and cone: direction of the lamp that the drone steers by, with its standard deviation. '
    'Green arrow: wind. The path ahead is pale.'
)
COMPANIONS: Final = (GOOD, LAMP)
TRUE_MOTION: Final = 'ground_truth/odom'
POSITION_FIELD, ATTITUDE_FIELD = 'pose.pose.position', 'pose.pose.orientation'


def render_flight_scene(view: FlightView) -> str:
    """Return the panel of the 3-D view; empty without a true motion."""
    if not view.has_topics(TRUE_MOTION):
        return ''
    time = sample_times(*view.span)
    body, reach, vehicle = draw_vehicle(view.scene.vehicle)
    rotors, thrust = sample_thrust(view, vehicle, time)
    flights = [
        SceneFlight(
            'true motion',
            TRUTH,
            body,
            interpolate_columns(time, *view.read_vector(TRUE_MOTION, POSITION_FIELD)),
            interpolate_attitude(time, *view.read_vector(TRUE_MOTION, ATTITUDE_FIELD)),
            rotors,
            thrust,
            sample_bearing(view, time),
            sample_wind(view, time),
        )
    ]
    if view.has_topics('odom'):
        estimate = view.estimate
        place = np.stack([estimate.x, estimate.y, estimate.z], axis=1)
        flights.append(
            SceneFlight(
                'dead reckoning',
                ESTIMATE,
                None,
                interpolate_columns(time, estimate.time, place),
                np.zeros((len(time), 4)),
            )
        )
    flights += list_companions(view, time)
    scenario = view.scene.scenario
    static_shapes = [] if scenario is None else draw_static_scene(scenario)
    return render_scene([SceneSet(time, flights)], static_shapes, SCENE_CAPTION, reach)


def list_companions(view: FlightView, time: Array) -> list[SceneFlight]:
    """Return the other robots of the bag as ghosts."""
    bag, companions = view.flight.bag, list[SceneFlight]()
    for robot in list_robots(bag):
        if robot == view.flight.robot:
            continue
        other = FlightView(open_flight(bag, robot))
        if not other.has_topics(TRUE_MOTION):
            continue
        body, _, _ = draw_vehicle(other.scene.vehicle)
        # The time of each robot begins with its own first message
        here = time - (other.flight.start - view.flight.start) * 1e-9
        place = interpolate_columns(here, *other.read_vector(TRUE_MOTION, POSITION_FIELD))
        turn = interpolate_attitude(here, *other.read_vector(TRUE_MOTION, ATTITUDE_FIELD))
        colour = COMPANIONS[len(companions) % len(COMPANIONS)]
        companions.append(SceneFlight(robot, colour, body, place, turn, ghost=True))
    return companions


def sample_thrust(
    view: FlightView, vehicle: Vehicle | None, time: Array
) -> tuple[list[SceneRotor], Array | None]:
    """Return the rotors, and their thrust by full thrust, shape (n, rotors)."""
    if vehicle is None or not view.has_topics('motors'):
        return [], None
    duties = view.duties
    rotors = [each for each in vehicle.rotors if each.name in duties.names]
    if not rotors:
        return [], None
    order = [duties.names.index(each.name) for each in rotors]
    duty = np.nan_to_num(hold_columns(time, duties.time, duties.values[:, order], LONGEST_HOLD))
    quadratic, linear, full = (
        np.array([getattr(each, name) for each in rotors]) for name in ('a', 'b', 'full_thrust')
    )
    share = duty * (quadratic * np.abs(duty) + linear) / full
    return [SceneRotor(each.place, each.axis) for each in rotors], share


def sample_bearing(view: FlightView, time: Array) -> Array | None:
    """Return azimuth and elevation of the lamp and their deviations; None if never measured."""
    if not view.has_topics('light/estimate'):
        return None
    own, place = view.read_vector('light/estimate', 'pose.pose.position')
    names = [f'pose.covariance[{6 * row + column}]' for row in range(3) for column in range(3)]
    table = view.read_table('light/estimate')
    covariance = np.stack([get_column(table, name) for name in names], axis=1).reshape(-1, 3, 3)
    seen = np.isfinite(view.sighting.angle)
    angles = np.where(seen[:, None], direction_with_deviation(place, covariance), np.nan)
    return hold_columns(time, own + view.half_block_time, angles, LONGEST_HOLD)


def direction_with_deviation(place: Array, covariance: Array) -> Array:
    """
    Return azimuth, elevation and their standard deviations.

    `place`, shape (n, 3): position of the lamp in the body frame [m]. `covariance`, shape (n, 3,
    3): of the position [m2]. The result has shape (n, 4) [rad].
    """
    x, y, z = place.T
    azimuth, elevation = np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))
    distance = np.maximum(np.linalg.norm(place, axis=1), 1e-9)
    # Unit vectors across the ray: to the left, and up
    left = np.stack([-np.sin(azimuth), np.cos(azimuth), np.zeros_like(azimuth)], axis=1)
    up = np.stack(
        [
            -np.sin(elevation) * np.cos(azimuth),
            -np.sin(elevation) * np.sin(azimuth),
            np.cos(elevation),
        ],
        axis=1,
    )
    deviations = [
        np.sqrt(np.maximum(np.einsum('ni,nij,nj->n', axis, covariance, axis), 0.0)) / distance
        for axis in (left, up)
    ]
    return np.stack([azimuth, elevation, *deviations], axis=1)


def sample_wind(view: FlightView, time: Array) -> Array | None:
    """Return the air velocity; None if there was never any [m/s, map]."""
    if not view.has_topics('wind'):
        return None
    wind = hold_columns(time, *view.read_vector('wind', 'vector'), LONGEST_HOLD)
    return wind if np.nanmax(np.abs(wind), initial=0.0) > 0.0 else None


TRACK_RATE = 20.0  # samples per second, enough for a slow blimp
MOST_SAMPLES = 3000  # samples, to limit the size of the page


def build_track(view: FlightView) -> dict[str, list[float | None]]:
    """
    Return time, position, yaw, speed, distance, bearing and SNR at uniform times.

    Returns
    -------
    dict of str to list
        Columns of equal length in SI units, None where unknown; empty without a true motion.
        `start` is the time to show first, `radius` the radius of the hull.

    """
    if not view.has_topics('ground_truth/odom'):
        return {}
    first, last = view.span
    time = np.linspace(
        first, last, min(MOST_SAMPLES, int((last - first) * TRACK_RATE) + 2)
    )  # 2 points at least
    truth = view.truth
    columns = {
        part: interpolate(time, truth.time, getattr(truth, part))
        for part in ('x', 'y', 'z', 'yaw', 'speed')
    }
    columns['distance'] = interpolate(time, truth.time, view.goal.lamp_distance(truth))
    if view.has_topics('light/bearing'):
        columns['bearing'] = hold_latest(time, *view.bearing)
    elif view.goal.places:
        columns['bearing'] = interpolate(time, truth.time, view.goal.lamp_direction(truth))
    if view.has_topics('light/peaks'):
        when, parts = view.peaks
        columns['snr'] = hold_latest(time, when, parts['snr'].max(axis=1))
    phases = find_phases(view)
    begin = phases.search if np.isfinite(phases.search) else first
    vehicle = view.scene.vehicle
    columns |= {
        'time': time,
        # Late in the search, when the drone is near the lamp
        'start': np.array([begin + 0.75 * (phases.end - begin)]),
        'radius': np.array([0.5 if vehicle is None else half_axes(vehicle.hull)[0]]),
    }
    return {name: to_json_numbers(values) for name, values in columns.items()}


def hold_latest(time: Array, when: Array, values: Array) -> Array:
    """Return the last value at each time; NaN before the first."""
    index = np.searchsorted(when, time, side='right') - 1
    return np.asarray(np.where(index < 0, np.nan, values[np.maximum(index, 0)]))

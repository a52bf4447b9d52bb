"""The curves that a page needs to replay a flight, at uniform times."""

from lta_flight.report.results import find_phases
from lta_flight.report.view import FlightView
from lta_model.mass_properties import half_axes
from lta_report.curves import Array, interpolate
from lta_report.flight_scene import to_json_numbers
import numpy as np

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

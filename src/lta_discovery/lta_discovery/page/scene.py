"""The 3-D view of a study: each flight as measured, and as predicted before and after."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_discovery.page.flight_views import FlightOverlay
from lta_model.attitude import EulerAngles, to_quaternions
from lta_model.vehicle import Vehicle
from lta_report.flight_scene import (
    build_scene_track,
    draw_vehicle,
    render_scene,
    SceneFlight,
    SceneSet,
    to_json_numbers,
)
from lta_report.palette import ESTIMATE, TRUTH, WALL
import numpy as np

CAPTION: Final = (
    'Each piece of the flight starts at the measured state and is predicted without correction. '
    'The predictions are level, since only their position and heading are compared.'
)
NAMES: Final = (
    ('measured', WALL),
    ('predicted with the vehicle file', ESTIMATE),
    ('predicted with the learned effects', TRUTH),
)
READOUT: Final = {
    'time': ('time', '\N{NO-BREAK SPACE}s', 1, 1.0),
    'before': ('error before', '\N{NO-BREAK SPACE}cm', 0, 100.0),
    'after': ('error after', '\N{NO-BREAK SPACE}cm', 0, 100.0),
}


def render_study_scene(
    overlays: Sequence[FlightOverlay], vehicle: Vehicle | None
) -> tuple[str, Mapping[str, object]]:
    """Return the panel of the 3-D view and the track of the page; both empty without flights."""
    if not overlays:
        return '', {}
    body, reach, _ = draw_vehicle(None if vehicle is None else vehicle.file)
    sets = []
    for overlay in overlays:
        steps = np.arange(len(overlay.lines[0]), dtype=np.float64)
        time = overlay.begin + overlay.period * steps
        flights = []
        for (name, colour), line in zip(NAMES, overlay.lines, strict=True):
            level = np.zeros(len(line))
            yaw = np.radians(np.nan_to_num(line[:, 3]))
            turn = to_quaternions(EulerAngles(yaw, level, level))
            ghost = name != NAMES[0][0]
            flights.append(SceneFlight(name, colour, body, line[:, :3], turn, ghost=ghost))
        measured = flights[0].position
        errors = {
            column: to_json_numbers(np.linalg.norm(each.position - measured, axis=1))
            for column, each in zip(('before', 'after'), flights[1:], strict=True)
        }
        sets.append(SceneSet(time, flights, errors))
    return render_scene(sets, [], CAPTION, reach, follow=True), build_scene_track(sets[0])

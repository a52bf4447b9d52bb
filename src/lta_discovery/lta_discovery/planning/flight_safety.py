"""Check that a simulated flight is safe: clear of walls, upright, within limits, landed."""

import math
from typing import Final

from lta_discovery.planning.rehearsal import CLEAR, SimulatedFlight
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.readings import FlightOutcome
from lta_sim.scene_model import vehicle_reach
import numpy as np

MARGIN: Final = 0.3  # m between the hull and walls or ceiling
TILT: Final = math.radians(30.0)
FULL: Final = 0.98  # duty; at or above it a rotor is saturated
SHARE: Final = 0.15  # of the flight; longest saturation of any rotor


def list_objections(rehearsed: SimulatedFlight, vehicle: Vehicle, scenario: Scenario) -> list[str]:
    """Return the reasons not to fly a flight; empty if it is safe."""
    out = []
    if rehearsed.outcome is not FlightOutcome.REACHED:
        out.append(f'it {rehearsed.outcome}')
    length, width, height = scenario.room.size.vector
    radius, half_height = vehicle_reach(vehicle)
    # The room is centred on the origin of the map
    near = np.abs(rehearsed.path[:, :2]).max(axis=0) + radius + MARGIN
    if near[0] > length / 2.0 or near[1] > width / 2.0:
        out.append(f'it comes within {MARGIN:g} m of a wall')
    if rehearsed.path[:, 2].max() + half_height + MARGIN > height:
        out.append(f'it comes within {MARGIN:g} m of the ceiling')
    if rehearsed.tilt > TILT:
        out.append(
            f'it tilts by {math.degrees(rehearsed.tilt):.0f} degrees, more than '
            f'{math.degrees(TILT):.0f}'
        )
    if np.max(np.mean(np.abs(rehearsed.duties) >= FULL, axis=0)) > SHARE:
        out.append('a rotor is saturated for too long')
    if rehearsed.path[-1, 2] > rehearsed.standing + CLEAR:
        out.append('it does not land')
    return out


def flight_extent(rehearsed: SimulatedFlight, vehicle: Vehicle) -> tuple[float, float, float]:
    """Return length, width and height of the space that a flight needs, hull included. [m]"""
    radius, half_height = vehicle_reach(vehicle)
    (x, y), top = np.ptp(rehearsed.path[:, :2], axis=0) + 2.0 * radius, rehearsed.path[:, 2].max()
    return float(x), float(y), float(top) + half_height

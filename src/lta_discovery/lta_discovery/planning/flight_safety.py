"""Whether a rehearsed flight may be flown: in its room, upright, not at its limits, and landed."""

import math
from typing import Final

from lta_discovery.planning.rehearsal import CLEAR, RehearsedFlight
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.readings import FlightOutcome
from lta_sim.scene_model import vehicle_reach
import numpy as np

MARGIN: Final = 0.3  # m between the hull and walls or ceiling
TILT: Final = math.radians(30.0)
FULL: Final = 0.98  # of a duty; from there on a rotor is at its limit
SHARE: Final = 0.15  # of the flight, that any rotor may be there


def list_objections(rehearsed: RehearsedFlight, vehicle: Vehicle, scenario: Scenario) -> list[str]:
    """
    Return why a flight should not be flown; nothing where it can.

    Parameters
    ----------
    flown : Rehearsed
        The flight.
    vehicle : Vehicle
        What flew.
    scenario : Scenario
        Where.

    """
    out = []
    if rehearsed.outcome is not FlightOutcome.REACHED:
        out.append(f'it {rehearsed.outcome}')
    length, width, height = scenario.room.size.vector
    radius, half_height = vehicle_reach(vehicle)
    near = np.abs(rehearsed.path[:, :2]).max(axis=0) + radius + MARGIN
    if near[0] > length / 2.0 or near[1] > width / 2.0:
        out.append('it comes near a wall')
    if rehearsed.path[:, 2].max() + half_height + MARGIN > height:
        out.append('it comes near the ceiling')
    if rehearsed.tilt > TILT:
        out.append(f'it tilts by {math.degrees(rehearsed.tilt):.0f} degrees')
    if np.max(np.mean(np.abs(rehearsed.duties) >= FULL, axis=0)) > SHARE:
        out.append('a rotor is at its limit')
    if rehearsed.path[-1, 2] > rehearsed.standing + CLEAR:
        out.append('it does not come down')
    return out


def flight_extent(rehearsed: RehearsedFlight, vehicle: Vehicle) -> tuple[float, float, float]:
    """Return the length, width and height of the space that a flight takes, hull included. [m]"""
    radius, half_height = vehicle_reach(vehicle)
    (x, y), top = np.ptp(rehearsed.path[:, :2], axis=0) + 2.0 * radius, rehearsed.path[:, 2].max()
    return float(x), float(y), float(top) + half_height

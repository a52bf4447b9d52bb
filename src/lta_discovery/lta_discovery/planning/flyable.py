"""Whether a rehearsed flight may be flown: in its room, upright, not at its limits, and landed."""

import math
from typing import Final

from lta_discovery.planning.rehearsal import CLEAR, Rehearsed
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.in_scene import reach
from lta_sim.readings import Outcome
import numpy as np

MARGIN: Final = 0.3  # m between the hull and walls or ceiling
TILT: Final = math.radians(30.0)
FULL: Final = 0.98  # of a duty; from there on a rotor is at its limit
SHARE: Final = 0.15  # of the flight, that any rotor may be there


def objections(flown: Rehearsed, vehicle: Vehicle, scenario: Scenario) -> list[str]:
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
    if flown.outcome is not Outcome.REACHED:
        out.append(f'it {flown.outcome}')
    length, width, height = scenario.room.size.vector
    radius, half_height = reach(vehicle)
    near = np.abs(flown.path[:, :2]).max(axis=0) + radius + MARGIN
    if near[0] > length / 2.0 or near[1] > width / 2.0:
        out.append('it comes near a wall')
    if flown.path[:, 2].max() + half_height + MARGIN > height:
        out.append('it comes near the ceiling')
    if flown.tilt > TILT:
        out.append(f'it tilts by {math.degrees(flown.tilt):.0f} degrees')
    if np.max(np.mean(np.abs(flown.duties) >= FULL, axis=0)) > SHARE:
        out.append('a rotor is at its limit')
    if flown.path[-1, 2] > flown.standing + CLEAR:
        out.append('it does not come down')
    return out


def extent(flown: Rehearsed, vehicle: Vehicle) -> tuple[float, float, float]:
    """Return the length, width and height of the space that a flight takes, hull included. [m]"""
    radius, half_height = reach(vehicle)
    (x, y), top = np.ptp(flown.path[:, :2], axis=0) + 2.0 * radius, flown.path[:, 2].max()
    return float(x), float(y), float(top) + half_height

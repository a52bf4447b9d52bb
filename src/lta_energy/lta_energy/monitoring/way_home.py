"""
Estimate the energy for the way home from the measured power and speed of flight.

Power and speed are averaged only while the drone moves, so that a drone resting far from home
still has a valid estimate. The speed over ground is the airspeed less an assumed head wind.
"""

import math
from typing import NamedTuple

from lta_config.settings import setting, Settings
from lta_energy.monitoring.reading import TravelState


class WayHomeSettings(Settings):
    """Assumptions about the way home that hold until measured or cannot be measured."""

    power: float = setting(
        1.4,
        'Power assumed for the flight home until it has been measured.',
        unit='W',
        low=0.0,
        high=1000.0,
    )
    speed: float = setting(
        0.5,
        'Airspeed assumed for the flight home until it has been measured.',
        unit='m/s',
        low=0.05,
        high=30.0,
    )
    moving: float = setting(
        0.1,
        'Airspeed above which power and speed count towards their means in flight.',
        unit='m/s',
        low=0.01,
        high=10.0,
    )
    head_wind: float = setting(
        0.1,
        'Head wind assumed for the flight home; it cannot be measured.',
        unit='m/s',
        low=0.0,
        high=10.0,
    )
    slowest: float = setting(
        0.05, 'Lowest ground speed assumed for the flight home.', unit='m/s', low=0.01, high=10.0
    )
    smoothing: float = setting(
        30.0,
        'Time constant of the mean power and airspeed in flight.',
        unit='s',
        low=0.0,
        high=3600.0,
    )


class TravelEstimate(NamedTuple):
    """Mean power from the chemistry and mean airspeed while moving. [W, m/s]"""

    power: float
    speed: float


def initial_travel(settings: WayHomeSettings) -> TravelEstimate:
    """Return the assumptions before the drone has moved."""
    return TravelEstimate(settings.power, settings.speed)


def update_travel(
    settings: WayHomeSettings,
    travel: TravelEstimate,
    where: TravelState | None,
    power: float,
    dt: float,
) -> TravelEstimate:
    """Update power [W] and speed of flight after a time step [s], if the drone moves."""
    if where is None or where.speed < settings.moving:
        return travel
    share = -math.expm1(-dt / settings.smoothing) if settings.smoothing > 0.0 else 1.0
    return TravelEstimate(
        travel.power + share * (max(power, 0.0) - travel.power),
        travel.speed + share * (where.speed - travel.speed),
    )


def energy_home(settings: WayHomeSettings, travel: TravelEstimate, distance: float) -> float:
    """Return the energy to fly a distance [m]. [J]"""
    return travel.power * distance / _ground_speed(settings, travel)


def reachable_distance(settings: WayHomeSettings, travel: TravelEstimate, energy: float) -> float:
    """Return the distance that an energy [J] allows. [m]"""
    if travel.power <= 0.0:
        return math.inf
    return max(energy, 0.0) / travel.power * _ground_speed(settings, travel)


def _ground_speed(settings: WayHomeSettings, travel: TravelEstimate) -> float:
    # The lower bound keeps the energy finite in a head wind as fast as the drone
    return max(travel.speed - settings.head_wind, settings.slowest)

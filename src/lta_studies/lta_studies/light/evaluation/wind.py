"""
Compute the wind of a flight (mean plus one deviation) relative to the top airspeed.

The top airspeed is the lower of the vehicle's static limit in level flight ("lta wind") and the
limit of its controller.
"""

from functools import cache
import math
from typing import Final

from lta_control.cascade import CascadeGains
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec
from lta_model.scenario_air import WIND_AXES
from lta_model.vehicle import load_vehicle
from lta_sim import wind_limits

ALLOWED: Final = 0.9  # ratio up to which a strategy must reach the lamp


def wind_to_airspeed_ratio(spec: FlightSpec) -> float:
    """Return mean wind plus one deviation at the hull, relative to the top airspeed. [1]"""
    vehicle, scenario, policy = build_vehicle_scenario_stack(spec)
    air = scenario.air
    x, y, z = air.wind.vector
    if (profile := air.profile) is not None:
        speed = profile.wind.si * wind_limits.wind_share_at_hull(
            vehicle, policy.mission.altitude, profile.height.si, profile.roughness.si
        )
        x += speed * math.cos(profile.towards.si)
        y += speed * math.sin(profile.towards.si)
    mean = math.hypot(x, y, z)
    if scenario.outside is not None:
        # Out of a building: the stronger of the winds inside and outside
        mean = max(mean, math.hypot(*scenario.outside.wind.vector))
    eddies = air.collect_effects(0.0).get('turbulence', {})
    deviation = max((eddies[axis] for axis in WIND_AXES if eddies), default=0.0)
    if (reference := eddies.get('mean', 0.0)) > 0.0:
        deviation *= min(mean / reference, 1.0)  # it follows the mean wind near the ground
    top = level_airspeed(spec.names['vehicle'], air.density)
    if isinstance(policy.gains, CascadeGains):
        top = min(top, policy.gains.speed_limit)
    return (mean + deviation) / top


@cache
def level_airspeed(vehicle: str, density: float) -> float:
    """Return the static limit of the airspeed in level flight. [m/s]"""
    return wind_limits.static_wind_limit(load_vehicle(vehicle, density))

"""
Compute single causes that would raise the hover power of a drone to the seed paper's 1333 mW.

The causes are extra weight, wind, or less efficient rotors, each with everything else unchanged.
The loads are those of the vehicle file, with rotor power affine in thrust. The paper does not
state which of them applied.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.thrust_envelope import hover_thrust

FORWARD = 0.5  # share of the thrust along x above which a rotor counts as a forward one


@final
@dataclass(frozen=True, slots=True)
class PowerCauses:
    """Causes that alone explain a power; NaN where the vehicle's rotors cannot reach it."""

    least: float  # hover power with ideal rotors in still air, radio on [W]
    heaviness: float  # mass minus displaced air [kg]
    wind: float  # wind against which the position is held [m/s]
    factor: float  # factor on the power of the rotors [1]


def explain_hover_power(vehicle: Vehicle, hover: float, goal: float) -> PowerCauses:
    """
    Compute the causes that raise the hover power to a goal.

    `hover`: its hover power in flight, radio on [W]. `goal`: power to explain. [W].
    """
    loads = vehicle.loads
    steady = loads.idle + loads.transmitting
    thrust, count = hover_thrust(vehicle)
    # Rotor power is affine in thrust: offset + slope * thrust, per rotor.
    lifting = count * (loads.rotor_offset + loads.rotor_slope * thrust)
    per_newton = count * thrust / (vehicle.heaviness * STANDARD_GRAVITY)
    # Additional mass [kg] whose lift costs the missing power; the offsets are already paid.
    heavy = (goal - hover) / (loads.rotor_slope * per_newton * STANDARD_GRAVITY)
    return PowerCauses(
        least=steady + lifting,
        heaviness=vehicle.heaviness + heavy,
        wind=_equivalent_wind(vehicle, goal - hover),
        factor=(goal - steady) / (hover - steady),
    )


def _equivalent_wind(vehicle: Vehicle, more: float) -> float:
    """Return the wind whose drag costs the forward rotors that much power. [m/s]"""
    pushing = [rotor.column[0] for rotor in vehicle.rotors if rotor.column[0] > FORWARD]
    if not pushing:
        return math.nan
    loads, effects = vehicle.loads, vehicle.collect_effects()
    push = sum(pushing) / len(pushing)
    # The forward rotors rest in a hover, so their offsets come first.
    force = (more - len(pushing) * loads.rotor_offset) / loads.rotor_slope * push
    a, b = effects['quadratic_drag']['surge'], effects['linear_drag']['surge']
    if force <= 0.0 or a + b <= 0.0:
        return math.nan
    # Positive root of a v^2 + b v = force.
    return (-b + math.sqrt(b * b + 4.0 * a * force)) / (2.0 * a) if a else force / b

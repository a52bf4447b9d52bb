"""
What would make the seed paper's 1333 mW of this drone: how much of one cause, all else the same.

Each by the loads of the vehicle's file, rotors affine in thrust, two of them lifting and two
pushing: heavier than air by so much, held against so much wind, or with rotors that take so many
times as much. Which of them it was, the paper does not tell.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.thrust_envelope import hover_thrust

FORWARD = 0.5  # of a rotor's thrust along an axis, from which on it pushes that way


@final
@dataclass(frozen=True, slots=True)
class PowerCauses:
    """
    What would do it alone; NaN where the vehicle's rotors cannot.

    Attributes
    ----------
    least : float
        Hover of the ideal rotors in still air, radio on. [W]
    heaviness : float
        Mass less displaced air. [kg]
    wind : float
        Against which it would stand. [m/s]
    factor : float
        Of the rotors' power. [1]

    """

    least: float
    heaviness: float
    wind: float
    factor: float


def explain_hover_power(vehicle: Vehicle, hover: float, goal: float) -> PowerCauses:
    """
    Return what would make a hover take so much.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    hover : float
        What its flights took in hover, radio on. [W]
    goal : float
        What is to be explained. [W]

    """
    loads = vehicle.loads
    steady = loads.idle + loads.transmitting
    thrust, count = hover_thrust(vehicle)
    lifting = count * (loads.rotor_offset + loads.rotor_slope * thrust)
    per_newton = count * thrust / (vehicle.heaviness * STANDARD_GRAVITY)
    heavy = (goal - hover) / (loads.rotor_slope * per_newton * STANDARD_GRAVITY)
    return PowerCauses(
        least=steady + lifting,
        heaviness=vehicle.heaviness + heavy,
        wind=_equivalent_wind(vehicle, goal - hover),
        factor=(goal - steady) / (hover - steady),
    )


def _equivalent_wind(vehicle: Vehicle, more: float) -> float:
    """Return the wind whose drag takes so much more power of the rotors that push ahead. [m/s]"""
    pushing = [rotor.column[0] for rotor in vehicle.rotors if rotor.column[0] > FORWARD]
    if not pushing:
        return math.nan
    loads, effects = vehicle.loads, vehicle.collect_effects()
    push = sum(pushing) / len(pushing)
    force = (more - len(pushing) * loads.rotor_offset) / loads.rotor_slope * push
    a, b = effects['quadratic_drag']['surge'], effects['linear_drag']['surge']
    if force <= 0.0 or a + b <= 0.0:
        return math.nan
    return (-b + math.sqrt(b * b + 4.0 * a * force)) / (2.0 * a) if a else force / b

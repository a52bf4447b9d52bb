"""
Select the feedback resistor for a scene's light, as an operator does before the flight.

By the steady light on the ring, in the room or, in a scene with a door, beyond it. The drone knows
the selection: it needs it to interpret the strength of a lamp.
"""

from lta_model.hull import half_axes
from lta_model.light.field import LightField
from lta_model.light.view import LightView
from lta_model.scenario import load_scenario
from lta_model.sensors.photodiode import PhotodiodeArray
from lta_model.vehicle import load_vehicle, Vehicle

ABOVE = 1.0  # m over the ground, where the steady light is evaluated


def select_diode_gain(field: LightField, vehicle: Vehicle) -> PhotodiodeArray:
    """Return the diodes of a vehicle with the resistor for the light of a scene."""
    # Nothing to select
    if len(vehicle.diodes.resistors) < 2:
        return vehicle.diodes
    x = 0.0
    if field.outside is not None and field.room is not None:
        # Outside of the door, clear of the wall by the hull and a metre
        x = field.room.size[0] / 2 + 2.0 * max(half_axes(vehicle.file.hull)) + ABOVE
    pose = (x, 0.0, ABOVE, 0.0, 0.0, 0.0, 1.0)
    light = LightView(field, vehicle).compute_diode_readings([pose])
    # Brightest diode, at the crest of the flicker
    lux = float((light.steady + light.mains).max())
    return vehicle.diodes.select_resistor(lux / field.ambient.efficacy)


def compute_gain_scale(scenario: str, vehicle: str) -> float:
    """
    Return a diode's reading in a scenario relative to that with the largest resistor. [1]

    Scenario and vehicle are names or paths; 1 without a scenario.
    """
    if not scenario:
        return 1.0
    return select_diode_gain(load_scenario(scenario).light_field, load_vehicle(vehicle)).gain_scale

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build the model of a vehicle in a scene: the scenario's effects added to the vehicle's own.

The scenario adds winds, averaged over the hull, and walls that the hull can touch.
"""

import math

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_model import mass_properties
from lta_model.effect_parameters import Effects
from lta_model.effects import EFFECTS
from lta_model.effects.gas import IN_SUN, SUPERHEAT
from lta_model.effects.protocol import AirEffect
from lta_model.model import STEP_NS, VehicleModel
from lta_model.propulsion import hover_duty
from lta_model.scenario import Scenario
from lta_model.state import DISPLACED, MASS, MASS_MOMENT
from lta_model.vehicle import Vehicle
from lta_sim.wind_record import WindRecord
import numpy as np

# Of a wall as `effects.walls` has it, assumed: foil that gives centimetres under newtons.
WALL_STIFFNESS = 100.0  # N/m
WALL_RELAXATION = 0.05  # s
WALL_FRICTION = 0.3
WARMED = SUPERHEAT.name


def vehicle_reach(vehicle: Vehicle) -> tuple[float, float]:
    """
    Return the extent of a vehicle from its hull centre: horizontal and upward [m].

    A hull that is not rotationally symmetric counts as the enclosing symmetric one.
    """
    if vehicle.file.hull.shape != 'none':
        a, b, c = mass_properties.half_axes(vehicle.file.hull)
        return max(a, b), c
    ends = [
        (np.abs(part.position.vector) + 0.5 * np.array(part.size.vector)).tolist()
        for part in vehicle.file.parts.values()
    ]
    ends += [np.abs(rotor.place).tolist() for rotor in vehicle.rotors]
    ends.append((0.0, 0.0, vehicle.hull_height_on_floor))
    return max(math.hypot(x, y) for x, y, _ in ends), max(z for _, _, z in ends)


def collect_scene_effects(vehicle: Vehicle, scenario: Scenario) -> Effects:
    """
    Return the parameters of every effect that the scene adds, in SI.

    Raise `BadInput` if the vehicle file sets one of them as well, or the vehicle starts in a wall.
    """
    radius, half_height = vehicle_reach(vehicle)
    # A profile is averaged over a hull; a bare frame meets the wind at its own height.
    tall = half_height if vehicle.file.hull.shape != 'none' else 0.0
    effects = scenario.air.collect_effects(tall)
    if scenario.room.walls == 'solid':
        # Other rooms have no walls; leaving the room ends the flight there
        effects['walls'] = _wall_parameters(scenario, radius, half_height)
    for name in effects:
        if name in vehicle.file.effects:
            kind = 'wind' if isinstance(EFFECTS[name], AirEffect) else 'room'
            raise BadInput(
                f'The effect {name} is set both by the {kind} of the scenario '
                f'{scenario.name} and by the vehicle file of {vehicle.file.name}; remove '
                'it from the vehicle file.'
            )
    sun = scenario.sun
    # A vehicle file may have measured values; a bare frame has no gas
    if sun is not None and sun.slack.si > 0.0 and vehicle.file.hull.shape != 'none':
        own = {} if WARMED in vehicle.file.effects else {WARMED: IN_SUN | {'slack': sun.slack.si}}
        effects |= own
    return effects


def _wall_parameters(scenario: Scenario, radius: float, half_height: float) -> dict[str, float]:
    """Return the parameters of `walls` for a hull that counts as rotationally symmetric."""
    length, width, height = scenario.room.size.vector
    at = scenario.start.position.vector
    if any(abs(x) + radius > side / 2.0 for x, side in zip(at, (length, width), strict=True)):
        raise BadInput(
            f'The scenario {scenario.name} starts at {at} m, where a hull with a radius of '
            f'{radius:.2f} m touches a wall; move the start away from the wall.'
        )
    return {
        'x_low': -length / 2.0,
        'x_high': length / 2.0,
        'y_low': -width / 2.0,
        'y_high': width / 2.0,
        'ceiling': height,
        'radius': radius,
        'half_height': half_height,
        'stiffness': WALL_STIFFNESS,
        'relaxation': WALL_RELAXATION,
        'friction': WALL_FRICTION,
    }


def build_scene_model(vehicle: Vehicle, scenario: Scenario) -> VehicleModel:
    """Build the model of a vehicle in a scene; errors as `collect_scene_effects`."""
    return vehicle.build_model(collect_scene_effects(vehicle, scenario))


def load_wind_record(scenario: Scenario) -> WindRecord | None:
    """Load the scenario's recorded wind, if any; raise `BadInput` if it is unusable."""
    path = scenario.wind_file
    return None if path is None else WindRecord.read(path, scenario.goal.time_limit.si)


def check_scene(vehicle: Vehicle, scenario: Scenario, hovers: bool = True) -> None:
    """
    Raise `BadInput` for a scene whose light, wind or walls do not suit this vehicle.

    Also for a vehicle that the time step cannot follow, or whose effects (a payload, a shifted
    centre of gravity, other gas or air) make it too heavy for its rotors, if it `hovers`, or
    unstable.
    """
    # Raises for effects that are given twice and for a start inside a wall
    model = build_scene_model(vehicle, scenario)
    # Both raise `BadInput` for unusable files
    _ = load_wind_record(scenario), scenario.light_field
    vehicle.check_step(STEP_NS * 1e-9, model)
    file, body = vehicle.file, model.body
    lift = max(0.0, model.effect_parameters.get('net_lift', {}).get('force', 0.0))
    # Net weight that the rotors must carry: mass minus displaced air, less extra lift [N]
    weight = (body[MASS] - body[DISPLACED]) * STANDARD_GRAVITY - lift
    if hovers:
        hover_duty(file.name, vehicle.rotors, file.aero.coupling, float(weight), STANDARD_GRAVITY)
    # Height of the centre of gravity above the hull centre
    above = body[MASS_MOMENT + 2] / body[MASS]
    if above >= 0.0 and file.hull.shape != 'none' and file.trim.unstable == 'refused':
        raise BadInput(
            f'With its effects, {file.name} has its centre of gravity {100 * above:.1f} cm '
            'above the hull centre and would flip over; move mass down, or allow it with '
            '"unstable: allowed" under trim.'
        )

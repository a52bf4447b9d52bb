# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build the constants of a mission leg for a beacon and a light level.

The drone knows its scene: it demodulates the frequency of its target beacon, and knows the
brightness of a beacon at one metre. The mission file may name the resistor of its photodiodes.
"""

from dataclasses import replace
import math
from typing import final

from lta_config.errors import BadInput, unknown_name_error
from lta_config.schema.mission_file import InspectionPayload, MissionFile
from lta_config.schema.spectrum_file import luminous_efficacy
from lta_config.topics import load_topic_table
from lta_control.laws.cascade import CascadeGains
from lta_control.strategies.homing import HOMING_STRATEGY
from lta_energy.harvest import WHITE_LED
from lta_energy.irradiance import PanelIrradiance
from lta_flight.batch.batch_flight import (
    BatchFlight,
    build_constants,
    build_model,
    flight_from_constants,
    FlightConstants,
)
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec, load_spec
from lta_model.electrical.panel import array_spectral_factor
from lta_model.light.field import LightField
from lta_model.light.lamp import BeaconLamp
from lta_model.mass_properties import half_axes
from lta_model.scenario import Scenario
from lta_model.scenario_light import NO_SHARE
from lta_sim.light_link import build_light_link, LightLink

LARGEST_EMISSION_ANGLE = math.radians(
    75.0
)  # emission angle from a lantern on the floor to the diodes
LIGHT_LEVELS_PER_DOUBLING = 2  # light levels per doubling; limits the number of cached links


def build_flight_spec(mission: MissionFile) -> FlightSpec:
    """Return the flight spec of a mission; raise BadInput if its files cannot be read."""
    made_of = load_spec(mission.vehicle, mission.scene, 'homing', '')
    # The dock catches a drone that passes; one that brakes spends energy
    own = {'mission.altitude': mission.altitude.si, 'mission.homing.brake': False}
    made_of = made_of.with_values(own)
    if mission.feedback is not None:
        resistor = mission.feedback.model_dump(mode='json', exclude_none=True)
        made_of = made_of.with_values({'vehicle.sensors.diodes.feedback': resistor})
    return made_of if mission.payload is None else add_payload(made_of, mission.payload)


def add_payload(spec: FlightSpec, payload: InspectionPayload) -> FlightSpec:
    """Return the spec with a payload below the sensors; it replaces ballast."""
    vehicle = dict(spec.contents['vehicle'])
    own = vehicle.get('layers')
    if not isinstance(own, dict):
        raise BadInput(
            'The mission has a payload, but its vehicle file has no layers to add it to; '
            'remove the payload from the mission file, or choose another vehicle.'
        )
    source = payload.mass.source or ''
    part = {
        'shape': 'box',
        'mass': {'value': payload.mass.si, 'unit': 'kg', 'source': source},
        # Relative to the hull centre, z up
        'position': {'value': [0, 0, -36], 'unit': 'cm', 'source': 'below the sensors'},
        'size': {'value': [2, 2, 1], 'unit': 'cm', 'source': source},
    }
    layers = {**own, 'inspection': {'payload': part}}
    return replace(spec, contents={**spec.contents, 'vehicle': {**vehicle, 'layers': layers}})


def keep_gas_cool(scenario: Scenario) -> Scenario:
    """Return the scenario with gas at the temperature of the air, also in sunlight."""
    if scenario.sun is None:
        return scenario
    cool = {'daylight': scenario.sun.model_copy(update={'slack': NO_SHARE})}
    if scenario.outside is None:
        return scenario.model_copy(update=cool)
    return scenario.model_copy(update={'outside': scenario.outside.model_copy(update=cool)})


@final
class MissionScene:
    """
    Vehicle, scenario and policy of a mission.

    Raise `BadInput` if the mission cannot be flown, for example because a beacon is not in the
    scenario.
    """

    def __init__(self, mission: MissionFile) -> None:
        self.vehicle, scenario, self.policy = build_vehicle_scenario_stack(
            build_flight_spec(mission)
        )
        # The scene's sun stands still, and each leg would start with cold gas
        self.scenario = keep_gas_cool(scenario)
        for name in (mission.perch, *mission.round):
            if name not in self.scenario.lamps:
                raise unknown_name_error(
                    f'lamp of {self.scenario.name}', name, list(self.scenario.lamps)
                )
        if not isinstance(self.policy.gains, CascadeGains):
            raise BadInput(
                'Missions need a vehicle with the control law cascade, but '
                f'{mission.vehicle} has another; choose another vehicle in the mission '
                'file.'
            )
        if self.scenario.wind_file is not None:
            raise BadInput(
                f'Missions do not support recorded wind, which the scenario {self.scenario.name} '
                'has; remove air.recorded from it.'
            )
        self._table = load_topic_table()
        # The model needs only one lamp; the links of the others are built per leg.
        alone = {mission.perch: self.scenario.lamps[mission.perch]}
        scene = self.scenario.model_copy(update={'several': alone, 'alone': None, 'route': ()})
        self._model = build_model(self.vehicle, scene, self.policy)
        base = build_constants(self.vehicle, self.scenario, self.policy, self._table)
        # The leg decides when to land, not the reserve of a flight, and no hand holds the drone
        self._base = base._replace(held=0.0, power=base.power._replace(reserve=-math.inf))
        self._flights: dict[tuple[str, int], BatchFlight] = {}

    def lamp(self, name: str) -> BeaconLamp:
        """Return the lamp of a beacon."""
        return self.scenario.lamps[name].lamp

    def build_beacon_flight(self, beacon: str, light: PanelIrradiance, lux: float) -> BatchFlight:
        """Return the flight to a beacon in panel light and ambient light [lx]; cached."""
        # Half-octave steps: within a step the link hardly changes, so it is built once.
        level = round(LIGHT_LEVELS_PER_DOUBLING * math.log2(max(lux, 1.0)))
        flight = self._flights.get((beacon, level))
        if flight is None:
            listening = self._build_link(beacon, 2.0 ** (level / LIGHT_LEVELS_PER_DOUBLING))
            flight = flight_from_constants(
                self._model,
                self._build_constants(listening, self.lamp(beacon)),
                self.vehicle,
                HOMING_STRATEGY,
            )
            self._flights[beacon, level] = flight
        # Only the panel's light is exact for each call; the rest of the constants is cached.
        irradiance = light.sun + light.lamps
        weights = flight.craft.power.panel_weights
        if irradiance > 0.0:
            # Sun and lamps are one ambient light here; their mean factor is exact
            lamps = array_spectral_factor(self.vehicle.file.energy, luminous_efficacy(WHITE_LED))
            weights = weights._replace(ambient=(light.sun + lamps * light.lamps) / irradiance)
        power = flight.craft.power._replace(ambient=irradiance, panel_weights=weights)
        craft = flight.craft._replace(power=power)
        return flight_from_constants(self._model, craft, self.vehicle, HOMING_STRATEGY)

    def _build_link(self, beacon: str, lux: float) -> LightLink:
        """Build the light link of one beacon in steady ambient light."""
        whole = self.scenario.light_field
        # Daylight adds to the ambient light of the scene.
        ambient = replace(whole.ambient, steady=whole.ambient.steady + lux)
        field = LightField((self.lamp(beacon),), ambient, whole.room, whole.daylight)
        frequency = self.scenario.lamps[beacon].frequency.si
        return build_light_link(
            field,
            self.vehicle.diodes,
            half_axes(self.vehicle.file.hull),
            self.policy.demodulation.model_copy(update={'frequency': frequency}),
            self._table.light.sample_rate.si,
            self._table.light.samples,
        )

    def _build_constants(self, listening: LightLink, lamp: BeaconLamp) -> FlightConstants:
        """Return the constants of a flight, including the known brightness of the lamp."""
        homing = self.policy.mission.homing.model_copy(
            update={'brightness': lamp_brightness(listening, lamp)}
        )
        mission = self.policy.mission.model_copy(update={'homing': homing})
        # The brightness is that of this lantern by the vehicle's resistor.
        return self._base._replace(
            listening=listening, mission=mission, route=(0,), diode_scale=1.0
        )


def lamp_brightness(listening: LightLink, lamp: BeaconLamp) -> float:
    """Return the signal strength of a lantern at one metre, as homing expects it [counts]."""
    order = lamp.order
    # Generalised Lambertian source: I = flux (m + 1) / (2 pi) cos^m; at 1 m lux equals candela.
    lux = lamp.flux * (order + 1.0) / (2.0 * math.pi) * math.cos(LARGEST_EMISSION_ANGLE) ** order
    (signal,) = listening.signals
    return float(signal.gain * signal.counts * lux)

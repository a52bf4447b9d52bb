"""
The vehicle of a mission in its scene, as the numbers that a leg takes: one beacon, one light.

The drone knows its scene: it listens for the frequency of the beacon that it flies to, has the
feedback resistor for the light of the hour, and knows how bright a beacon then reads.
"""

from dataclasses import replace
import math
from typing import final

from lta_config.errors import BadInput, unknown
from lta_config.schema.mission_file import MissionFile, Payload
from lta_config.topics import topic_table
from lta_control.cascade import CascadeGains
from lta_control.strategies.bearing_angle import STRATEGY as BAG
from lta_energy.light_of_days import Light
from lta_flight.fleet.craft import check, craft_of, Made, made_from
from lta_flight.fleet.numbers import Craft
from lta_flight.ingredients import gather, Ingredients, parts_of
from lta_model.hull import half_axes
from lta_model.light.field import LightField
from lta_model.light.lamp import Lamp
from lta_model.light.setting import set_for
from lta_sim.counted_light import Listening, listening_of

OFF_AXIS = math.radians(75.0)  # at which the light of a lantern on the floor leaves for the diodes
STEPS = 2  # lights between one and twice as bright that are told apart
CLEARANCE = 0.02  # m between hull parts and payload


def ingredients(mission: MissionFile) -> Ingredients:
    """
    Return what the flights of a mission are made of.

    Raises
    ------
    BadInput
        If its files cannot be read, or its beacons are none of the scene's.

    """
    made_of = gather(mission.vehicle, mission.scene, 'homing', '')
    made_of = made_of.with_values({'mission.altitude': mission.altitude.si})
    return made_of if mission.payload is None else laden(made_of, mission.payload)


def laden(made_of: Ingredients, payload: Payload) -> Ingredients:
    """Return these with a payload at the foot of the sensors; ballast gives way to it."""
    vehicle = dict(made_of.contents['vehicle'])
    given = vehicle.get('layers')
    if not isinstance(given, dict):
        raise BadInput('A payload needs a vehicle whose file has layers; leave it out.')
    source = payload.mass.source or ''
    part = {
        'shape': 'box',
        'mass': {'value': payload.mass.si, 'unit': 'kg', 'source': source},
        'position': {'value': [0, 0, -36], 'unit': 'cm', 'source': 'below the sensors'},
        'size': {'value': [2, 2, 1], 'unit': 'cm', 'source': source},
    }
    layers = {**given, 'inspection': {'payload': part}}
    return replace(
        made_of, contents={**made_of.contents, 'vehicle': {**vehicle, 'layers': layers}}
    )


@final
class Scenes:
    """
    What a mission flies in.

    Parameters
    ----------
    mission : MissionFile
        The mission.

    Raises
    ------
    BadInput
        If it cannot be flown.

    """

    def __init__(self, mission: MissionFile) -> None:
        self.vehicle, self.scenario, self.policy = parts_of(ingredients(mission))
        for name in (mission.perch, *mission.round):
            if name not in self.scenario.lamps:
                raise unknown(f'lamp of {self.scenario.name}', name, list(self.scenario.lamps))
        if not isinstance(self.policy.gains, CascadeGains):
            raise BadInput(f'A mission is flown by the law cascade only, not {mission.vehicle}.')
        self._table = topic_table()
        alone = {mission.perch: self.scenario.lamps[mission.perch]}
        scene = self.scenario.model_copy(update={'several': alone, 'alone': None, 'route': ()})
        self._model = check(self.vehicle, scene, replace(self.policy, strategy=BAG))
        self._base = craft_of(self.vehicle, self.scenario, self.policy, self._table)
        self._known: dict[tuple[str, int], Made] = {}

    def lamp(self, name: str) -> Lamp:
        """Return a beacon."""
        return self.scenario.lamps[name].lamp

    def made(self, beacon: str, light: Light, lux: float) -> Made:
        """Return the numbers of a flight to a beacon in some light, which fills the scene. [lx]"""
        level = round(STEPS * math.log2(max(lux, 1.0)))
        known = self._known.get((beacon, level))
        if known is None:
            listening = self._listening(beacon, 2.0 ** (level / STEPS))
            known = made_from(self._model, self._craft(listening, self.lamp(beacon)), self.vehicle)
            self._known[beacon, level] = known
        irradiance = light.sun + light.lamps
        craft = known.craft._replace(power=known.craft.power._replace(ambient=irradiance))
        return made_from(self._model, craft, self.vehicle)

    def _listening(self, beacon: str, lux: float) -> Listening:
        """Return what the ring hears of one beacon among steady light."""
        whole = self.scenario.light_field
        ambient = replace(whole.ambient, steady=whole.ambient.steady + lux)
        field = LightField((self.lamp(beacon),), ambient, whole.room, whole.daylight)
        frequency = self.scenario.lamps[beacon].frequency.si
        return listening_of(
            field,
            set_for(field, self.vehicle),
            half_axes(self.vehicle.file.hull),
            self.policy.demodulation.model_copy(update={'frequency': frequency}),
            self._table.light.sample_rate.si,
            self._table.light.samples,
        )

    def _craft(self, listening: Listening, lamp: Lamp) -> Craft:
        """Return the constants of a flight with the lamp's brightness in the drone's mind."""
        homing = self.policy.mission.homing.model_copy(
            update={'brightness': brightness(listening, lamp)}
        )
        mission = self.policy.mission.model_copy(update={'homing': homing})
        return self._base._replace(listening=listening, mission=mission)


def brightness(listening: Listening, lamp: Lamp) -> float:
    """Return the strength of a lantern from one metre off, as homing takes it. [counts]"""
    order = lamp.order
    lux = lamp.flux * (order + 1.0) / (2.0 * math.pi) * math.cos(OFF_AXIS) ** order
    return float(listening.gain * listening.counts * lux)

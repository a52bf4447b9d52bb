# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The state in which a mission's flight starts, and the schedule of its legs."""

from dataclasses import replace

from lta_config.errors import BadInput
from lta_config.schema.mission_file import load_mission
from lta_flight.batch.targets import BatchSchedule
from lta_model.electrical.mppt_charger import resting_flow
from lta_model.scenario import load_scenario
from lta_model.state import RIGID
from lta_sim.compiled_sensors import draw_turbulence_memory
from lta_studies.mission import scene
from lta_studies.mission.legs import coarse_schedule, LegPilot
import pytest


def test_each_effect_has_its_own_initial_memory():
    """Turbulence comes before the motors, whose thrusts start at zero."""
    pilot = LegPilot.__new__(LegPilot)  # without compiling
    pilot.names, pilot._dark = ('turbulence', 'motor_lag'), (0.0,) * 8
    state = pilot.ground_state((0.0, 0.0, 1.0), 0.0, resting_flow(0.8), 0.8, 3).flight.state
    turbulence = draw_turbulence_memory(3)
    assert any(turbulence)
    assert state[RIGID : RIGID + len(turbulence)] == turbulence
    assert not any(state[RIGID + len(turbulence) :])


@pytest.mark.parametrize('name', ['sunny_field', 'hall_door'])
def test_the_gas_of_a_mission_stays_at_the_temperature_of_the_air(name):
    """In daylight too, where the effect superheat acts by default."""
    warehouse = load_mission('warehouse')
    (lamp,) = load_scenario(name).lamps
    day = {'scene': name, 'perch': lamp, 'round': (lamp,), 'payload': None}
    scenes = scene.MissionScene(warehouse.model_copy(update=day))
    assert load_scenario(name).sun.slack.si == 0.5
    assert scenes.scenario.sun.slack.si == 0.0
    assert scenes.scenario.light_field == load_scenario(name).light_field
    assert 'superheat' not in scenes._model.effect_parameters


def test_a_leg_has_the_same_control_period_in_longer_steps():
    fine = BatchSchedule(control=4, range=10, pressure=2, light=10)
    coarse = coarse_schedule(fine)
    assert (coarse.dt, coarse.control, coarse.range) == (0.005, 2, 5)
    assert coarse.period == fine.period == 0.01


@pytest.mark.parametrize(('control', 'every'), [(1, 10), (5, 10), (4, 7)])
def test_a_period_that_is_not_whole_in_longer_steps_is_refused(control, every):
    with pytest.raises(BadInput, match='must be whole multiples of that'):
        coarse_schedule(BatchSchedule(control, every, 2, 10))


def test_a_mission_in_recorded_wind_is_refused(monkeypatch, tmp_path):
    path = tmp_path / 'wind.csv'
    path.write_text('t,u,v,w\n0,1,0,0\n90000,1,0,0\n')
    mission = load_mission('warehouse')
    spec = scene.build_flight_spec(mission)
    content = spec.contents['scenario']
    windy = {**content, 'air': {**content['air'], 'recorded': str(path)}}
    made = replace(spec, contents={**spec.contents, 'scenario': windy})
    monkeypatch.setattr(scene, 'build_flight_spec', lambda _: made)
    with pytest.raises(BadInput, match='recorded wind, which the scenario warehouse_patrol has'):
        scene.MissionScene(mission)

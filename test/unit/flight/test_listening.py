# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A scene whose lamp the drone does not listen for is refused before it flies."""

from dataclasses import replace

from lta_config.errors import BadInput
from lta_config.files import list_shipped_names
from lta_flight.flight import fly_once
from lta_flight.flight_spec import build_vehicle_scenario_stack, check_lamp_frequency, load_spec
from lta_model.scenario import load_scenario
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.spectrum import plan_beacon_bins
import pytest
import yaml

ROW = {'at': '0 s', 'altitude': '1 m', 'heading': '0 deg', 'speed': '0 m/s'}


@pytest.fixture
def other():
    """Return a function that makes a flight in the lamp room, its lamp at 230 Hz."""
    made = load_spec('gtmab', 'lamp_room', 'homing', '')
    made = made.with_values({'scenario.lamp.frequency': '230 Hz'})

    def of(**keys):
        scene = made.contents['scenario'] | keys
        return replace(made, contents={**made.contents, 'scenario': scene})

    return of


def test_a_lamp_that_nobody_listens_for_is_refused_with_both_frequencies(other):
    with pytest.raises(BadInput, match=r'flickers at 230 Hz.* listens at 150 Hz.*route: \[lamp\]'):
        build_vehicle_scenario_stack(other())


def test_either_remedy_lets_it_fly(other):
    build_vehicle_scenario_stack(other(route=['lamp']))
    build_vehicle_scenario_stack(other().with_values({'demodulator.frequency': 230.0}))


def test_on_a_course_nobody_seeks_a_lamp(other):
    build_vehicle_scenario_stack(other(course={'between': 'step', 'rows': [ROW]}))


def test_the_line_is_where_another_bin_is_the_nearest_one():
    bins = plan_beacon_bins((150.0,), DemodulationSettings(), 10_000.0, 1000)[0]
    assert (bins.first, bins.last, bins.frequency_limits) == (13, 17, (125.0, 175.0))


@pytest.mark.parametrize('name', list_shipped_names('scenarios'))
def test_every_shipped_scene_is_heard(name):
    check_lamp_frequency(load_scenario(name), DemodulationSettings())


def test_the_graph_is_not_even_started(other, tmp_path):
    scene = tmp_path / 'other.yaml'
    scene.write_text(yaml.safe_dump(other().contents['scenario']))
    with pytest.raises(BadInput, match='flickers at 230 Hz'):
        fly_once('gtmab', str(scene), 'bag', 1, None, out=tmp_path / 'out')
    assert not (tmp_path / 'out').exists()

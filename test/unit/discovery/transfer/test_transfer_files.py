"""All that forecasts could name together has its place in a vehicle file."""

from pathlib import Path

from lta_config.files import find_file
from lta_discovery.finding import StudyResult
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.results.learned_file import format_learned_vehicle
from lta_discovery.transfer.candidate_groups import list_candidate_groups, list_knobs
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

SMALL = 0.1  # typical sizes


def test_a_file_with_everything_refitted_is_the_vehicle_that_was_learned(tmp_path: Path) -> None:
    name = 'rgblimp'
    vehicle = load_vehicle(name)
    nominal = NominalVehicle.from_vehicle(vehicle)
    known = list_free_parameters(nominal)
    small = np.array([min(SMALL * knob.typical, knob.high) for knob in known])
    small = np.where(small > 0.0, small, [-SMALL * knob.typical for knob in known])
    found = StudyResult('named', (), (), (), (), False, (), (), 1, {'train': ('A',)}, name)
    text, file = find_file('vehicle', name).read_text(encoding='utf-8'), tmp_path / 'learned.yaml'
    several = {group.name: group.knobs for group in list_candidate_groups(known)}
    every = list_knobs(list_candidate_groups(known))
    for which in (several['moving mass'], every):
        values = np.where(np.isin(np.arange(len(known)), which), small, 0.0)
        learned = apply_parameters(nominal, known, values)[0]
        file.write_text(
            format_learned_vehicle(text, vehicle, nominal, learned, found), encoding='utf-8'
        )
        again = NominalVehicle.from_vehicle(load_vehicle(str(file)))
        for effect, given in learned.effect_parameters.items():
            held = again.effect_parameters.get(effect, {})
            for parameter, value in given.items():
                assert held.get(parameter, 0.0) == pytest.approx(value, rel=1e-9), effect

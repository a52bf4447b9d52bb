"""What can be turned about each shipped vehicle."""

from dataclasses import replace
import math

from lta_config.files import list_shipped_names
from lta_discovery.model.candidates import DESIGN, NO_CANDIDATE
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_model.effects import EFFECTS
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest


@pytest.mark.parametrize('name', list_shipped_names('vehicles'))
def test_every_knob_of_every_vehicle_builds_a_model_either_side_of_its_step(name: str) -> None:
    nominal = NominalVehicle.from_vehicle(load_vehicle(name))
    found = list_free_parameters(nominal)
    names = [knob.name for knob in found]
    assert len(set(names)) == len(names)
    for knob in found:
        assert knob.low <= 0.0 <= knob.high
        assert knob.tolerance >= 0.0
        knob.apply_to(nominal, knob.step_at(0.0)).build_model()
    assert {'vehicle.mass', 'net_lift.force', 'command_delay.delay'} <= set(names)


def test_a_candidate_is_as_large_as_its_effect_declares(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    declared = {
        f'{effect}.{parameter.name}': parameter.spread
        for effect, kind in EFFECTS.items()
        for parameter in kind.parameters
    }
    for knob in gtmab[1]:
        if knob.typical and knob.name in declared:
            assert knob.typical == declared[knob.name]
            assert knob.name.split('.')[0] not in DESIGN
            assert knob.name not in NO_CANDIDATE


def test_what_is_excluded_is_registered() -> None:
    declared = {
        f'{effect}.{parameter.name}' for effect, k in EFFECTS.items() for parameter in k.parameters
    }
    assert set(EFFECTS) >= DESIGN
    assert declared >= NO_CANDIDATE


def test_the_mass_moves_with_the_trim_kept(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    nominal, turned = gtmab
    mass = next(knob for knob in turned if knob.name == 'vehicle.mass')
    heavier = mass.apply_to(nominal, 0.01)
    assert heavier.mass == pytest.approx(math.exp(0.01) * nominal.mass)
    assert heavier.mass - heavier.displaced == pytest.approx(nominal.mass - nominal.displaced)


def test_a_second_turn_adds_to_the_first(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    # The columns of a fit take that for granted: thrust, mass and drag cancel only to rounding.
    nominal, turned = gtmab
    for knob in turned:
        size = 0.5 * min(knob.tolerance or knob.typical, knob.high) or -0.5 * knob.typical
        twice, once = (
            knob.apply_to(knob.apply_to(nominal, size), size).build_replay_rows(),
            knob.apply_to(nominal, 2.0 * size).build_replay_rows(),
        )
        np.testing.assert_allclose(twice.body, once.body, rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(twice.actuators, once.actuators, rtol=1e-9, atol=1e-15)


def test_a_step_stays_within_the_bounds_on_either_side() -> None:
    down = FreeParameter('k', 's', {('e', 'k'): 1.0}, -0.1, -0.1, low=-1.0, high=1.0)
    assert down.step_at(0.0) == -0.1
    assert down.step_at(-1.0) == 0.1
    up = replace(down, step=0.1, fine=0.1)
    assert up.step_at(0.5) == 0.1
    assert up.step_at(1.0) == -0.1

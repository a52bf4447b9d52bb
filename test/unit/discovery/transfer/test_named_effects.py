"""Groups of parameters that forecasts identify become effects of the registry."""

from types import SimpleNamespace
from typing import Any

from lta_discovery.finding import NamedEffect
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.transfer.candidate_groups import HULL, list_candidate_groups, list_knobs
from lta_discovery.transfer.named_effects import build_named_effects
from lta_model.vehicle import load_vehicle
import numpy as np


def name_groups(vehicle: str, *names: str) -> dict[str, NamedEffect]:
    """Return the effects of some groups, all of whose values are 1e-3."""
    nominal = NominalVehicle.from_vehicle(load_vehicle(vehicle))
    known = list_free_parameters(nominal)
    groups = {one.name: one for one in list_candidate_groups(known)}
    some = [groups[name] for name in names]
    rounds = [[SimpleNamespace(group=one, worth=0.1)] for one in some]
    chosen: Any = SimpleNamespace(
        groups=some, rounds=rounds, log_likelihood_gains=[1.0] * len(some)
    )
    which = list_knobs(some)
    fitted = SimpleNamespace(values=np.full(len(known), 1e-3))
    best: Any = SimpleNamespace(which=which, fitted=fitted, draws=np.full((9, len(which)), 1e-3))
    return {one.name: one for one in build_named_effects(nominal, known, chosen, some, best)}


def test_a_parameter_that_moves_all_of_its_effect_is_named() -> None:
    lag = name_groups('gtmab', 'motor lag')['motor_lag']
    assert lag.knobs == ('motor_lag',)
    assert [one.name for one in lag.parameters] == ['up', 'down']


def test_a_part_of_a_hull_is_named_once_beside_the_whole() -> None:
    found = name_groups('rgblimp', 'added inertia', HULL)
    assert set(found) == {'hull_lift', 'added_mass', 'added_inertia'}
    for one in found.values():
        assert len(set(one.knobs)) == len(one.knobs) > 0
    assert found['added_inertia'].log_evidence == 2.0

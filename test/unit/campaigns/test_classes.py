# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Names that are one to a kind of data: by hand, and as they are frozen."""

from campaigns.class_derivation import (
    cluster_complete_linkage,
    compare_candidates,
    compute_registry_digest,
    select_builtin_parameters,
)
from campaigns.classes import FrozenClasses, load_class_map, TABLE
from campaigns.harness import Case, try_alone
from campaigns.separability import PairSeparability, ParameterPair
from lta_config.files import load_file
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_model.effects import EFFECTS
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest

FROZEN = load_file(FrozenClasses, TABLE)


def _knob(name: str, tolerance: float = 0.0, typical: float = 1.0) -> FreeParameter:
    return FreeParameter(name, '1', {('effect', name): 1.0}, 1e-5, 1e-4, tolerance, typical)


def _reduced(columns: list[list[float]]) -> NDArray[np.float64]:
    """Return the information of readings of noise 1."""
    table = np.array(columns, dtype=np.float64)
    return table.T @ table


def test_two_equal_columns_are_one_name_and_a_third_is_not() -> None:
    knobs = [_knob('a'), _knob('b'), _knob('c')]
    pairs = PairSeparability([_reduced([[3.0, 6.0, 0.0], [4.0, 8.0, 5.0]])], knobs)
    assert pairs.compare_pair(0, 1).cosine == pytest.approx(1.0)
    assert pairs.compare_pair(0, 2).cosine == pytest.approx(0.8)  # (3, 4) and (0, 5)
    found = compare_candidates(pairs, pairs)
    assert found.list_equivalence_classes() == [['a', 'b']]
    assert found.reach == pytest.approx([5.0, 10.0, 5.0])


def test_a_nuisance_takes_its_share_and_a_tolerance_caps() -> None:
    # What (1, 0) leaves of (3, 4) once it may be anything is 4; within 0.5 it takes 9 / 5.
    knobs = [_knob('a'), _knob('n', 1e6, 0.0)]
    assert PairSeparability([_reduced([[3.0, 1.0], [4.0, 0.0]])], knobs).parameter_information(
        0
    ) == pytest.approx(16.0)
    knobs = [_knob('a'), _knob('n', 0.5, 0.0)]
    left = 25.0 - 9.0 / (1.0 + 4.0)
    assert PairSeparability([_reduced([[3.0, 1.0], [4.0, 0.0]])], knobs).parameter_information(
        0
    ) == pytest.approx(left)
    own = [_knob('a', 0.1), _knob('n', 0.5, 0.0)]
    sigma = PairSeparability([_reduced([[3.0, 1.0], [4.0, 0.0]])], own).detection_sigma(0)
    assert sigma == pytest.approx((1.0 / left + 0.01) ** -0.5)
    many = PairSeparability([_reduced([[3.0, 1.0], [4.0, 0.0]])], own, 1e6).detection_sigma(0)
    assert many == pytest.approx(10.0, rel=1e-3)  # a typical 1 by a tolerance of 0.1


def test_flights_add_up_each_with_its_own_errors() -> None:
    both = [[1.0, 1.0], [1.0, -1.0]]
    own = FreeParameter('bias', '1', {('e', 'bias'): 1.0}, 1e-5, 1e-4, 0.5, 2.0, per_flight=True)
    one = PairSeparability([_reduced(both[:1])], [_knob('a'), own])
    two = PairSeparability([_reduced(both[:1]), _reduced(both[1:])], [_knob('a'), own])
    assert one.parameter_information(0) == pytest.approx(1.0 / (1.0 + 0.25))
    assert two.parameter_information(0) == pytest.approx(2.0 / (1.0 + 0.25))
    # A bias that all flights share stands out of what each has of its own.
    assert two.parameter_information(1) == pytest.approx(2.0 / (1.0 + 0.25))
    assert two.detection_sigma(1) == pytest.approx(2.0 * (2.0 / 1.25) ** 0.5)


def test_columns_that_point_the_other_way_are_alike() -> None:
    assert ParameterPair(4.0, 9.0, -3.0).cosine == -0.5


def test_every_two_of_a_group_are_alike() -> None:
    # a is like b and b like c, but a is not like c: no chain.
    cosine = np.array([[1.0, 0.99, 0.9], [0.99, 1.0, 0.985], [0.9, 0.985, 1.0]])
    assert cluster_complete_linkage(cosine, 0.98) == [[0, 1], [2]]


def test_the_frozen_file_is_that_of_the_candidates_as_they_are() -> None:
    nominal = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
    known = select_builtin_parameters(list_free_parameters(nominal))
    assert FROZEN.digest == compute_registry_digest(known), 'run make campaign classes'
    names = {knob.name for knob in known if knob.typical > 0.0}
    assert all(set(kind.reach) == names for kind in FROZEN.kinds.values())


@pytest.mark.long
def test_the_frozen_classes_are_those_that_follow_now() -> None:
    """From vehicle, gains, scene and simulator as they are, of which the digest knows nothing."""
    done = try_alone('classes', Case('all', 0), (), 600.0)
    assert done['wrong'] == ''


def test_effects_that_others_install_are_not_frozen(monkeypatch: pytest.MonkeyPatch) -> None:
    places = [('vehicle', 'mass'), ('net_lift', 'force'), ('not_shipped', 'line')]
    mass, lift, rope = (FreeParameter('.'.join(at), '1', {at: 1.0}, 1e-5, 1e-4) for at in places)
    monkeypatch.setitem(EFFECTS, 'not_shipped', EFFECTS['net_lift'])
    assert select_builtin_parameters([mass, lift, rope]) == [mass, lift]


def test_one_constant_force_has_many_names_and_so_has_one_delay() -> None:
    for kind in FROZEN.kinds:
        classes = load_class_map(kind)
        for name in ('payload.mass', 'ballast.mass', 'gas_purity.purity'):
            assert classes[name] == classes['net_lift.force']
        assert classes['tracker_delay.delay'] == classes['clock_offset.offset']
        # Only sensors on the clock of the commands tell a late command from a late pose.
        one = classes['command_delay.delay'] == classes['tracker_delay.delay']
        assert one == (kind in ('pose', 'wrench'))
        assert classes['linear_drag.surge'] != classes['cg_offset.x']
    assert 'gyro_bias.x' in FROZEN.kinds['pose'].unseen

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The test that tells two effects apart: by hand, by physics, and what is said where none does."""

from lta_config.errors import BadInput
from lta_discovery.lab_tests.between import (
    build_separation_report,
    predict_evidence,
    rate_tests,
    SeparatingTest,
)
from lta_discovery.lab_tests.design import LabTest
from lta_discovery.model.parameters import FreeParameter
from lta_model.vehicle import load_vehicle, Vehicle
import numpy as np
import pytest


@pytest.fixture(scope='module')
def gtmab() -> Vehicle:
    return load_vehicle('gtmab')


def parameter(
    name: str, tolerance: float = 0.0, typical: float = 1.0, per_flight: bool = False
) -> FreeParameter:
    return FreeParameter(
        name, '1', {('effect', name): 1.0}, 1e-5, 1e-4, tolerance, typical, per_flight=per_flight
    )


def test_the_evidence_is_what_the_rival_and_all_tolerances_leave() -> None:
    """Of columns (3, 4), (0, 5) and a nuisance (1, 0) within 0.5, at twice the typical size."""
    columns = np.array([[3.0, 0.0, 1.0], [4.0, 5.0, 0.0]])
    known = [parameter('a'), parameter('b'), parameter('n', 0.5, 0.0)]
    # The nuisance leaves 25 - 9 / 5 of a, 25 of b and 20 of both
    left = 0.5 * 4.0 * (25.0 - 9.0 / 5.0 - 20.0**2 / 25.0)
    assert predict_evidence(columns.T @ columns, known, 0, 1) == pytest.approx(left)
    same = np.array([[3.0, 6.0], [4.0, 8.0]])
    assert predict_evidence(same.T @ same, known[:2], 0, 1) == pytest.approx(0.0, abs=1e-9)


def test_what_differs_between_flights_hides_the_shared_value() -> None:
    """One reading of size 1: a deviation of 0.5 of the flight leaves 1 / (1 + 1 / 4) of it."""
    known = [parameter('bias', 0.5, 2.0, per_flight=True), parameter('b')]
    information = np.diag([1.0, 1.0])
    assert predict_evidence(information, known, 0, 1) == pytest.approx(0.5 * 16.0 / 1.25)


def test_a_step_in_surge_tells_two_effects_in_surge_apart_and_a_spin_down_does_not(
    gtmab: Vehicle,
) -> None:
    rated = rate_tests(gtmab, 'linear_drag.surge', 'added_mass.surge')
    nats = {one.test.name: one.nats for one in rated}
    assert nats['step in surge'] > 100.0 * max(nats['spin-down'], 0.01)
    report = build_separation_report('gtmab', ('linear_drag.surge', 'added_mass.surge'), rated)
    assert report.headline.startswith('To tell linear drag (surge) from added mass (surge), ')


def test_where_no_test_decides_it_says_what_to_measure() -> None:
    rated = [SeparatingTest(LabTest('float', '', 8.0), 0.1)]
    report = build_separation_report('gtmab', ('net_lift.force', 'payload.mass'), rated)
    assert 'weigh the vehicle' in report.headline
    other = build_separation_report('gtmab', ('net_lift.force', 'linear_drag.surge'), rated)
    assert other.headline.endswith('measure one of these effects on its own.')


def test_what_cannot_be_told_apart_is_refused(gtmab: Vehicle) -> None:
    with pytest.raises(BadInput, match=r"effect 'net_lift\.foce'"):
        rate_tests(gtmab, 'net_lift.foce', 'payload.mass')
    with pytest.raises(BadInput, match='is given twice'):
        rate_tests(gtmab, 'cg_offset.x', 'cg_offset.x')

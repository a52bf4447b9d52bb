"""The lamps of a route in their order: which is next, and when each was reached."""

import math
from types import SimpleNamespace

from lta_analysis.report.curves import Motion, Spot
from lta_analysis.report.goal import arrivals, direction, distance, straight, turn
from lta_analysis.report.outcome import sentence
from lta_analysis.report.results import Results, results_of
from lta_sim.scenario import load_scenario
import numpy as np
import pytest

PATROL = load_scenario('warehouse_patrol')  # dock (-3.5, -2), aisle (3.5, -2), gate (0, 4)
ROUND = PATROL.model_copy(update={'route': ('aisle', 'dock')})  # ends where it begins


def flown(x, scenario=ROUND):
    """Return a flight along y = -2, one place a second, nose along x."""
    x = np.array(x, dtype=float)
    zero = np.zeros(len(x))
    here = {'time': np.arange(len(x), dtype=float), 'x': x, 'y': zero - 2.0, 'z': zero + 1.0}
    truth = Motion(**{name: here.get(name, zero) for name in Motion._fields})
    return SimpleNamespace(
        scene=SimpleNamespace(scenario=scenario, vehicle=None), lamp=Spot(0.0, 0.0), truth=truth,
        span=(0.0, float(len(x) - 1)), has=lambda *topics: topics == ('ground_truth/odom',),
    )  # fmt: skip


def test_a_round_is_not_over_where_it_begins():
    view = flown([-3.2, 0.0, 3.0, 3.5, 0.0, -3.0, -3.5])
    assert arrivals(view) == [2.0, 5.0]
    assert turn(view, view.truth.time).tolist() == [0, 0, 0, 1, 1, 1, 1]
    assert distance(view, view.truth) == pytest.approx([6.7, 3.5, 0.5, 7.0, 3.5, 0.5, 0.0])
    back = direction(view, view.truth)[[0, 3]]
    assert np.abs(back) == pytest.approx([0.0, math.pi])  # ahead, then behind
    found = results_of(view)
    assert found.success is True
    assert found.end == 5.0
    assert found.path_length == pytest.approx(6.7 + 6.5)
    assert found.straight_length == pytest.approx(6.7 + 7.0 - 1.0)
    assert straight(view) == found.straight_length


def test_who_never_left_reached_nothing():
    view = flown([-3.2, -3.5, -3.0])
    assert arrivals(view) == []
    found = results_of(view)
    assert found.success is False
    assert found.search_time is None
    assert found.closest is None  # its turn never came
    assert 'one before it on the route' in sentence(found)


def test_the_last_lamp_counts_from_its_turn_on():
    found = results_of(flown([-3.2, 0.0, 3.0, 0.0]))
    assert found.success is False
    assert found.closest == pytest.approx(3.5)
    assert 'no nearer than 3.5 m' in sentence(found)


def test_one_lamp_alone_is_the_last():
    room = load_scenario('lamp_room')  # at (3.5, 0)
    found = results_of(flown([-3.0, 0.0], room))
    assert found.closest == pytest.approx(math.hypot(3.5, 2.0))
    assert found.straight_length == pytest.approx(math.hypot(6.5, 2.0) - 1.0)
    assert isinstance(found, Results)

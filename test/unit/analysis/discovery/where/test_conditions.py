"""The condition under which a disagreement is largest is named, if there is one."""

from dataclasses import replace

from lta_analysis.discovery.flights.measured import Measured, Stream
from lta_analysis.discovery.where.conditions import conditions_of, largest, sector, speed, splits
import numpy as np
import pytest


def _flight(n=1000):
    """Return a flight along x at a speed that changes every 4 s, turning slowly, on level."""
    time = 0.04 * np.arange(n)
    pace = np.where((time // 4.0).astype(int) % 2 == 0, 0.1, 0.6)
    position = np.column_stack([np.cumsum(pace) * 0.04, np.zeros(n), 1.0 + 0.01 * time])
    half = 0.5 * 0.05 * time
    turn = np.column_stack([np.zeros(n), np.zeros(n), np.sin(half), np.cos(half)])
    none = np.full((n, 8), np.nan)
    commands = Stream(np.array([0.0, 20.0]), np.array([[0.2, 0.4], [0.6, 1.0]]))
    unknown = np.full(n, np.nan)
    return Measured(
        time, position, turn, none, np.ones(14), np.ones(n, bool), commands, unknown
    ), pace


def test_speed_height_duty_and_heading_are_those_of_the_flight():
    flight, _ = _flight()
    known = conditions_of(flight)
    assert set(known) == {'speed', 'height', 'duty', 'heading'}
    assert known['speed'][0][50] == pytest.approx(0.1, rel=0.01)
    assert known['speed'][0][150] == pytest.approx(0.6, rel=0.01)
    assert known['height'][0][500] == pytest.approx(1.2)
    assert known['duty'][0][[100, 600]] == pytest.approx([0.3, 0.8])
    assert known['heading'][0][800] == pytest.approx(0.05 * 32.0)
    assert np.isnan(speed(flight)[[0, -1]]).all()


def test_voltage_light_and_commanded_force_are_there_where_they_are_known():
    flight, _ = _flight()
    wrench = Stream(np.array([0.0, 20.0]), np.array([[3.0, 4.0, 0, 0, 0, 0], [0.0] * 6]))
    volts = np.linspace(4.0, 3.8, 1000)
    known = conditions_of(replace(flight, voltage=volts, wrench=wrench), np.ones(1000))
    assert known['commanded force'][0][100] == pytest.approx(5.0)
    assert known['voltage'][1] == 'V'
    assert known['light'][1] == 'lx'


def test_a_disagreement_at_speed_is_told_as_one():
    flight, pace = _flight()
    rng = np.random.default_rng(1)
    index = np.arange(25, 975, 10)
    squares = (np.where(pace > 0.3, 4.0, 1.0)[index] * rng.standard_normal(len(index))) ** 2
    known = {k: (v[index], unit) for k, (v, unit) in conditions_of(flight).items()}
    found = largest(squares, known, 5, 1)
    assert found.name.startswith('speed above 0.')
    assert found.holds[pace[index] > 0.5].mean() > 0.95
    assert found.holds[pace[index] < 0.3].mean() < 0.1


def test_a_disagreement_that_follows_nothing_is_there_always():
    flight, _ = _flight()
    index = np.arange(25, 975, 10)
    known = {k: (v[index], unit) for k, (v, unit) in conditions_of(flight).items()}
    names = []
    for seed in range(20):
        noise = np.random.default_rng(seed).standard_normal(len(index))
        names.append(largest(noise**2, known, 5, seed).name)
    assert names.count('always') >= 18


def test_headings_fall_into_quarters_about_the_axes_of_the_map():
    told = sector(np.radians([0.0, 44.0, 46.0, 90.0, 179.0, -179.0, -90.0, np.nan]))
    assert told.tolist() == [0, 0, 1, 1, 2, 2, 3, -1]
    assert [one.name for one in splits('heading', np.zeros(3), 'rad')] == [
        'heading east', 'heading north', 'heading west', 'heading south',
    ]  # fmt: skip


def test_what_never_changes_makes_no_condition():
    assert splits('height', np.full(50, 1.5), 'm') == []

"""The condition under which a disagreement is largest is named, if there is one."""

from dataclasses import replace

from lta_discovery.discrepancies.conditions import (
    find_largest_condition,
    ground_speed,
    heading_sector,
    list_condition_quantities,
    list_quantity_conditions,
)
from lta_discovery.flights.measured_flight import MeasuredFlight, Stream
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
    return MeasuredFlight(
        time, position, turn, none, np.ones(14), np.ones(n, bool), commands, unknown
    ), pace


def test_speed_height_duty_and_heading_are_those_of_the_flight():
    flight, _ = _flight()
    known = list_condition_quantities(flight)
    assert set(known) == {'speed', 'height', 'duty', 'heading'}
    assert known['speed'][0][50] == pytest.approx(0.1, rel=0.01)
    assert known['speed'][0][150] == pytest.approx(0.6, rel=0.01)
    assert known['height'][0][500] == pytest.approx(1.2)
    assert known['duty'][0][[100, 600]] == pytest.approx([0.3, 0.8])
    assert known['heading'][0][800] == pytest.approx(0.05 * 32.0)
    assert np.isnan(ground_speed(flight)[[0, -1]]).all()


def test_voltage_light_and_commanded_force_are_there_where_they_are_known():
    flight, _ = _flight()
    wrench = Stream(np.array([0.0, 20.0]), np.array([[3.0, 4.0, 0, 0, 0, 0], [0.0] * 6]))
    volts = np.linspace(4.0, 3.8, 1000)
    known = list_condition_quantities(replace(flight, voltage=volts, wrench=wrench), np.ones(1000))
    assert known['commanded force'][0][100] == pytest.approx(5.0)
    assert known['voltage'][1] == 'V'
    assert known['light'][1] == 'lx'


def test_a_disagreement_at_speed_is_told_as_one():
    flight, pace = _flight()
    rng = np.random.default_rng(1)
    index = np.arange(25, 975, 10)
    squares = (np.where(pace > 0.3, 4.0, 1.0)[index] * rng.standard_normal(len(index))) ** 2
    known = {k: (v[index], unit) for k, (v, unit) in list_condition_quantities(flight).items()}
    found = find_largest_condition(squares, known, 5, 1)
    assert found.name.startswith('speed above 0.')
    assert found.holds[pace[index] > 0.5].mean() > 0.95
    assert found.holds[pace[index] < 0.3].mean() < 0.1


def test_a_disagreement_that_follows_nothing_is_there_always():
    flight, _ = _flight()
    index = np.arange(25, 975, 10)
    known = {k: (v[index], unit) for k, (v, unit) in list_condition_quantities(flight).items()}
    names = []
    for seed in range(20):
        noise = np.random.default_rng(seed).standard_normal(len(index))
        names.append(find_largest_condition(noise**2, known, 5, seed).name)
    assert names.count('always') >= 18


def test_headings_fall_into_quarters_about_the_axes_of_the_map():
    told = heading_sector(np.radians([0.0, 44.0, 46.0, 90.0, 179.0, -179.0, -90.0, np.nan]))
    assert told.tolist() == [0, 0, 1, 1, 2, 2, 3, -1]
    assert [one.name for one in list_quantity_conditions('heading', np.zeros(3), 'rad')] == [
        'heading east', 'heading north', 'heading west', 'heading south',
    ]  # fmt: skip


def test_what_never_changes_makes_no_condition():
    assert list_quantity_conditions('height', np.full(50, 1.5), 'm') == []


@pytest.mark.parametrize(('points', 'known'), [(13, []), (14, [6, 7]), (15, [6, 7, 8])])
def test_speed_is_a_central_difference_over_six_points_on_either_side(points, known):
    """The central difference of t^2 is exactly its derivative."""
    flight, _ = _flight(points)
    position = np.outer(flight.time**2, [0.3, 0.0, 0.4])
    found = ground_speed(replace(flight, position=position))
    assert np.flatnonzero(np.isfinite(found)).tolist() == known
    np.testing.assert_allclose(found[known], 2.0 * 0.5 * flight.time[known])


def test_commanded_force_is_without_moments_and_duty_a_mean_of_absolute_values():
    flight, _ = _flight()
    wrench = Stream(np.array([0.0]), np.array([[3.0, 0.0, 4.0, 7.0, 7.0, 7.0]]))
    commands = Stream(np.array([0.0, 20.0]), np.array([[-0.2, 0.4], [-0.6, -1.0]]))
    known = list_condition_quantities(replace(flight, wrench=wrench, commands=commands))
    np.testing.assert_allclose(known['commanded force'][0], 5.0)
    assert known['duty'][0][[0, 499, 500, -1]] == pytest.approx([0.3, 0.3, 0.8, 0.8])
    still = Stream(np.zeros(1), np.zeros((1, 2)))
    assert 'duty' not in list_condition_quantities(replace(flight, commands=still))


def test_each_split_has_a_side_above_its_value_and_one_up_to_it():
    """The quantiles 0.2, 0.25, ... 0.8 of the numbers 0, 1, ... 60 are 12, 15, ... 48."""
    values = np.append(np.arange(61.0), np.nan)
    found = list_quantity_conditions('height', values, 'm')
    assert [one.name for one in found[:2]] == ['height above 12 m', 'height below 12 m']
    assert [one.name for one in found[-2:]] == ['height above 48 m', 'height below 48 m']
    assert [int(one.holds.sum()) for one in found] == [
        count for at in range(12, 49, 3) for count in (60 - at, at + 1)
    ]
    assert not any(one.holds[-1] for one in found)
    assert list_quantity_conditions('duty', values, '1')[0].name == 'duty above 12'


def test_equal_quantiles_make_one_split():
    values = np.repeat([1.0, 2.0], [90, 10])
    assert [one.name for one in list_quantity_conditions('height', values, 'm')] == [
        'height above 1 m', 'height below 1 m',
    ]  # fmt: skip
    assert list_quantity_conditions('height', np.full(5, np.nan), 'm') == []


def _condition(north, n, block, ratio=100.0, east=False):
    """Return the condition named if squares are `ratio` while heading north (east) and else 1."""
    heading = np.zeros(n)
    heading[10 : 10 + north] = 0.5 * np.pi
    squares = np.ones(n)
    squares[heading == 0.0 if east else heading > 0.0] = ratio
    return find_largest_condition(squares, {'heading': (heading, 'rad')}, block, 3).name


@pytest.mark.parametrize(
    ('north', 'n', 'block', 'told'),
    [  # Either side needs n // 10 rows, and 2 * block rows.
        (8, 95, 2, False), (9, 95, 2, True), (9, 90, 2, True), (8, 90, 2, False),
        (5, 40, 3, False), (6, 40, 3, True),
        (11, 35, 6, False), (12, 35, 6, False), (12, 36, 6, True),  # and all together 6 * block
    ],
)  # fmt: skip
def test_either_side_of_a_condition_needs_enough_rows(north, n, block, told):
    assert _condition(north, n, block) == ('heading north' if told else 'always')
    assert _condition(north, n, block, east=True) == ('heading east' if told else 'always')


@pytest.mark.parametrize(('ratio', 'told'), [(2.5, 'always'), (2.6, 'heading north')])
def test_root_mean_squares_have_to_differ_by_a_factor_of_1_6(ratio, told):
    """The roots of 2.5 and 2.6 are 1.58 and 1.61."""
    assert _condition(40, 95, 2, ratio) == told


def test_a_gain_below_one_nat_suffices_if_chance_gains_less():
    """Four of 14 rows with a square of 2.6 gain (14 ln 1.457 - 4 ln 2.6) / 2 = 0.72 nats."""
    assert _condition(4, 14, 2, 2.6) == 'heading north'


@pytest.mark.parametrize('unit', [1.0, 1e-6])
def test_the_condition_that_gains_most_likelihood_is_named(unit):
    """
    Two variances gain likelihood over one, whatever the unit.

    A condition under which the variance is lower does not count.
    """
    squares = np.ones(200)
    squares[50:90], squares[90:100] = 16.0, 6.0
    wide, narrow, low = np.zeros((3, 200))
    wide[50:100], narrow[50:90], low[100:160] = 1.0, 1.0, 1.0
    known = {name: (values, '1') for name, values in
             (('narrow', narrow), ('wide', wide), ('low', low))}  # fmt: skip
    found = find_largest_condition(unit * squares, known, 4, 1)
    # Twice the gain is n ln s less the same of each side, s being the mean square:
    # 200 ln 4.25 - 50 ln 14 = 157.4 for wide,
    # 200 ln 4.25 - 40 ln 16 - 160 ln 1.3125 = 135.0 for narrow.
    assert found.name == 'wide above 0'
    np.testing.assert_array_equal(found.holds, wide > 0.0)


def test_a_condition_outside_which_the_disagreement_is_zero_is_named():
    heading = np.repeat([0.0, 0.5 * np.pi, 0.0], [30, 30, 40])
    squares = np.where(heading > 0.0, 1.0, 0.0)
    assert (
        find_largest_condition(squares, {'heading': (heading, 'rad')}, 2, 1).name
        == 'heading north'
    )


def test_a_condition_is_named_if_chance_does_as_well_at_most_once_in_a_hundred():
    """
    The disagreement has two equal parts half of the flight apart.

    So one of the 100 possible shifts, that by half of the flight, gains as much as none. The
    condition is named if at most one of 199 random shifts is that one, (1 + 1) / 200 = 0.01, which
    has a binomial probability of 41 % for each seed; for none it is 14 %, for at most two 68 %.
    """
    heading = np.zeros(104)
    heading[10:20] = heading[62:72] = 0.5 * np.pi
    squares = np.where(heading > 0.0, 100.0, 1.0)
    told = [
        find_largest_condition(squares, {'heading': (heading, 'rad')}, 2, seed).name
        for seed in range(60)
    ]
    assert 17 <= told.count('heading north') <= 32
    assert told.count('heading north') + told.count('always') == 60

"""Where and when a model disagrees is told of the right axis, time and condition."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

from lta_discovery.discrepancies import discrepancy_search as module
from lta_discovery.discrepancies.change_point import ChangePoint
from lta_discovery.discrepancies.conditions import FlightCondition
from lta_discovery.discrepancies.discrepancy_search import (
    BaselineFlight,
    DisagreementSeries,
    find_discrepancies,
)
from lta_discovery.finding import Discrepancy
from lta_discovery.fit.evidence import build_prior, wrench_floor
from lta_discovery.fit.joint_fit import fit_flight
from lta_discovery.flights.measured_flight import Stream
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.replay.replay import FlightReplay
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

Known = tuple[NominalVehicle, list[FreeParameter]]
FAILED = 24.0  # s


@pytest.fixture(scope='module')
def failing(gtmab: Known) -> FlightLinearizer:
    """A flight in which a forward rotor begins to do less than it is told."""
    whole = prepared(flown({}, 1, 48.0), gtmab[1])
    flight = whole.replay.flight
    told = flight.commands.values.copy()
    told[flight.commands.time > FAILED, 2] *= 2.0  # as if it had been told more all along
    told = np.minimum(told, 1.0)
    flight = replace(flight, commands=Stream(flight.commands.time, told))
    replay = FlightReplay(flight, whole.replay.cut, load_vehicle('gtmab').pack_command(()))
    return FlightLinearizer(replay, gtmab[1], whole.places)


def _seen(known: Known, flight: FlightLinearizer) -> BaselineFlight:
    nominal, knobs = known
    begin = unchanged_vehicle_point(nominal, knobs, flight.replay.cut)
    return BaselineFlight(
        'one', flight, begin, fit_flight(flight, nominal, build_prior(knobs), begin, rounds=3)
    )


@pytest.mark.long
def test_a_rotor_that_fails_is_told_with_its_time(gtmab: Known, failing: FlightLinearizer) -> None:
    found = find_discrepancies([_seen(gtmab, failing)], 1)
    assert [one.ratio_to_noise for one in found] == sorted(
        (one.ratio_to_noise for one in found), reverse=True
    )
    (change,) = [one for one in found if one.condition.startswith('after')]
    assert change.condition.endswith('as if rotor_fault.lost_3 had changed')
    assert change.from_s == pytest.approx(FAILED, abs=6.0)  # to a piece
    assert change.channel in {'surge', 'yaw', 'pitch'}
    assert 'x' in {one.channel for one in found}


def test_a_clean_flight_disagrees_hardly_anywhere(gtmab: Known, clean: FlightLinearizer) -> None:
    """What is told begins at twice the noise; of 30 s and 14 channels one may just reach it."""
    found = find_discrepancies([_seen(gtmab, clean)], 1)
    assert len(found) <= 1
    assert all(one.ratio_to_noise < 2.5 for one in found)


def test_without_a_fit_the_channels_alone_are_told(
    gtmab: Known, failing: FlightLinearizer
) -> None:
    begin = unchanged_vehicle_point(*gtmab, failing.replay.cut)
    found = {
        place.channel for place in find_discrepancies([BaselineFlight('one', failing, begin)], 1)
    }
    assert 'x' in found
    assert not {'surge', 'yaw'} & found


def _quantity(name: str, *values: float) -> DisagreementSeries:
    return DisagreementSeries(name, np.array(values), np.arange(len(values)), 1)


def test_each_channel_is_reported_for_the_flight_where_it_is_worst(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """
    A channel counts above twice its noise, one of the IMU above ten times.

    At most 24 places are returned.
    """
    channels = {
        'one': [('x', 2.0), ('y', 2.1), ('z', 5.0), ('p', 9.9), ('fz', 10.1), ('range', 1.9)],
        'two': [('x', 1.9), ('y', 2.5), ('z', 4.0), ('p', 0.0), ('fz', 12.0), ('range', 0.0)],
    }
    told = {
        name: [_quantity(channel, size, -size) for channel, size in each]
        for name, each in channels.items()
    }
    monkeypatch.setattr(module, '_channel_series', lambda one: told[one.name])
    monkeypatch.setattr(module, '_force_series', lambda one: [_quantity('surge', 3.0, -4.0, 0.0)])
    monkeypatch.setattr(module, '_find_changes', lambda one, forces, seed: [])
    monkeypatch.setattr(
        module,
        '_locate_discrepancy',
        lambda one, quantity, seed: Discrepancy(
            one.name, quantity.name, 0.0, 1.0, 'always', float(np.abs(quantity.values).max())
        ),
    )
    seen = [BaselineFlight(name, None, None) for name in channels]  # type: ignore[arg-type]
    found = [(one.channel, one.flight) for one in find_discrepancies(seen, 1)]
    assert found == [('fz', 'two'), ('z', 'one'), ('surge', 'one'), ('y', 'two')]
    many = [Discrepancy('one', 'surge', 0.0, 1.0, 'after 1 s', 20.0 + k) for k in range(30)]
    monkeypatch.setattr(module, '_find_changes', lambda one, forces, seed: many)
    sizes = [one.ratio_to_noise for one in find_discrepancies(seen[:1], 1)]
    assert sizes == [49.0 - k for k in range(24)]


def test_a_size_is_a_root_mean_square_and_0_if_there_are_no_values() -> None:
    assert module._rms(np.array([3.0, -4.0, 0.0, 0.0])) == pytest.approx(2.5)
    assert module._rms(np.empty(0)) == 0.0


def test_channels_have_a_root_mean_square_for_each_second(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """
    The three pieces of 2.2 s have two whole seconds each.

    A channel that is known in no more seconds than two pieces have is left out.
    """
    left = np.full((3, 55, 14), np.nan)
    for piece in range(3):
        for second in range(2):
            part = left[piece, 25 * second : 25 * second + 25]
            part[:, :2] = 1.0 + piece + 3 * second
            part[::2, :2] *= -1.0
            part[20:, :2] = np.nan
    left[:, 50:, :2] = 77.0
    left[1:, :25, 1] = np.nan
    monkeypatch.setattr(module, 'best_start_residual', lambda flight, point: left)
    flight = SimpleNamespace(index=np.arange(165).reshape(3, 55))
    found = module._channel_series(BaselineFlight('one', flight, None))
    assert [(one.name, one.block) for one in found] == [('x', 2)]
    np.testing.assert_allclose(found[0].values, [1.0, 4.0, 2.0, 5.0, 3.0, 6.0])
    assert found[0].index.tolist() == [12, 37, 67, 92, 122, 147]


def test_forces_are_taken_at_the_knots_inside_the_cut(
    gtmab: Known, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nine knots over 17 points are two points apart."""
    inside = np.ones((2, 17), dtype=bool)
    inside[1, 9:] = False
    cut = SimpleNamespace(length=17, inside=inside, knots=9)
    flight = SimpleNamespace(
        replay=SimpleNamespace(cut=cut), index=np.array([[100], [200]]) + np.arange(17)
    )
    knots = np.arange(108.0).reshape(18, 6)
    monkeypatch.setattr(module, 'latent_at_knots', lambda fitted: knots)
    before = SimpleNamespace(nominal=gtmab[0])
    found = module._force_series(BaselineFlight('one', flight, before, SimpleNamespace()))
    assert [one.name for one in found] == ['surge', 'sway', 'heave', 'roll', 'pitch', 'yaw']
    for k, one in enumerate(found):
        assert one.index.tolist() == [*range(100, 117, 2), *range(200, 209, 2)]
        np.testing.assert_allclose(one.values, knots[:14, k] / wrench_floor(gtmab[0])[k])
        assert one.block == 9
    assert module._force_series(BaselineFlight('one', flight, before)) == []


def test_a_place_is_where_its_condition_holds_longest(monkeypatch: pytest.MonkeyPatch) -> None:
    """
    The longest run is that of the longest time, not of the most values.

    The size is the root mean square of all values for which the condition holds.
    """
    time = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 10.0, 11.0, 30.0])
    flight = SimpleNamespace(time=np.repeat(time, 2))
    holds = np.array([1, 0, 1, 1, 1, 0, 1, 1], dtype=bool)
    values = np.array([3.0, 9.0, 4.0, 0.0, 0.0, 9.0, 0.0, -5.0])
    asked = {}

    def largest(squares, known, block, seed):
        asked.update(squares=squares, known=known, block=block, seed=seed)
        return FlightCondition('speed above 1 m/s', holds)

    conditions = {'speed': (np.arange(16.0), 'm/s')}
    monkeypatch.setattr(module, 'list_condition_quantities', lambda flight, light: conditions)
    monkeypatch.setattr(module, 'find_largest_condition', largest)
    one = BaselineFlight('one', SimpleNamespace(replay=SimpleNamespace(flight=flight)), None)
    found = module._locate_discrepancy(
        one, DisagreementSeries('x', values, np.arange(0, 16, 2), 3), 7
    )
    assert found[:5] == ('one', 'x', 11.0, 30.0, 'speed above 1 m/s')
    assert found.ratio_to_noise == pytest.approx(np.sqrt((9.0 + 16.0 + 25.0) / 6.0))
    assert (asked['block'], asked['seed']) == (3, 7)
    np.testing.assert_array_equal(asked['squares'], values**2)
    assert asked['known']['speed'][0].tolist() == [0, 2, 4, 6, 8, 10, 12, 14]


def test_a_change_is_reported_for_the_axis_that_is_worst_after_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    replay = SimpleNamespace(
        cut=SimpleNamespace(first=np.array([0, 10, 20])),
        flight=SimpleNamespace(time=0.5 * np.arange(30)),
    )
    index = np.arange(0, 30, 5)
    forces = [
        DisagreementSeries('surge', np.array([9.0, 9.0, 1.0, 1.0, 1.0, 1.0]), index, 2),
        DisagreementSeries('sway', np.array([0.0, 0.0, 3.0, -1.0, 1.0, 1.0]), index, 2),
    ]
    found = ChangePoint(1, 'net_lift.force', 9.0)
    monkeypatch.setattr(module, 'find_change_point', lambda fitted, knobs, seed: found)
    monkeypatch.setattr(module, '_complete_columns', lambda fitted, flight: fitted)
    one = BaselineFlight('one', SimpleNamespace(replay=replay, knobs=[]), None, SimpleNamespace())
    (told,) = module._find_changes(one, forces, 1)
    said = 'from about 5 s on, as if net_lift.force had changed'
    assert told[:5] == ('one', 'sway', 5.0, 12.5, said)
    assert told.ratio_to_noise == pytest.approx(np.sqrt(3.0))
    monkeypatch.setattr(module, 'find_change_point', lambda fitted, knobs, seed: None)
    assert module._find_changes(one, forces, 1) == []
    assert module._find_changes(replace(one, fit=None), forces, 1) == []


@dataclass
class LinearOnly:
    """A fit of which only the linear model is needed."""

    linear: object


@pytest.mark.parametrize(('k', 'again'), [(0, True), (1, False), (2, True)])
def test_a_flight_is_linearised_again_if_a_candidate_has_no_column(k: int, again: bool) -> None:
    """
    Columns are two unknowns of pieces, three knobs, one sensor and the residual.

    The second knob is no candidate.
    """
    grams = np.ones((2, 7, 7))
    grams[:, 2 + k, 2 + k] = 0.0
    grams[:, 5, 5] = grams[:, 0, 0] = 0.0
    fitted = LinearOnly(SimpleNamespace(grams=grams, names=tuple('abcd'), point='here'))
    knobs = [SimpleNamespace(typical=size) for size in (1.0, 0.0, 2.0)]
    flight = SimpleNamespace(knobs=knobs, linearize=lambda point: f'linearised {point}')
    found = module._complete_columns(fitted, flight)
    assert found.linear == 'linearised here' if again else found is fitted

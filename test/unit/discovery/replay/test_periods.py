"""How many knots a flight needs, held against a pendulum worked out by hand."""

from dataclasses import replace

from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.flights.windows import KNOTS
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.quaternions import quaternion_exponential
from lta_discovery.replay import knot_count
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.knot_count import count_needed_knots, find_swing_periods, vehicle_period
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]


def _swung(
    flight: MeasuredFlight, seconds: float, tilt: float = 0.1, axis: int = 1
) -> MeasuredFlight:
    """Return a flight of which the attitude swings about one axis, and no other motion."""
    turn = np.zeros((len(flight.time), 3))
    turn[:, axis] = tilt * np.sin(2.0 * np.pi * flight.time / seconds)
    turn += 1e-4 * np.random.default_rng(3).standard_normal(turn.shape)
    return replace(flight, quaternion=quaternion_exponential(turn))


def test_the_period_of_a_vehicle_is_that_of_the_pendulum_that_it_is(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    """Buoyancy at the hull centre, weight below it: w^2 = m g d over the inertia that is felt."""
    vehicle = gtmab[0]
    inverse = np.reshape(vehicle.build_model().inverse, (6, 6))
    stiffness = vehicle.mass * 9.80665 * -vehicle.cg[2]
    fastest = np.sqrt(stiffness * max(inverse[3, 3], inverse[4, 4]))
    assert vehicle_period(clean, vehicle) == pytest.approx(2.0 * np.pi / fastest, rel=0.05)


def test_a_lower_centre_of_gravity_swings_faster_and_needs_more_knots(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    deep = gtmab[0].with_value('cg_height', 'z', -0.10)
    assert vehicle_period(clean, deep) < 0.8 * vehicle_period(clean, gtmab[0])
    assert count_needed_knots([clean], deep) > 1.25 * count_needed_knots([clean], gtmab[0])


@pytest.mark.parametrize(('seconds', 'axis'), [(1.6, 1), (2.5, 0), (1.2, 2)])
def test_a_swing_of_the_attitude_has_its_period(
    clean: FlightLinearizer, seconds: float, axis: int
) -> None:
    """Of spectra of 256 points at 25 Hz, 0.1 Hz apart."""
    found = list(find_swing_periods(_swung(clean.replay.flight, seconds, axis=axis)))
    assert [1.0 / one for one in found] == pytest.approx([1.0 / seconds], abs=0.06)


def test_what_a_tracker_makes_up_is_no_swing(clean: FlightLinearizer) -> None:
    assert not list(find_swing_periods(_swung(clean.replay.flight, 1.0, tilt=0.0)))


@pytest.mark.parametrize(
    ('vehicle', 'seen', 'knots'),
    [(2.0, [], 19), (6.0, [2.0], 19), (2.0, [1.2], 31), (9.0, [], KNOTS), (0.5, [], 37)],
)
def test_six_knots_are_in_the_shortest_period(
    gtmab: Known,
    clean: FlightLinearizer,
    monkeypatch: pytest.MonkeyPatch,
    vehicle: float,
    seen: list[float],
    knots: int,
) -> None:
    """A piece of 6 s has 6 x 6 / T intervals, within 8 and 36."""
    monkeypatch.setattr(knot_count, 'vehicle_period', lambda flight, nominal: vehicle)
    monkeypatch.setattr(knot_count, 'find_swing_periods', lambda flight: iter(seen))
    assert count_needed_knots([clean, clean], gtmab[0]) == knots


def test_a_flight_with_other_knots_has_the_same_pieces(clean: FlightLinearizer) -> None:
    more = clean.with_knots(19)
    assert more.replay.cut.knots == 19
    assert more.random == 12 + 6 * 19 + 1
    np.testing.assert_array_equal(more.replay.cut.start, clean.replay.cut.start)

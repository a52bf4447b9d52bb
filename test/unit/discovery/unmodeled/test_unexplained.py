"""What has no name is described: its axis, its size, and what it follows on both flights."""

from types import SimpleNamespace

from lta_discovery.fit.evidence import build_prior, FLOOR
from lta_discovery.fit.joint_fit import fit_flight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.linearized_flight import count_unknowns, unchanged_vehicle_point
from lta_discovery.unmodeled import unexplained_force
from lta_discovery.unmodeled.unexplained_force import (
    find_unexplained_forces,
    latent_at_knots,
    measure_latent_spread,
    select_terms,
    state_terms,
    states_at_knots,
)
from lta_model.effects.protocol import AXES
import numpy as np
import pytest
from scipy.linalg import hadamard

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

Known = tuple[NominalVehicle, list[FreeParameter]]
RANDOM = count_unknowns(9)
RNG = np.random.default_rng(5)


def _states(count: int) -> np.ndarray:
    states = RNG.normal(size=(count, 13))
    states[:, 3:7] /= np.linalg.norm(states[:, 3:7], axis=1, keepdims=True)
    return states


def test_a_force_that_follows_a_product_is_described_by_it() -> None:
    pair = [_states(120), _states(90)]
    forces = [s[:, 7] * s[:, 12] + 0.5 * RNG.standard_normal(len(s)) for s in pair]
    names, share = select_terms(pair, forces)
    assert names == ('surge speed x yaw rate',)
    assert share == pytest.approx(0.8, abs=0.12)  # 1 / (1 + 0.25) of the variance


def test_noise_follows_nothing() -> None:
    pair = [_states(120), _states(90)]
    names, share = select_terms(pair, [RNG.standard_normal(len(s)) for s in pair])
    assert names == ()
    assert share < 0.15


@pytest.mark.long
def test_turbulence_remains_on_the_axes_that_it_pushes(gtmab: Known) -> None:
    air = {
        f'vehicle.effects.turbulence.{name}': {'value': value, 'unit': unit}
        for name, value, unit in (
            ('along', 0.06, 'm/s'), ('across', 0.06, 'm/s'), ('up', 0.0, 'm/s'),
            ('along_length', 2.0, 'm'), ('across_length', 2.0, 'm'), ('up_length', 2.0, 'm'),
        )
    }  # fmt: skip
    nominal, knobs = gtmab
    flights = tuple(prepared(flown(air, seed, 26.0), knobs) for seed in (81, 82))
    prior = build_prior(knobs)
    fits = [
        fit_flight(
            flight, nominal, prior, unchanged_vehicle_point(nominal, knobs, flight.replay.cut)
        )
        for flight in flights
    ]
    left = find_unexplained_forces([[one] for one in flights], [[one] for one in fits])
    assert {'surge', 'sway'} <= {one.axis for one in left}
    together = {
        axis: np.exp(np.mean([np.log(each.deviations[k]) for each in fits]))
        for k, axis in enumerate(AXES)
    }
    for one in left:
        # Air with a memory like that of the model: both measures agree
        assert one.size == pytest.approx(together[one.axis], rel=0.35)
        assert one.size == pytest.approx(one.floors * FLOOR[AXES.index(one.axis)])


def test_knots_have_a_row_for_each_knot_of_each_piece_and_a_column_for_each_axis() -> None:
    """A piece has twelve unknowns of its state, then nine knots of surge, nine of sway, ..."""
    asked = []

    def solved(deviations, change):
        asked.append((deviations, change))
        return np.arange(3.0 * RANDOM).reshape(3, RANDOM)

    fitted = SimpleNamespace(
        pieces=SimpleNamespace(solve_unknowns=solved),
        deviations='these',
        linear=SimpleNamespace(names=tuple('abc'), knots=9),
    )
    knots = latent_at_knots(fitted)
    assert knots.shape == (27, 6)
    for piece, knot, axis in ((0, 0, 0), (0, 8, 1), (2, 3, 5)):
        assert knots[9 * piece + knot, axis] == RANDOM * piece + 12 + 9 * axis + knot
    assert asked[0][0] == 'these'
    np.testing.assert_array_equal(asked[0][1], np.zeros(3))


def test_the_spread_of_a_force_is_that_over_time_and_its_uncertainty(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """
    The most probable force of an axis k goes from k to k + 6 and back, on straight lines.

    Such a triangle has a variance of 6^2 / 12 = 3, whatever its mean. The errors of neighbouring
    knots, of variance 16, have a covariance of -8: on the line between them, the mean variance is
    (16 - 8 + 16) / 3 = 8. On the last axis they have none: (16 + 0 + 16) / 3 = 10.7.
    """
    inverse = np.zeros((2, 6, 3, 6, 3))
    for axis in range(6):
        inverse[:, axis, :, axis] = 16.0 * np.eye(3)
        if axis < 5:
            inverse[:, axis, [0, 1, 1, 2], axis, [1, 0, 2, 1]] = -8.0
    fitted = SimpleNamespace(
        pieces=SimpleNamespace(
            solve_latent=lambda _: SimpleNamespace(inverse=inverse.reshape(2, 18, 18))
        ),
        deviations=None,
        linear=SimpleNamespace(knots=3),
    )
    knots = np.arange(6.0) + 6.0 * np.array([0.0, 1.0, 0.0] * 2)[:, None]
    monkeypatch.setattr(unexplained_force, 'latent_at_knots', lambda fit: knots)
    expected = [11.0**0.5] * 5 + [(3.0 + 32.0 / 3.0) ** 0.5]
    np.testing.assert_allclose(measure_latent_spread(fitted), expected)


def test_states_are_taken_at_nine_evenly_spaced_knots_of_each_piece() -> None:
    states = np.arange(2.0 * 17 * 13).reshape(2, 17, 13)
    flight = SimpleNamespace(simulate_trajectory=lambda point: states if point == 'here' else None)
    fitted = SimpleNamespace(linear=SimpleNamespace(point='here', knots=9))
    found = states_at_knots(flight, fitted)
    np.testing.assert_array_equal(found, np.vstack([states[0, ::2], states[1, ::2]]))


def test_terms_are_functions_of_the_state() -> None:
    """The state is yawed by 30 degrees."""
    half = np.radians(15.0)
    state = [1.0, 2.0, 3.0, 0.0, 0.0, np.sin(half), np.cos(half), 0.1, -0.2, 0.3, 0.4, 0.5, -0.6]
    found = {name: float(value[0]) for name, value in state_terms(np.array([state])).items()}
    expected = {
        'constant': 1.0, 'x': 1.0, 'y': 2.0, 'height': 3.0, 'heading (cosine)': 0.75**0.5,
        'heading (sine)': 0.5, 'surge speed': 0.1, 'sway speed squared': -0.04,
        'sway speed either way': 0.2, 'heave speed squared': 0.09, 'yaw rate either way': 0.6,
        'surge speed x sway speed': -0.02, 'surge speed x yaw rate': -0.06,
        'pitch rate x yaw rate': -0.3,
    }  # fmt: skip
    assert {name: found[name] for name in expected} == pytest.approx(expected)
    assert len(found) == 6 + 3 * 6 + 15


# Seven mutually orthogonal series, each with a mean square of 1.
APART = hadamard(64)[:, [1, 2, 4, 8, 16, 32, 63]].astype(float)


@pytest.mark.parametrize(
    ('shares', 'names', 'told'),
    [
        ((0.90, 0.06, 0.04), 'ab', 0.96),  # a further term has to explain 0.05
        ((0.30, 0.25, 0.20, 0.15), 'abc', 0.75),  # there are three terms at most
        ((0.10, 0.20), 'ba', 0.30),  # the strongest term comes first
        ((0.16,), 'a', 0.16),
        ((0.14,), '', 0.14),  # gusts explain 0.15 by chance
        ((0.04,), '', 0.0),
    ],
)
def test_a_force_follows_the_terms_that_explain_most_of_its_variance(
    monkeypatch: pytest.MonkeyPatch, shares: tuple[float, ...], names: str, told: float
) -> None:
    known = dict(zip('abcdef', 0.01 * APART.T, strict=False))
    monkeypatch.setattr(unexplained_force, 'state_terms', lambda states: known)
    parts = np.zeros(7)
    parts[: len(shares)] = shares
    parts[6] = 1.0 - sum(shares)  # no term explains this share
    force = 3.0 * APART @ np.sqrt(parts)
    found, share = select_terms([APART, APART], [force, force])
    assert ''.join(found) == names
    assert share == pytest.approx(told, abs=1e-4)


def test_a_term_that_explains_one_flight_alone_is_not_followed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A fit to either flight has to explain the other one."""
    known = dict(zip('abcd', APART[:, [0, 3, 4, 5]].T, strict=True))
    monkeypatch.setattr(unexplained_force, 'state_terms', lambda states: known)
    for pair in ((APART[:, 0], APART[:, 1]), (APART[:, 1], APART[:, 0])):
        assert select_terms([APART, APART], pair) == ((), 0.0)
    # If the force is twice as strong on one flight, a fit to that explains 1 - (1 - 2)^2 = 0 of
    # the other, and a fit to the other 1 - (1 - 1 / 2)^2 = 3 / 4 of it. The smaller share counts.
    assert select_terms([APART, APART], [APART[:, 0], 2.0 * APART[:, 0]]) == ((), 0.0)
    # If it is 1.5 times as strong, the smaller share is 1 - (1 - 1.5)^2 = 3 / 4.
    names, share = select_terms([APART, APART], [APART[:, 0], 1.5 * APART[:, 0]])
    assert (names, share) == (('a',), pytest.approx(0.75, abs=1e-2))


def test_an_axis_counts_if_the_mean_of_all_flights_is_above_2_5_floors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """
    The geometric means of the two sides are 2.449, 2.550, 3, 10, 1 and 2.49 floors.

    The reported size is the root mean square of the sides' own spread.
    """
    sizes = ([1.0, 1.3, 9.0, 4.0, 1.0, 2.49], [6.0, 5.0, 1.0, 25.0, 1.0, 2.49])
    fits = [[SimpleNamespace(deviations=np.array(size) * FLOOR)] for size in sizes]
    knots = [np.arange(12.0).reshape(2, 6), np.arange(12.0, 24.0).reshape(2, 6)]
    monkeypatch.setattr(
        unexplained_force, '_collect_knots', lambda flights, fits: (['states'], knots)
    )
    # 3 and 4 floors on the two sides: a root mean square of 12.5 ** 0.5
    monkeypatch.setattr(
        unexplained_force,
        'measure_latent_spread',
        lambda fit: (3.0 if fit is fits[0][0] else 4.0) * np.arange(1.0, 7.0) * FLOOR,
    )
    asked = []
    monkeypatch.setattr(
        unexplained_force,
        'select_terms',
        lambda states, forces: asked.append(forces) or (('x',), 0.5),
    )
    found = find_unexplained_forces([[], []], fits)
    assert [one.axis for one in found] == ['roll', 'heave', 'sway']
    floors = 12.5**0.5 * np.array([4.0, 3.0, 2.0])
    np.testing.assert_allclose([one.floors for one in found], floors)
    np.testing.assert_allclose([one.size for one in found], floors * [8e-5, 4e-4, 4e-4])
    assert [[each.tolist() for each in forces] for forces in asked] == [
        [[k, k + 6.0], [k + 12.0, k + 18.0]] for k in (1.0, 2.0, 3.0)
    ]
    lower = find_unexplained_forces([[], []], fits, 0.5 * FLOOR, 4.95)
    assert [one.axis for one in lower] == ['yaw', 'roll', 'heave', 'sway']

"""Columns are derivatives of what would be measured, and scale together as forces do."""

from dataclasses import replace
from types import SimpleNamespace

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.windows import KNOTS
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay import flight_linearizer
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import count_unknowns, SENSORS, unchanged_vehicle_point
from lta_discovery.replay.replay import FlightReplay, STEPS
from lta_discovery.replay.sensing import apply_channel_effects
from lta_discovery.replay.variational_equation import WIDTH
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
RANDOM = count_unknowns(KNOTS)
CHECKED = (
    'thrust_scale.factor', 'rotor_fault.lost_3', 'linear_drag.surge', 'quadratic_drag.heave',
    'vehicle.mass', 'cg_offset.y', 'munk_moment.lost', 'motor_lag', 'command_delay.delay',
    'battery_sag.sensitivity', 'helium_leak.rate', 'gyro_scale.z', 'range_offset.offset',
    'tracker_misalignment.pitch', 'tracker_delay.delay', 'steady_wind.x', 'ground_effect.gain',
)  # fmt: skip


@pytest.fixture(scope='module')
def columns(gtmab: Known, clean: FlightLinearizer) -> NDArray[np.float64]:
    """The whitened columns of the clean flight."""
    return clean.compute_whitened_columns(
        unchanged_vehicle_point(gtmab[0], gtmab[1], clean.replay.cut)
    )[0]


def _left(
    flight: FlightLinearizer, nominal: NominalVehicle, random: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return measured less predicted by the noise, flown with other parameters."""
    point = replace(
        unchanged_vehicle_point(nominal, flight.knobs, flight.replay.cut), random=random
    )
    grid = flight.simulate_trajectory(point)[:, ::STEPS]
    return (
        flight.compute_residual(grid, point, flight.replay.build_replay_rows(nominal))
        / flight.replay.flight.noise
    )


def _differ(expected: NDArray[np.float64], column: NDArray[np.float64]) -> float:
    known = np.isfinite(expected)
    off = np.linalg.norm((expected - column)[known])
    return float(off / np.linalg.norm(column[known]))


@pytest.mark.parametrize('name', CHECKED)
def test_a_column_is_what_flying_with_the_knob_turned_changes(
    gtmab: Known, clean: FlightLinearizer, columns: NDArray[np.float64], name: str
) -> None:
    nominal, knobs = gtmab
    k = [knob.name for knob in knobs].index(name)
    still, step = np.zeros((len(clean.replay.first), RANDOM)), 1e-3 * knobs[k].typical or 1e-4
    if name == 'command_delay.delay':
        step = 1e-3
    before = _left(clean, knobs[k].enable_effect(nominal), still)
    after = _left(clean, knobs[k].apply_to(nominal, step), still)
    assert _differ((before - after) / step, columns[..., RANDOM + k]) < 0.01


@pytest.mark.parametrize('k', [0, 4, 7, 11, 12, 24, 40, 55, 60, RANDOM - 1])
def test_states_knots_and_pressure_have_theirs(
    gtmab: Known, clean: FlightLinearizer, columns: NDArray[np.float64], k: int
) -> None:
    still = np.zeros((len(clean.replay.first), RANDOM))
    moved = still.copy()
    moved[:, k] = 1e-5
    change = (_left(clean, gtmab[0], still) - _left(clean, gtmab[0], moved)) / 1e-5
    assert _differ(change, columns[..., k]) < 0.01


@pytest.mark.parametrize('k', range(len(SENSORS)))
def test_columns_of_sensor_errors_are_derivatives_of_the_residual(
    gtmab: Known, clean: FlightLinearizer, columns: NDArray[np.float64], k: int
) -> None:
    point = unchanged_vehicle_point(gtmab[0], gtmab[1], clean.replay.cut)
    grid, rows = clean.simulate_trajectory(point)[:, ::STEPS], gtmab[0].build_replay_rows()
    values = point.values.copy()
    values[len(gtmab[1]) + k] = 0.01
    there = replace(point, values=values)
    change = clean.compute_residual(grid, point, rows) - clean.compute_residual(grid, there, rows)
    noise = clean.replay.flight.noise
    assert _differ(change / noise / 0.01, columns[..., RANDOM + len(gtmab[1]) + k]) < 1e-9


def test_columns_of_some_pieces_and_products_of_all_agree_with_the_whole_table(
    gtmab: Known,
    clean: FlightLinearizer,
    columns: NDArray[np.float64],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(flight_linearizer, 'CHUNK', 2)  # the chunks are smaller than the flight
    point = unchanged_vehicle_point(gtmab[0], gtmab[1], clean.replay.cut)
    table, left = clean.compute_whitened_columns(point, slice(1, 3))
    np.testing.assert_allclose(table, columns[1:3], rtol=1e-9, atol=1e-9)
    none = clean.linearize(point, np.zeros(len(gtmab[1]), dtype=bool))
    np.testing.assert_array_equal(none.residual[1:3], left)
    known = np.isfinite(none.residual)
    assert none.rows.tolist() == known.sum(axis=(1, 2)).tolist()
    full = np.concatenate([columns, none.residual[..., None]], axis=-1)
    full[~known] = 0.0
    full[..., RANDOM : RANDOM + len(gtmab[1])] = 0.0  # knobs that are not wanted have columns of 0
    flat = full.reshape(len(full), -1, full.shape[-1])
    np.testing.assert_allclose(
        none.grams, np.swapaxes(flat, 1, 2) @ flat, rtol=1e-8, atol=1e-6 * np.abs(flat).max()
    )
    assert none.names == (*(knob.name for knob in gtmab[1]), *SENSORS)


@pytest.mark.parametrize('pushed', [0.0, 0.002])
def test_all_forces_and_inertias_scaled_together_move_nothing(
    gtmab: Known, clean: FlightLinearizer, pushed: float
) -> None:
    nominal, knobs = gtmab
    begin = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    # Nor where something unexplained pushes: it would have to grow with them, and costs.
    begin.random[:, WIDTH : WIDTH + KNOTS] = pushed * np.cos(np.arange(KNOTS))  # N, surge
    columns = clean.compute_whitened_columns(begin)[0]
    heaviness = (nominal.mass - nominal.displaced) * STANDARD_GRAVITY
    scaled = dict.fromkeys(
        (
            'thrust_scale.factor', 'strip_damping.all', 'oblique_lift.all', 'vehicle.mass',
            'vehicle.roll', 'vehicle.pitch', 'vehicle.yaw',
        ),
        1.0,
    )  # fmt: skip
    scaled['net_lift.force'] = -heaviness
    for effect in ('added_mass', 'added_inertia', 'quadratic_drag', 'rotational_drag'):
        for parameter, value in nominal.effect_parameters[effect].items():
            scaled[f'{effect}.{parameter}'] = value
    names = [knob.name for knob in knobs]
    total = sum(value * columns[..., RANDOM + names.index(name)] for name, value in scaled.items())
    known = np.isfinite(total)
    thrust = columns[..., RANDOM + names.index('thrust_scale.factor')]
    assert np.linalg.norm(total[known]) < 2e-4 * np.linalg.norm(thrust[known])


def test_what_is_not_wanted_costs_nothing_and_changes_nothing(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    nominal, knobs = gtmab
    point = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    wanted = np.array([knob.tolerance > 0.0 for knob in knobs])
    whole, some = clean.linearize(point), clean.linearize(point, wanted)
    kept = np.r_[
        0:RANDOM, RANDOM + np.flatnonzero(wanted), RANDOM + len(knobs) : whole.grams.shape[1]
    ]
    np.testing.assert_allclose(
        some.grams[:, kept[:, None], kept], whole.grams[:, kept[:, None], kept], rtol=1e-9
    )
    assert not some.grams[:, RANDOM + np.flatnonzero(~wanted)].any()
    np.testing.assert_array_equal(some.residual, whole.residual)


def test_a_piece_that_ends_after_the_flight_repeats_its_last_point() -> None:
    """The last of 100 points has the index 99; the times of the piece go on beyond it."""
    flight = SimpleNamespace(time=0.3 + 0.04 * np.arange(100), has_only_pose=False)
    cut = SimpleNamespace(first=np.array([3, 97]), length=5, knots=2)
    found = FlightLinearizer(SimpleNamespace(flight=flight, cut=cut, span=5 * STEPS), [], None)
    assert found.index.tolist() == [[3, 4, 5, 6, 7], [97, 98, 99, 99, 99]]
    np.testing.assert_allclose(found.time, 0.3 + 0.04 * np.add.outer([3, 97], np.arange(5)))


@pytest.fixture(scope='module')
def alone(clean: FlightLinearizer) -> FlightLinearizer:
    """The clean flight as a tracker alone has it."""
    noise = np.where(np.arange(14) < 6, clean.replay.flight.noise, np.inf)
    blind = replace(clean.replay.flight, noise=noise)
    replay = FlightReplay(blind, clean.replay.cut, load_vehicle('gtmab').pack_command(()))
    return FlightLinearizer(replay, clean.knobs, clean.places)


@pytest.mark.parametrize(
    ('name', 'value'), [('tracker_delay.delay', 0.12), ('clock_offset.offset', -0.12)]
)
def test_to_a_pose_alone_a_late_pose_is_a_late_command(
    gtmab: Known, alone: FlightLinearizer, name: str, value: float
) -> None:
    """x(t - d), driven by u(t), is y(t), driven by u(t - d): exactly, however large d is."""
    nominal, knobs = gtmab
    order = [knob.name for knob in knobs]
    by_command = knobs[order.index('command_delay.delay')].apply_to(nominal, 0.12)
    by_clock = knobs[order.index(name)].apply_to(nominal, value)
    random = np.zeros((len(alone.replay.first), RANDOM))
    expected = _left(alone, by_command, random)
    np.testing.assert_allclose(_left(alone, by_clock, random), expected, rtol=1e-9, atol=1e-9)
    assert not np.allclose(_left(alone, nominal, random), expected, atol=0.1, equal_nan=True)
    told = alone.compute_whitened_columns(
        unchanged_vehicle_point(nominal, knobs, alone.replay.cut)
    )[0]
    one, other = (told[..., RANDOM + order.index(each)] for each in ('command_delay.delay', name))
    assert _differ(one, np.sign(value) * other) < 0.01


def test_where_an_inertial_unit_has_the_other_clock_a_late_pose_is_no_late_command(
    gtmab: Known, columns: NDArray[np.float64]
) -> None:
    """A command that is late shows in the rates, and a pose that is late does not."""
    order = [knob.name for knob in gtmab[1]]
    late = columns[:, :, 6:12, RANDOM + order.index('tracker_delay.delay')]
    assert not late[np.isfinite(late)].any()
    obeyed = columns[:, :, 6:12, RANDOM + order.index('command_delay.delay')]
    assert np.abs(obeyed[np.isfinite(obeyed)]).max() > 1.0  # deviations in a second


def test_the_clocks_of_a_pose_alone_add_up_to_a_delay_of_the_commands(
    gtmab: Known, alone: FlightLinearizer, clean: FlightLinearizer
) -> None:
    """10 ms late, seen 50 ms late by a clock 20 ms behind, which gains 10 ms in 100 s."""
    nominal = gtmab[0]
    for effect, parameter, value in (
        ('command_delay', 'delay', 0.01), ('tracker_delay', 'delay', 0.05),
        ('clock_offset', 'offset', 0.02), ('clock_skew', 'skew', 1e-4),
    ):  # fmt: skip
        nominal = nominal.with_value(effect, parameter, value)
    acting = alone.replay.build_replay_rows(nominal).acting
    late = -apply_channel_effects(
        acting['command_time'], np.zeros((2, 1)), np.array([0.0, 100.0])
    )[:, 0]
    np.testing.assert_allclose(late, [0.04, 0.03], atol=1e-12)
    assert acting['clock'] == acting['pose_time'] == ()
    apart = clean.replay.build_replay_rows(nominal).acting
    assert (
        -apply_channel_effects(apart['command_time'], np.zeros((1, 1)), np.zeros(1))[0, 0] == 0.01
    )
    assert len(apart['clock']) == 2
    assert len(apart['pose_time']) == 1


def test_a_pose_alone_has_the_columns_of_the_pose(
    gtmab: Known, alone: FlightLinearizer, columns: NDArray[np.float64]
) -> None:
    point = unchanged_vehicle_point(gtmab[0], gtmab[1], alone.replay.cut)
    told, left = alone.compute_whitened_columns(point)
    names = [knob.name for knob in gtmab[1]]
    others = [RANDOM + k for k, name in enumerate(names) if name.startswith(('tracker', 'clock'))]
    same = np.delete(np.arange(told.shape[-1]), others)
    np.testing.assert_array_equal(told[:, :, :6, same], columns[:, :, :6, same])
    assert not told[:, :, 6:].any()
    known = np.isfinite(left)
    flat = np.where(known[..., None], told, 0.0).reshape(len(told), -1, told.shape[-1])
    np.testing.assert_allclose(
        alone.linearize(point).grams[:, :-1, :-1],
        np.swapaxes(flat, 1, 2) @ flat,
        rtol=1e-9,
        atol=1e-12,
    )


@pytest.mark.parametrize('tilt', [0.0, 0.03])
@pytest.mark.parametrize(
    'name', ['tracker_misalignment.roll', 'tracker_misalignment.pitch', 'vehicle.mass']
)
def test_where_the_tracker_is_tilted_so_is_what_begins_a_piece(
    gtmab: Known, alone: FlightLinearizer, name: str, tilt: float
) -> None:
    """The state that a tilted tracker told is turned back before it is flown from."""
    knobs = gtmab[1]
    nominal = gtmab[0].with_value('tracker_misalignment', 'pitch', tilt)
    k = [knob.name for knob in knobs].index(name)
    still = np.zeros((len(alone.replay.first), RANDOM))
    column = alone.compute_whitened_columns(
        unchanged_vehicle_point(nominal, knobs, alone.replay.cut)
    )[0][..., RANDOM + k]
    before, after = (_left(alone, knobs[k].apply_to(nominal, by), still) for by in (-1e-4, 1e-4))
    assert _differ((before - after) / 2e-4, column) < 0.03  # most of it cancels


def test_a_turn_about_the_vertical_moves_nothing(
    gtmab: Known, alone: FlightLinearizer, columns: NDArray[np.float64]
) -> None:
    """Without wind nothing says where north is, whatever sensors there are."""
    names = [knob.name for knob in gtmab[1]]
    yaw, roll = (RANDOM + names.index(f'tracker_misalignment.{one}') for one in ('yaw', 'roll'))
    pose_only = alone.compute_whitened_columns(
        unchanged_vehicle_point(gtmab[0], gtmab[1], alone.replay.cut)
    )[0]
    for told in (pose_only, columns[:, :, :6]):
        assert np.nanmax(np.abs(told[..., yaw])) < 1e-6 * np.nanmax(np.abs(told[..., roll]))


def test_a_tilt_of_the_tracker_leaves_the_first_pose_as_it_was_told(
    gtmab: Known, alone: FlightLinearizer
) -> None:
    """A forecast begins where the tracker says, in whatever frame it says so."""
    first = []
    for tilt in (0.0, 0.05):
        nominal = gtmab[0].with_value('tracker_misalignment', 'roll', tilt)
        point = unchanged_vehicle_point(nominal, gtmab[1], alone.replay.cut)
        left = alone.compute_residual(
            alone.simulate_forecast(point)[:, ::STEPS], point, nominal.build_replay_rows()
        )
        first.append(left[:, 0, :6])
    np.testing.assert_allclose(first[1], first[0], atol=1e-9)


def test_a_turned_row_is_that_of_the_vehicle_built_anew(gtmab: Known) -> None:
    nominal, knobs = gtmab
    base = nominal.build_replay_rows()
    for knob in knobs:
        turned = knob.apply_to(nominal, knob.step_at(0.0))
        quick, slow = turned.update_replay_rows(nominal, base), turned.build_replay_rows()
        for name in ('actuators', 'actuators_on', 'body', 'body_on'):
            np.testing.assert_array_equal(getattr(quick, name), getattr(slow, name))
        assert quick.acting == slow.acting

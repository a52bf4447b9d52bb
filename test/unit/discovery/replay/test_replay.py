# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The replay in pieces is the simulator's own model; markers and tangents by hand."""

from dataclasses import replace

from lta_discovery.flights.measured_flight import resample_flight, Stream
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.replay import FlightReplay, STEPS_PER_PERIOD
from lta_discovery.replay.sensing import marker_frame, transform_to_map
from lta_discovery.replay.state_changes import (
    apply_state_changes,
    integrate_dynamics,
    STATE_WIDTH,
)
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_model.effects import initial_memory
from lta_model.vehicle import load_vehicle
from lta_sim.kernels import kernel
import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from ..hidden_flight import flown  # noqa: TID252 - `test` is Python's own

RIGID = 13
FIRST, PERIODS = np.array([25]), 100  # a piece of 4 s, after the motors have settled


def test_a_lagged_rotor_has_the_mean_thrust_of_its_closed_form(
    gtmab: tuple[NominalVehicle, object], clean: FlightSystem
) -> None:
    # Duty 0.5 from 3 ms after a bin began: m = 0.5 (1 - exp(-t / 72 ms)), T = a m^2 + b m.
    flight, vehicle = clean.flight, load_vehicle('gtmab')
    begin = float(flight.time[0])
    order = Stream(np.array([begin, begin + 0.043]), np.array([[0.0] * 4, [0.5] * 4]))
    told = replace(flight, commands=order, voltage=np.full(len(flight.time), np.nan))
    rows = gtmab[0].build_replay_rows()
    replay = FlightReplay(told, np.arange(1), 1, vehicle.pack_command(()))
    thrusts = replay.mean_thrusts(rows)
    a, b = vehicle.thrust_curve
    for k in (2, 3, 10):
        time = np.linspace(0.02 * k, 0.02 * (k + 1), 20001) - 0.043
        duty = np.where(time > 0.0, 0.5 * (1.0 - np.exp(-np.maximum(time, 0.0) / 0.072)), 0.0)
        expected = np.trapezoid(a * duty**2 + b * duty, dx=1e-6) / 0.02
        assert thrusts[k, 0] == pytest.approx(expected, rel=1e-4)
    assert (thrusts[:2] == 0.0).all()
    assert (thrusts[:, 4:] == 0.0).all()


def test_pieces_fly_as_the_kernel_flies(gtmab: tuple[NominalVehicle, object]) -> None:
    # The same commands through lta_sim.kernels.kernel at 2.5 ms, from one instant on.
    streams = flown({}, 4, 12.0)
    flight = resample_flight(streams)
    model, orders = gtmab[0].build_model(), streams.commands.values
    state = np.concatenate([np.zeros(RIGID), initial_memory()])
    state[6], state[2] = 1.0, 1.5
    states = [state[:RIGID]]
    for order in orders[:800]:
        state = kernel.advance(state, model, order, (0.0,), 0.0025, 4)
        states.append(state[:RIGID])
    unknown = replace(flight, voltage=np.full(len(flight.time), np.nan))
    replay = FlightReplay(unknown, FIRST, PERIODS, load_vehicle('gtmab').pack_command(()))
    rows = gtmab[0].build_replay_rows()
    at = np.rint(flight.time[FIRST] / 0.01).astype(int)
    assert at[0] + 400 <= 800
    start = np.array([states[k] if k < len(states) else states[0] for k in at])
    flown_on = replay.integrate_pieces(
        rows, replay.compute_body_inputs(rows), start, np.zeros((len(at), replay.span, 6))
    )
    truth = np.array(states[at[0] : at[0] + 401 : 4])
    error = flown_on[0, ::STEPS_PER_PERIOD] - truth
    assert np.abs(error[:, :3]).max() < 1e-4  # m
    assert np.abs(error[:, 3:7]).max() < 1e-4
    assert np.abs(error[:, 7:]).max() < 1e-3  # m/s, rad/s


def test_a_commanded_wrench_moves_the_body_as_the_same_latent_one(
    gtmab: tuple[NominalVehicle, object], clean: FlightSystem
) -> None:
    # A vehicle that is commanded by forces has no duties
    off = Stream(clean.flight.time[:1], np.zeros((1, 4)))
    flight, rows = replace(clean.flight, commands=off), gtmab[0].build_replay_rows()
    still = load_vehicle('gtmab').pack_command(())
    push = np.array([0.01, -0.004, 0.02, 1e-3, -2e-3, 5e-4])
    order = Stream(flight.time[:1], push[None])
    at = int(FIRST[0])
    state = np.concatenate([flight.position[at], flight.quaternion[at], np.zeros(6)])
    told = FlightReplay(replace(flight, wrench=order), FIRST, PERIODS, still)
    replay = FlightReplay(flight, FIRST, PERIODS, still)
    none = np.zeros((1, replay.span, 6))
    commanded = told.integrate_pieces(rows, told.compute_body_inputs(rows), state[None], none)
    ready = replay.compute_body_inputs(rows)
    latent = replay.integrate_pieces(rows, ready, state[None], none + push)
    np.testing.assert_allclose(commanded, latent, atol=1e-9)
    alone = replay.integrate_pieces(rows, ready, state[None], none)
    assert np.abs(latent - alone).max() > 0.1


def test_a_turned_row_is_that_of_the_vehicle_built_anew(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    nominal, knobs = gtmab
    base = nominal.build_replay_rows()
    for knob in knobs:
        turned = knob.apply_to(nominal, knob.step_at(0.0))
        quick, slow = turned.update_replay_rows(nominal, base), turned.build_replay_rows()
        for name in ('actuators', 'actuators_on', 'body', 'body_on'):
            np.testing.assert_array_equal(getattr(quick, name), getattr(slow, name))
        assert quick.acting == slow.acting


Known = tuple[NominalVehicle, list[FreeParameter]]
ARM, TURN = np.array([0.05, -0.02, 0.1]), (0.3, -0.2, 0.1)  # m; yaw, pitch, roll in rad


def marked(nominal: NominalVehicle, share: float = 1.0) -> NominalVehicle:
    """Return a vehicle whose markers sit askew."""
    for name, value in zip(('x', 'y', 'z', 'yaw', 'pitch', 'roll'), [*ARM, *TURN], strict=True):
        nominal = nominal.with_value('marker_offset', name, share * float(value))
    return nominal


def test_states_of_markers_become_those_of_the_body(gtmab: Known) -> None:
    """Against rigid-body kinematics with SciPy's rotations."""
    acting = marked(gtmab[0]).build_replay_rows().acting
    frame = marker_frame(acting)
    assert frame is not None
    np.testing.assert_allclose(frame[0], ARM)
    body, own = Rotation.from_euler('ZYX', (0.7, 0.2, -0.1)), Rotation.from_euler('ZYX', TURN)
    place, velocity, rates = np.array([[1.0, 2.0, 3.0], [0.3, -0.1, 0.2], [0.1, -0.2, 0.4]])
    there = np.concatenate([
        place + body.apply(ARM),
        (body * own).as_quat(),
        own.apply(velocity + np.cross(rates, ARM), inverse=True),
        own.apply(rates, inverse=True),
    ])  # fmt: skip
    found = transform_to_map(there[None], acting)[0]
    np.testing.assert_allclose(found[:3], place, atol=1e-12)
    np.testing.assert_allclose(np.abs(found[3:7] @ body.as_quat()), 1.0, atol=1e-12)
    np.testing.assert_allclose(found[7:10], velocity, atol=1e-12)
    np.testing.assert_allclose(found[10:], rates, atol=1e-12)


RNG = np.random.default_rng(6)
STEP = 0.04


def test_a_step_is_the_exponential_to_fourth_order() -> None:
    """It is exact for a matrix whose fourth power is 0, since all further terms vanish."""
    chain = np.zeros((STATE_WIDTH, STATE_WIDTH))
    for row, column, value in ((0, 1, 30.0), (1, 2, -20.0), (2, 3, 50.0), (5, 7, 10.0)):
        chain[row, column] = value
    whole = np.zeros((2 * STATE_WIDTH, 2 * STATE_WIDTH))
    whole[:STATE_WIDTH, :STATE_WIDTH], whole[:STATE_WIDTH, STATE_WIDTH:] = (
        chain,
        np.eye(STATE_WIDTH),
    )
    exact = expm(STEP * whole)
    b = integrate_dynamics(chain, STEP)
    np.testing.assert_allclose(b, exact[:STATE_WIDTH, STATE_WIDTH:], rtol=1e-12, atol=1e-14)


def test_the_series_ends_with_its_fourth_order() -> None:
    """If F h = 1, B is h (1 + 1/2 + 1/6 + 1/24)."""
    b = integrate_dynamics(np.eye(STATE_WIDTH) / STEP, STEP)
    np.testing.assert_allclose(b, STEP * (1.0 + 17.0 / 24.0) * np.eye(STATE_WIDTH))


def test_a_change_adds_to_place_and_speeds_and_rotates_in_the_body_frame() -> None:
    state, change = RNG.normal(size=(2, 13)), RNG.normal(size=(2, 12))
    state[:, 3:7] /= np.linalg.norm(state[:, 3:7], axis=1, keepdims=True)
    after = apply_state_changes(state, change)
    np.testing.assert_allclose(after[:, :3], state[:, :3] + change[:, :3])
    np.testing.assert_allclose(after[:, 7:], state[:, 7:] + change[:, 6:])
    turn = Rotation.from_quat(state[:, 3:7]) * Rotation.from_rotvec(change[:, 3:6])
    np.testing.assert_allclose(
        Rotation.from_quat(after[:, 3:7]).as_matrix(), turn.as_matrix(), atol=1e-12
    )

"""The replay in pieces is the simulator's own model."""

from dataclasses import replace

from lta_discovery.flights.measured_flight import resample_flight, Stream
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.replay import FlightReplay, STEPS
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_model.effects import initial_memory
from lta_model.vehicle import load_vehicle
from lta_sim.kernels import kernel
import numpy as np
import pytest

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
    error = flown_on[0, ::STEPS] - truth
    assert np.abs(error[:, :3]).max() < 1e-4  # m
    assert np.abs(error[:, 3:7]).max() < 1e-4
    assert np.abs(error[:, 7:]).max() < 1e-3  # m/s, rad/s


def test_a_commanded_wrench_moves_the_body_as_the_same_latent_one(
    gtmab: tuple[NominalVehicle, object], clean: FlightSystem
) -> None:
    flight, rows = clean.flight, gtmab[0].build_replay_rows()
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

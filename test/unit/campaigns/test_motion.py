# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The independent simulator moves as hand calculations say."""

from dataclasses import replace
import math

from campaigns.challenge.body import KirchhoffBody, STILL
from campaigns.challenge.flight import FlightSimulator, SimulatedTrajectory, TICK
from campaigns.challenge.rotors import RotorSet
from campaigns.challenge.truth import build_vehicle_truth, NONE, spheroid_added_mass, VehicleTruth
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

# The vehicle file's own numbers, as its page prints them.
MASS, DEPTH, EDGE, BROAD, TUMBLING = 0.41528, 0.10426, 0.13397, 0.34347, 0.0047593
PITCH = 0.0352057  # kg m2 about the centre of gravity, with the gas that turns along
G = 9.80665


@pytest.fixture(scope='module')
def truth() -> VehicleTruth:
    """Return the vehicle as its file has it, with as much air displaced as it weighs."""
    made = build_vehicle_truth(load_vehicle('gtmab'))
    return replace(made, displaced=made.mass)


def smooth(truth: VehicleTruth) -> VehicleTruth:
    """Return it without any drag, and without the lift that goes with drag."""
    return replace(truth, normal=0.0, drag=NONE, turn_linear=NONE, turn_square=NONE, plates=())


class Hands:
    """Commands one after the other, whatever the flight."""

    def __init__(self, duties: list[list[float]]) -> None:
        self._duties, self._taken = duties, 0

    def initial_duties(self) -> list[float]:
        """Return the duties before the start."""
        return self._duties[0]

    def compute_duties(self, time: float, state: list[float]) -> list[float]:
        """Return the next."""
        self._taken += 1
        return self._duties[min(self._taken, len(self._duties)) - 1]


def flown(truth: VehicleTruth, state: list[float], seconds: float) -> SimulatedTrajectory:
    """Fly with rotors at rest."""
    return FlightSimulator(truth, Hands([[0.0] * 4])).simulate_flight(state, seconds)


def at(*, velocity: tuple[float, ...] = NONE, rates: tuple[float, ...] = NONE) -> list[float]:
    """Return an upright state."""
    return [0.0, 0.0, 2.0, *velocity, 1.0, 0.0, 0.0, 0.0, *rates]


def test_added_mass_of_a_spheroid_is_lambs() -> None:
    # Imlay 1961 gives a sphere half the fluid it displaces, and no inertia of rotation.
    (edge, _, broad), (tumbling, _, yaw) = spheroid_added_mass(1.0, 0.999999, 1.2)
    half = 0.5 * 1.2 * math.pi / 6.0
    assert (edge, broad) == pytest.approx((half, half), rel=1e-3)
    assert (tumbling, yaw) == (pytest.approx(0.0, abs=1e-9), 0.0)
    # A thin disc broadside: 8/3 rho r^3; about a diameter: 16/45 rho r^5 (Lamb, section 108).
    (_, _, broad), (tumbling, _, _) = spheroid_added_mass(1.0, 1e-4, 1.2)
    assert broad == pytest.approx(8.0 / 3.0 * 1.2 * 0.125, rel=1e-3)
    assert tumbling == pytest.approx(16.0 / 45.0 * 1.2 * 0.5**5, rel=1e-3)
    assert spheroid_added_mass(1.0, 0.599, 1.2041)[0][::2] == pytest.approx((EDGE, BROAD), 1e-4)


def test_a_push_at_rest_moves_the_hull_by_its_mass_and_that_of_the_air(
    truth: VehicleTruth,
) -> None:
    body = KirchhoffBody(truth)
    up = body.rigid_body_accelerations(at(), STILL, (0.0, 0.0, 0.01, 0.0, 0.0, 0.0), 0.0)
    assert up == pytest.approx((0.0, 0.0, 0.01 / (MASS + BROAD), 0.0, 0.0, 0.0), rel=1e-4)
    # Ahead, the weight below stays behind: (m + A) a - m d w' = F and I' w' = m d a.
    ahead = body.rigid_body_accelerations(at(), STILL, (0.01, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0)
    about = PITCH + TUMBLING + MASS * DEPTH**2
    hull = 0.01 / (MASS + EDGE - (MASS * DEPTH) ** 2 / about)
    assert ahead[0] == pytest.approx(hull, rel=1e-4)
    assert ahead[4] == pytest.approx(MASS * DEPTH * hull / about, rel=1e-4)


def test_it_swings_with_the_period_of_a_free_pendulum(truth: VehicleTruth) -> None:
    # The hull is free to give way: I + J + m d^2 - (m d)^2 / (m + A) against m g d.
    inertia = PITCH + TUMBLING + MASS * DEPTH**2 - (MASS * DEPTH) ** 2 / (MASS + EDGE)
    period = 2.0 * math.pi * math.sqrt(inertia / (MASS * G * DEPTH))
    assert 1.9 < period < 2.0
    path = flown(smooth(truth), at(rates=(0.0, 0.02, 0.0)), 11.0)
    rate = path.states[:, 11]
    after = np.flatnonzero((rate[:-1] < 0.0) & (rate[1:] >= 0.0))
    crossings = path.time[after] + TICK * rate[after] / (rate[after] - rate[after + 1])
    assert len(crossings) == 5
    assert np.diff(crossings) == pytest.approx(np.full(4, period), rel=1e-4)


def test_it_sinks_as_fast_as_its_drag_allows(truth: VehicleTruth) -> None:
    heavy = replace(truth, displaced=truth.mass - 0.002)
    path = flown(heavy, at(velocity=(0.0, 0.0, -0.22)), 40.0)
    assert path.states[-1, 5] == pytest.approx(-math.sqrt(0.002 * G / 0.359), rel=1e-4)
    # What is hidden of the drag has exponent 1.9, and is that of a square at 0.4 m/s.
    more = KirchhoffBody(replace(truth, extra_drag=(0.0, 0.0, 0.1)))
    for speed in (0.4, 0.1):
        drag = more.drag_wrench((0.0, 0.0, speed), NONE)[2]
        assert drag == pytest.approx(-0.359 * speed**2 - 0.1 * 0.4**0.1 * speed**1.9, rel=1e-12)


def test_the_hidden_drag_of_a_round_hull_follows_its_level_speed(truth: VehicleTruth) -> None:
    bare = KirchhoffBody(truth).drag_wrench((0.3, 0.4, 0.0), NONE)
    more = KirchhoffBody(replace(truth, extra_drag=(0.0, 0.1, 0.0)))
    force = more.drag_wrench((0.3, 0.4, 0.0), NONE)
    assert force[1] - bare[1] == pytest.approx(-0.1 * 0.4**0.1 * 0.5**0.9 * 0.4, rel=1e-9)
    assert force[0] == bare[0]


def energy(truth: VehicleTruth, path: SimulatedTrajectory) -> np.ndarray:
    """Return the energy of body, air and weight. [J]."""
    masses = KirchhoffBody(truth).masses
    turn = Rotation.from_quat(np.roll(path.states[:, 6:10], -1, axis=1))
    through = turn.apply(path.states[:, 3:6], inverse=True)
    motion = np.hstack([through, path.states[:, 10:13]])
    height = turn.apply(truth.cg)[:, 2]  # buoyancy carries the rest
    energies = 0.5 * np.sum(motion @ masses * motion, axis=1) + truth.mass * G * height
    return np.asarray(energies)


@pytest.mark.parametrize('lost', [0.0, 0.7])
def test_energy_stays_without_drag_and_thrust(truth: VehicleTruth, lost: float) -> None:
    bare = replace(smooth(truth), munk=1.0 - lost, cg=(0.01, -0.02, truth.cg[2]))
    path = flown(bare, at(velocity=(0.4, 0.2, -0.1), rates=(0.3, -0.5, 0.4)), 12.0)
    drift = np.ptp(energy(bare, path))
    # Of some 0.1 J in motion. The Munk moment alone would take or give it.
    assert drift > 1e-3 if lost else drift < 1e-8


def test_oblique_flow_turns_the_hull_broadside(truth: VehicleTruth) -> None:
    state = at(velocity=(0.5, 0.0, -0.2))
    whole, without = (KirchhoffBody(replace(smooth(truth), munk=m)) for m in (1.0, 0.0))
    more = np.subtract(
        whole.rigid_body_accelerations(state, STILL, STILL, 0.0),
        without.rigid_body_accelerations(state, STILL, STILL, 0.0),
    )
    munk = whole.masses @ more
    # Munk 1924: the difference of the added masses times both speeds, nose up here.
    assert munk == pytest.approx([0, 0, 0, 0, -(BROAD - EDGE) * 0.5 * 0.2, 0], abs=1e-6)


def test_wind_is_felt_as_motion_through_still_air(truth: VehicleTruth) -> None:
    body, wind = KirchhoffBody(truth), (0.2, -0.1, 0.0)
    blown = body.rigid_body_accelerations(at(rates=(0.1, 0.2, 0.3)), (*wind, *NONE), STILL, 0.0)
    away = at(velocity=(-0.2, 0.1, 0.0), rates=(0.1, 0.2, 0.3))
    assert blown == pytest.approx(
        body.rigid_body_accelerations(away, STILL, STILL, 0.0), abs=1e-12
    )
    rising = body.rigid_body_accelerations(at(), (*NONE, 0.0, 0.0, 0.1), STILL, 0.0)
    assert rising[2] == pytest.approx(0.1, rel=1e-9)  # neutral: it goes with the air


def test_steps_are_short_enough(truth: VehicleTruth, monkeypatch: pytest.MonkeyPatch) -> None:
    # At rest until the first command, so that both begin alike.
    wanted = np.vstack([np.zeros(4), np.random.default_rng(1).uniform(0.0, 0.6, (11, 4))])
    duties = wanted.repeat(25, axis=0).tolist()
    coarse = FlightSimulator(truth, Hands(duties)).simulate_flight(at(), 3.0).states[-1]
    monkeypatch.setattr('campaigns.challenge.flight.TICK', TICK / 4.0)
    hands = Hands([duty for duty in duties for _ in range(4)])
    fine = FlightSimulator(truth, hands).simulate_flight(at(), 3.0 - 0.75 * TICK).states[-1]
    assert coarse == pytest.approx(fine, abs=1e-6)


def test_rotors_lag_and_stand_still_in_the_deadband(truth: VehicleTruth) -> None:
    rotors = RotorSet(truth, [0.0] * 4)
    rotors.set_duties([0.5, 0.0, 0.0, 0.0])
    u = 0.5 * (1.0 - math.exp(-1.0))
    assert rotors.thrusts_after_command(0.072)[0] == pytest.approx(
        0.0915 * u * u + 0.0677 * u, rel=1e-9
    )
    dead = RotorSet(replace(truth, deadband=0.1), [0.0] * 4)
    for duty, works in ((0.101, False), (0.103, True), (0.099, True), (0.097, False)):
        dead.set_duties([duty] * 4)
        assert (dead.thrusts_after_command(2.0)[0] > 0.0) == works
    # Both stages of a hidden lag delay by their sum: the area above the rise.
    slow, time = RotorSet(replace(truth, slow_lag=0.1, curve=(0.0, 1.0)), [0.0] * 4), 0.002
    slow.set_duties([1.0] * 4)
    rise = [slow.thrusts_after_command(time * (k + 0.5))[0] for k in range(1500)]
    assert time * sum(1.0 - u for u in rise) == pytest.approx(0.172, rel=1e-3)


def test_a_delay_shifts_the_thrust_and_nothing_else(truth: VehicleTruth) -> None:
    duties = np.random.default_rng(3).uniform(0.0, 0.5, (100, 4)).tolist()
    now = FlightSimulator(truth, Hands(duties)).simulate_flight(at(), 1.0)
    late = FlightSimulator(replace(truth, delay=0.034), Hands(duties)).simulate_flight(at(), 1.0)
    assert late.time - now.time == pytest.approx(np.full(len(now.time), 0.004))
    assert late.thrusts[4:] == pytest.approx(now.thrusts[1:-3], rel=1e-12)

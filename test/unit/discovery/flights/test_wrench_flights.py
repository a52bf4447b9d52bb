# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Vehicles that are told forces and moments, seen by a slow tracker alone, with gaps."""

from dataclasses import replace
from typing import Final

from lta_discovery.flights.measured_flight import (
    FlightStreams,
    GRID_PERIOD,
    resample_flight,
    Stream,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.replay.replay import FlightReplay
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.parameter_fit import fit_likelihood
from lta_model.effects.protocol import AXES
from lta_model.vehicle import load_vehicle, Vehicle
import numpy as np
from numpy.typing import NDArray
import pytest

from ..hidden_flight import flown  # noqa: TID252 - `test` is Python's own

Array = NDArray[np.float64]
RATE: Final = 30.0  # Hz
ARRIVES: Final = 0.8  # of the force that is commanded ahead
GAPS: Final = ((7.0, 7.3), (15.0, 16.5))  # s


def seen(told: FlightStreams, rng: np.random.Generator) -> Stream:
    """Return the poses of a slow tracker whose clock jitters, with gaps."""
    time = np.arange(told.pose.time[0] + 0.1, told.pose.time[-1] - 0.1, 1.0 / RATE)
    time = np.sort(time + rng.uniform(-2e-3, 2e-3, len(time)))
    time = time[~np.any([(time > a) & (time < b) for a, b in GAPS], axis=0)]
    table = np.column_stack([np.interp(time, told.pose.time, each) for each in told.pose.values.T])
    table[:, 3:] /= np.linalg.norm(table[:, 3:], axis=1, keepdims=True)
    return Stream(time, table)


def commanded(vehicle: Vehicle, told: FlightStreams) -> Stream:
    """Return the wrench that the rotors gave, lag and all, too much of it ahead."""
    nominal, flight = NominalVehicle.from_vehicle(vehicle), resample_flight(told)
    replay = FlightReplay(flight, np.arange(1), 1, vehicle.pack_command(()))
    thrusts = replay.mean_thrusts(nominal.build_replay_rows())
    out = np.zeros((len(thrusts), 6))
    for i, thrust in enumerate(thrusts.T[: len(nominal.rotors)], 1):
        given = [nominal.parameter_value('rotor_thrust', f'{axis}_{i}') for axis in AXES]
        out += thrust[:, None] * np.array(given)
    out[:, 0] /= ARRIVES
    return Stream(flight.time[0] + replay.dt * np.arange(len(out)), out)


@pytest.fixture(scope='module')
def driven() -> FlightSystem:
    """A GT-MAB that was told wrenches."""
    told, vehicle = flown({}, 5, 32.0), load_vehicle('gtmab')
    wrench = commanded(vehicle, told)
    still = Stream(told.pose.time[:1], np.zeros((1, len(vehicle.rotor_names))))
    only = FlightStreams(
        seen(told, np.random.default_rng(3)), still, floor=told.floor, wrench=wrench
    )
    known = list_free_parameters(NominalVehicle.from_vehicle(vehicle), wrench=True)
    tolerances = [one for one in known if one.tolerance > 0.0]
    return FlightSystem(vehicle, resample_flight(only), tolerances)


def test_what_arrives_of_a_commanded_wrench_is_found(driven: FlightSystem) -> None:
    """Four fifths ahead, all of it upwards, from poses at 30 Hz."""
    nominal = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
    noise = NoiseModel.guess(nominal, driven.flight)
    found = fit_likelihood([driven], nominal, np.zeros(len(driven.parameters)), [noise])
    names = [knob.name for knob in driven.parameters]
    for axis, gain in (('surge', ARRIVES), ('heave', 1.0)):
        k = names.index(f'wrench_gain.{axis}')
        spread = float(np.sqrt(found.covariance[k, k]))
        assert spread < 0.1  # 0.2 before
        assert abs(1.0 + found.values[k] - gain) < 3.0 * spread + 0.03


def test_a_short_gap_ends_no_piece(driven: FlightSystem) -> None:
    """0.3 s without poses is flown through, 1.5 s is not, and nothing is made up in either."""
    flight = driven.flight
    for begin, end in GAPS:
        inside = (flight.time > begin + 0.05) & (flight.time < end - 0.05)
        assert inside.any()
        assert not np.isfinite(flight.position[inside]).any()
        assert flight.usable[inside].all() == (end - begin < 0.5)


def test_poses_have_the_noise_of_their_tracker_or_the_least_one() -> None:
    time = np.arange(0.0, 20.0, 1.0 / 60.0)
    pose = np.column_stack([np.sin(0.3 * time), np.cos(0.3 * time), 1.0 + 0.01 * time])
    turn = np.column_stack([np.zeros((len(time), 3)), np.ones(len(time))])
    still = Stream(time[:1], np.zeros((1, 2)))
    smooth = resample_flight(FlightStreams(Stream(time, np.hstack([pose, turn])), still))
    assert smooth.noise[:3] == pytest.approx(5e-4)
    rng = np.random.default_rng(1)
    noisy = pose + 1e-3 * rng.standard_normal(pose.shape)
    raw = resample_flight(FlightStreams(Stream(time, np.hstack([noisy, turn])), still))
    assert raw.noise[:3] == pytest.approx(1e-3, rel=0.2)
    assert smooth.usable[0] == raw.usable[0] == False  # noqa: E712 (motors settle)
    assert smooth.usable[round(0.6 / GRID_PERIOD)]


def test_a_vehicle_is_weighed_with_its_moving_mass_where_it_is() -> None:
    """Moved 1 cm ahead, and back again; CG and inertia by hand."""
    nominal = NominalVehicle.from_vehicle(load_vehicle('rgblimp'))
    own = nominal.effect_parameters['moving_mass']
    rest = np.array([own[axis] for axis in 'xyz'])
    ahead = nominal.with_mass_at(rest + np.array([0.01, 0.0, 0.0]))
    assert ahead.cg[0] - nominal.cg[0] == pytest.approx(0.05407 * 0.01 / nominal.mass)
    hull = [
        each.inertia[2, 2] + each.mass * (each.cg[0] ** 2 + each.cg[1] ** 2)
        for each in (nominal, ahead)
    ]
    gained = 0.05407 * ((rest[0] + 0.01) ** 2 - rest[0] ** 2)
    assert hull[1] - hull[0] == pytest.approx(gained)
    back = ahead.with_mass_at(rest)
    assert back.inertia == pytest.approx(nominal.inertia, abs=1e-12)
    assert replace(back, effect_parameters=nominal.effect_parameters).cg == pytest.approx(
        nominal.cg
    )

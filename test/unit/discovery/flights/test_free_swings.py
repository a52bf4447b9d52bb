# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Swings without commands show when they begin, and about which tilt they swing."""

from lta_discovery.flights.free_swings import (
    align_swings,
    find_neutral_height,
    find_swing_law,
    measure_marker_arm,
    measure_tilt,
)
from lta_discovery.flights.measured_flight import FlightStreams, resample_flight, Stream
from lta_discovery.flights.transients import find_transients
from lta_discovery.model.nominal import NominalVehicle
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
RATE = 50.0  # Hz


def swinging(
    angle: Array,
    rest: tuple[float, float] = (0.0, 0.0),
    arm: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> FlightStreams:
    """
    Return a flight without commands that swings about y, with markers that are turned.

    `arm`: place of the markers from the point that does not move. [m]
    """
    time = np.arange(len(angle)) / RATE
    draw = np.random.default_rng(1)
    turn = Rotation.from_euler('z', 0.05 * time[:, None]) * Rotation.from_rotvec(
        np.column_stack([0.0 * angle, angle, 0.0 * angle])
    )
    markers = Rotation.from_rotvec([*rest, 0.0])
    shake = Rotation.from_rotvec(1e-3 * draw.standard_normal((len(time), 3)))
    place = [0.0, 0.0, 1.5] + 1e-3 * draw.standard_normal((len(time), 3))
    place = place + turn.apply(arm) + 0.02 * time[:, None] * [1.0, 0.0, -0.5]
    pose = np.column_stack([place, (turn * shake * markers).as_quat()])
    return FlightStreams(Stream(time, pose), Stream(time, np.zeros((len(time), 4))), floor=0.47)


def decay(seconds: float, amplitude: float = 0.5) -> Array:
    """Return a free decay with a period of 1.4 s [rad]."""
    time = np.arange(0.0, seconds, 1.0 / RATE)
    return amplitude * np.exp(-time / 6.0) * np.cos(2.0 * np.pi * time / 1.4)


@pytest.mark.parametrize('moved', [0.0, 0.1])
def test_a_swing_begins_when_the_hand_lets_go(moved: float) -> None:
    """A hand holds it at 0.6 rad for 2.6 s, or moves it slowly."""
    held = 0.6 + moved * np.sin(3.0 * np.arange(-2.6, 0.0, 1.0 / RATE))
    streams = swinging(np.concatenate([held, decay(17.0, 0.6)]))
    (cut,) = find_transients(resample_flight(streams), streams)
    assert (cut.from_s, cut.to_s) == (0.0, pytest.approx(2.6 + 0.2, abs=0.2))
    free = swinging(decay(17.0, 0.6))
    assert find_transients(resample_flight(free), free) == []


def test_swings_about_different_tilts_are_turned_to_the_same() -> None:
    """The markers of the second flight are turned by 0.15 rad about x, those of the third not."""
    flights = [
        (name, 'train', resample_flight(swinging(decay(15.0), rest)))
        for name, rest in (('a', (0.0, 0.0)), ('b', (0.15, 0.0)), ('c', (0.01, 0.0)))
    ]
    apart = [find_swing_law(flight).rest for _, _, flight in flights]
    np.testing.assert_allclose(apart[1] - apart[0], [0.0, 0.15], atol=0.01)
    turned, (words,) = align_swings(flights, load_vehicle('gtmab'))
    assert words.startswith('b: swings about a tilt')
    assert 'up to 8°' in words
    rests = [np.mean(measure_tilt(flight.quaternion)[-140:], axis=0) for _, _, flight in turned]
    np.testing.assert_allclose(rests[1], rests[2], atol=0.01)
    assert [one is other for (_, _, one), (_, _, other) in zip(flights, turned, strict=True)] == [
        True, False, True,
    ]  # fmt: skip


def test_swings_with_markers_elsewhere_are_moved_to_the_same_place() -> None:
    """The rigid body of the third flight was defined 20 cm higher, and 4 cm further ahead."""
    places = ((0.05, 0.0, -0.1), (0.05, 0.0, -0.11), (0.09, 0.0, 0.1))
    flights = [
        (name, 'train', resample_flight(swinging(decay(15.0), arm=place)))
        for name, place in zip('abc', places, strict=True)
    ]
    vehicle = load_vehicle('gtmab')
    nominal = NominalVehicle.from_vehicle(vehicle)
    height = find_neutral_height(nominal, 1.0)
    for (_, _, flight), place in zip(flights, places, strict=True):
        arm = measure_marker_arm(flight, nominal)
        assert arm is not None
        np.testing.assert_allclose(arm.place[[0, 2]], [place[0], place[2] + height], atol=0.01)
        assert arm.deviation[0] < 0.01 < arm.deviation[1]  # nothing turns about x
    moved, (words,) = align_swings(flights, vehicle)
    assert words.startswith('c: the origin of the marker frame is elsewhere')
    assert '20 cm' in words or '21 cm' in words
    after = measure_marker_arm(moved[2][2], nominal)
    assert after is not None
    np.testing.assert_allclose(after.place[[0, 2]], [0.05, -0.1 + height], atol=0.015)
    assert moved[0][2] is flights[0][2]


def test_the_point_that_does_not_move_is_between_hull_centre_and_centre_of_gravity() -> None:
    """By hand: the momentum m (v + w r) + A v of hull and added mass A is zero there."""
    vehicle = load_vehicle('gtmab')
    nominal = NominalVehicle.from_vehicle(vehicle)
    for in_pitch, added in ((1.0, vehicle.added_mass[0]), (0.0, vehicle.added_mass[1])):
        expected = nominal.mass * nominal.cg[2] / (nominal.mass + added)
        assert find_neutral_height(nominal, in_pitch) == pytest.approx(expected, rel=1e-6)

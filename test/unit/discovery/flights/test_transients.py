# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Take-off, hand releases and catches are cut, and nothing of a free flight."""

from dataclasses import replace

from lta_discovery.flights.measured_flight import FlightStreams, resample_flight, Stream
from lta_discovery.flights.transients import find_transients
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]
RATE = 50.0  # Hz


def flight(height: Array, *, idle_until: float = 0.0, ahead: Array | None = None) -> FlightStreams:
    """Return a flight over a floor at 0.4 m; commands begin at a time."""
    time = np.arange(len(height)) / RATE
    draw = np.random.default_rng(1)
    pose = np.column_stack([np.zeros((len(time), 6)), np.ones(len(time))])
    pose[:, 0] = 0.0 if ahead is None else ahead
    pose[:, 2] = height
    pose[:, :3] += 1e-3 * draw.standard_normal((len(time), 3))
    duties = np.where(time < idle_until, 0.0, 0.3 + 0.2 * np.sin(time))[:, None] * np.ones(4)
    return FlightStreams(Stream(time, pose), Stream(time, duties), floor=0.47)


def found(streams: FlightStreams) -> list[tuple[float, float]]:
    """Return begin and end of the transients [s]."""
    return [(one.from_s, one.to_s) for one in find_transients(resample_flight(streams), streams)]


def times(seconds: float) -> Array:
    """Return the times of a flight."""
    return np.arange(0.0, seconds, 1.0 / RATE)


def test_a_free_flight_has_no_transient() -> None:
    time = times(40.0)
    assert found(flight(1.5 + 0.3 * np.sin(0.5 * time), ahead=0.5 * time)) == []


def test_a_take_off_is_cut_until_a_second_after_the_floor() -> None:
    time = times(40.0)
    height = 0.92 - 0.5 * np.cos(0.25 * np.maximum(time - 5.0, 0.0))
    ((begin, end),) = found(flight(height, ahead=0.2 * np.maximum(time - 5.0, 0.0)))
    assert begin == 0.0
    left = time[np.flatnonzero(height > 0.47)[0]]
    assert end == pytest.approx(left + 1.0, abs=0.1)


def test_a_hold_before_the_first_command_is_cut() -> None:
    time = times(40.0)
    drift = 0.4 * np.maximum(time - 4.0, 0.0)
    ((_, end),) = found(flight(np.full_like(time, 1.5), idle_until=4.0, ahead=drift))
    assert end == pytest.approx(4.5, abs=0.2)


def test_a_jerk_at_either_end_is_a_hand() -> None:
    time = times(60.0)
    free = 1.5 + 0.2 * np.sin(0.5 * time)
    jerk = 0.1 * np.exp(-(((time - 3.0) / 0.25) ** 2)) + 0.1 * np.exp(
        -(((time - 57.0) / 0.25) ** 2)
    )
    (first, last) = found(flight(free + jerk))
    assert first[0] == 0.0
    assert 3.0 < first[1] < 4.5
    assert 55.5 < last[0] < 57.0
    assert last[1] == pytest.approx(60.0, abs=0.1)


def test_a_free_decay_is_no_hand() -> None:
    time = times(60.0)
    swing = 0.3 * np.exp(-time / 8.0) * np.cos(2.0 * np.pi * time / 2.5)
    assert found(flight(np.full_like(time, 1.5), ahead=swing)) == []


def carried_flight(carried: bool) -> FlightStreams:
    """Return two flights in one log; in between a hand carries the vehicle by 2 m and back."""
    time = times(60.0)
    free = 1.5 + 0.2 * np.sin(0.5 * time)
    away = np.zeros_like(time)
    for middle, way in ((28.0, 2.0), (32.0, -2.0)):
        away += way / (1.0 + np.exp(-(time - middle) / 0.15))
    return flight(free, ahead=away if carried else None)


def test_a_carry_inside_a_flight_is_cut() -> None:
    ((begin, end),) = found(carried_flight(True))
    assert begin == pytest.approx(27.0, abs=0.6)
    assert end == pytest.approx(33.0, abs=0.6)
    assert found(carried_flight(False)) == []


def test_a_catch_at_the_end_of_a_short_flight_is_cut() -> None:
    """It flies for 9 s, is caught, and the tracker repeats its last pose for 5 s."""
    time = times(14.0)
    ahead = 0.05 * np.minimum(time, 9.0) ** 2 - 1.2 * np.clip(time - 8.8, 0.0, 0.5)
    streams = flight(np.full_like(time, 1.5), ahead=ahead)
    streams.pose.values[time > 9.3] = streams.pose.values[time <= 9.3][-1]
    grid = resample_flight(streams)
    grid = replace(grid, usable=grid.usable & (grid.time < 9.3))
    (caught,) = find_transients(grid, streams)
    assert caught.from_s == pytest.approx(8.4, abs=0.4)
    assert caught.to_s == pytest.approx(14.0, abs=0.1)

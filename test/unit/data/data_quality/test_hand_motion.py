# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A hand is found in idle flights; free decays, drops and pushes are not."""

import itertools

from lta_data.data_quality.checks.hand_motion import find_idle_motion
from lta_data.data_quality.motion import VectorSeries
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]
TIME = np.arange(0.0, 12.0, 0.02)


def judged(place: Array, seed: int = 0) -> bool:
    """Return whether a hand is reported in a flight with idle rotors."""
    noise = 1e-3 * np.random.default_rng(seed).standard_normal(place.shape)
    series = VectorSeries('pose/position', TIME, place + noise)
    idle = np.ones(len(TIME), dtype=np.bool_)
    return bool(list(find_idle_motion(series, TIME, idle)))


def carried(seed: int) -> Array:
    """Return the way of a vehicle that a person carries from place to place, up and down."""
    draw = np.random.default_rng(seed)
    edges = np.cumsum(np.append(0.0, draw.uniform(0.8, 1.8, 20)))
    stops = np.cumsum(draw.uniform(-0.8, 0.8, (21, 3)) * (1.0, 1.0, 0.7), axis=0)
    part = [np.clip((TIME - a) / (b - a), 0.0, 1.0) for a, b in itertools.pairwise(edges)]
    # Minimum jerk from stop to stop
    return stops[0] + sum(
        (p**3 * (10.0 - 15.0 * p + 6.0 * p**2))[:, None] * (b - a)
        for p, (a, b) in zip(part, itertools.pairwise(stops), strict=True)
    )


def test_thirty_of_thirty_carried_flights_are_found() -> None:
    assert sum(judged(carried(seed), seed) for seed in range(30)) == 30


@pytest.mark.parametrize('angle', [0.1, 0.4, 0.8])
def test_a_decaying_swing_is_free(angle: float) -> None:
    length, turn = 1.0, angle * np.exp(-TIME / 6.0) * np.cos(np.sqrt(9.81) * TIME)
    place = np.column_stack([length * np.sin(turn), 0.05 * TIME, -length * np.cos(turn)])
    assert not judged(place)


@pytest.mark.parametrize('lift', [0.005, 0.02])
def test_a_swing_that_rises_and_circles_is_free(lift: float) -> None:
    """Too light by `lift` [N], with added mass 0.7 kg, and released with a push to one side."""
    pace = 2.0 * np.pi * 0.7 * TIME
    fading = 0.13 * np.exp(-TIME / 15.0)
    place = np.column_stack([
        fading * np.cos(pace), 0.4 * fading * np.sin(pace) + 0.02 * TIME,
        0.5 * fading * np.cos(pace + 0.4) + 0.5 * lift / 0.7 * TIME**2,
    ])  # fmt: skip
    assert not judged(place)


@pytest.mark.parametrize('speed', [0.5, 1.0, 2.0])
def test_a_drop_is_free(speed: float) -> None:
    """From rest to the final speed of quadratic drag."""
    fallen = np.log(np.cosh(TIME / speed)) * speed**2
    assert not judged(np.column_stack([0.0 * TIME, 0.0 * TIME, 30.0 - fallen]))


def test_a_swing_that_falls_is_free() -> None:
    """Markers 10 cm from the centre of a heavy blimp, which swings in roll and in pitch."""
    time, arm = TIME, 0.1
    roll, pitch = (
        0.35 * np.exp(-time / decay) * np.cos(rate * time)
        for rate, decay in ((4.4, 9.0), (3.9, 5.0))
    )
    fallen = 0.25 * np.log(np.cosh(time / 5.0)) * 5.0
    height = 9.0 - fallen + arm * (roll - pitch)
    assert not judged(np.column_stack([0.01 * time + arm * pitch, arm * roll, height]))


def test_a_push_is_free() -> None:
    ahead = np.log1p(np.maximum(TIME - 1.0, 0.0))
    assert not judged(np.column_stack([ahead, 0.0 * TIME, 1.5 - 0.02 * TIME]))


def test_a_swing_with_lost_markers_is_free() -> None:
    """A tracker that takes one marker for another jumps by 10 cm, for up to 0.4 s."""
    turn = 0.4 * np.exp(-TIME / 6.0) * np.cos(np.sqrt(9.81) * TIME)
    place = np.column_stack([np.sin(turn), 0.05 * TIME, -np.cos(turn)])
    for begin, length in ((100, 5), (240, 20), (360, 12), (480, 18)):
        place[begin : begin + length] += (0.1, -0.05, 0.12)
    assert not judged(place)

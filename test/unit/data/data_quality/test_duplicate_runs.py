# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Copies of a run are found, and repeated manoeuvres, which move alike, are not."""

from lta_data.data_quality.duplicate_runs import find_duplicate_runs
from lta_data.flight import Channel, Flight
import numpy as np
import pytest

POSE = 'ground_truth/odom/pose.pose'
NAMES = [f'{POSE}.position.{axis}' for axis in 'xyz']
NAMES += [f'{POSE}.orientation.{axis}' for axis in 'xyz']


def log_manoeuvre(rng, step=False, rate=100.0, noise=1e-4):
    """
    Return times and poses of a swing that decays, or of a swing that a step excites.

    It swings in a diagonal plane. Amplitude and period differ a little each time; `noise` is that
    of a tracker [m], and three times as much in half angles [rad].
    """
    t = np.arange(0.0, 14.0 if step else 25.0, 1.0 / rate)
    size, stretch = 1.0 + rng.normal(0.0, [0.05, 0.002])
    late = np.clip(t - 1.0, 0.0, None) if step else t
    swing = 0.15 * size * np.exp(-0.11 * late) * np.cos(2.0 * np.pi * 0.45 * stretch * late)
    swing = 0.15 * size - swing if step else swing
    gone = 0.4 * size * (late + np.expm1(-late / 4.0) * 4.0) if step else 0.02 * t
    place = [gone - 0.6 * swing, 0.6 * swing, 1.5 + 0.1 * swing + 0.003 * t]
    pose = np.stack([*place, swing, swing, 0.05 * swing], axis=1)
    return t, pose + rng.normal(0.0, noise * np.array([1, 1, 1, 3, 3, 3]), pose.shape)


def record(t, pose):
    return Flight({name: Channel(name, '', t, pose[:, k]) for k, name in enumerate(NAMES)})


@pytest.mark.parametrize('step', [False, True])
@pytest.mark.parametrize('noise', [2e-5, 5e-4])
def test_repeated_decays_and_steps_are_runs_of_their_own(step, noise):
    """The motion of two such decays correlates by up to 99 %."""
    rng = np.random.default_rng(8)
    runs = [(str(k), record(*log_manoeuvre(rng, step, noise=noise))) for k in range(8)]
    assert find_duplicate_runs(runs) == {}


MOVED = np.array([0.4, -0.2, 0.1, 0.0, 0.0, 0.0])
COPIES = {
    'shifted': lambda t, pose: (t + 3.217, pose),
    'cut': lambda t, pose: (t[310:-400] - t[310], pose[310:-400]),
    'moved': lambda t, pose: (t + 0.003, pose + MOVED),
    'rounded': lambda t, pose: (t, np.round(pose, 5)),
}


@pytest.mark.parametrize('how', COPIES)
@pytest.mark.parametrize('step', [False, True])
def test_a_copy_is_found_however_it_was_written(how, step):
    rng = np.random.default_rng(9)
    run, other = log_manoeuvre(rng, step), log_manoeuvre(rng, step)
    found = find_duplicate_runs(
        [('run', record(*run)), ('other', record(*other)), ('copy', record(*COPIES[how](*run)))]
    )
    assert [*found] == ['copy']
    assert ["'run'" in one.evidence for one in found['copy']] == [True]


def test_flights_that_shake_alike_are_runs_of_their_own():
    """Their signs agree at many offsets, so that agreement at one of them says nothing."""
    rng = np.random.default_rng(10)
    runs = []
    for k in range(4):
        t, pose = log_manoeuvre(rng)
        shaking = 2e-3 * np.sin(2.0 * np.pi * (12.0 + 0.01 * k) * t + k)
        runs.append((str(k), record(t, pose + shaking[:, None])))
    assert find_duplicate_runs(runs) == {}

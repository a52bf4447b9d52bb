"""Gains and exponent that a turn before a lamp teaches, against those that were simulated."""

from dataclasses import replace
import math

from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import DiodeArray
from lta_vlc.direction import Direction, DirectionFinder, GainTracker
from lta_vlc.lamp import LampPrior
import numpy as np
import pytest

COUNT = 8
ANGLES = np.arange(COUNT) * math.tau / COUNT
AXES = tuple((math.cos(a), math.sin(a), 0.0) for a in ANGLES)
TRUE = np.array([1.05, 0.93, 1.0, 1.04, 0.96, 1.02, 0.98, 1.03])


def array(spread=0.05, gains=(1.0,) * COUNT):
    return DiodeArray(AXES, ((0.0, 0.0, 0.0),) * COUNT, 1.2, gains, spread)


def block(angle, spoilt=(), response=1.2):
    """Return the readings of a lamp of 100 counts on 5 of pedestal, and its direction."""
    facing = np.maximum(np.cos(ANGLES - angle), 0.0) ** response
    snr = np.full(COUNT, 50.0)
    snr[list(spoilt)] = 0.0
    quiet = np.ones(COUNT)
    peaks = Peaks(TRUE * (100.0 * facing + 5.0), snr, frequency=quiet, noise=quiet)
    found = Direction(math.cos(angle), math.sin(angle), 0.0, 0.0, 0.0, 0.0, 100.0, 0.0, 5.0)
    return peaks, found


def test_a_turn_teaches_all_gains_but_their_mean():
    tracker = GainTracker(array())
    for k in range(64):
        tracker.update_gains(*block(k * math.tau / 64))
    learnt = np.array(tracker.diodes.gains)
    relative = TRUE / np.exp(np.log(TRUE).mean())
    # A quarter of the prior is left: 5 % against 6 % a block, a diode faces the lamp in a third
    assert np.abs(learnt / relative - 1.0).max() < 0.02
    assert tracker.diodes.spread < 0.025


def test_a_turn_teaches_the_exponent_too():
    tracker = GainTracker(replace(array(), response_deviation=0.5))
    for k in range(64):
        tracker.update_gains(*block((k + 0.5) * math.tau / 64, response=2.0))
    learnt = tracker.diodes
    # By the readings of oblique diodes, which are known to a tenth and less
    assert learnt.response == pytest.approx(2.0, abs=0.05)
    assert 0.01 < learnt.response_deviation < 0.1
    relative = TRUE / np.exp(np.log(TRUE).mean())
    assert np.abs(np.array(learnt.gains) / relative - 1.0).max() < 0.02


def test_a_file_that_is_sure_of_its_exponent_keeps_it():
    tracker = GainTracker(array())
    tracker.update_gains(*block(0.1, response=2.0))
    assert (tracker.diodes.response, tracker.diodes.response_deviation) == (1.2, 0.0)


def test_a_straight_flight_teaches_only_the_diodes_ahead():
    tracker = GainTracker(array())
    for _ in range(64):
        tracker.update_gains(*block(0.0))
    learnt = np.array(tracker.diodes.gains)
    # Nobody looked at those behind: they keep their ratio
    assert learnt[3] / learnt[4] == pytest.approx(1.0)
    assert learnt[0] / learnt[4] == pytest.approx(TRUE[0], abs=0.01)


def test_a_spoilt_or_dead_diode_teaches_nothing():
    tracker = GainTracker(array(gains=(1.0, 0.0, *(1.0,) * 6)))
    for k in range(16):
        tracker.update_gains(*block(k * math.tau / 16, spoilt=(0,)))
    learnt = tracker.diodes.gains
    assert learnt[1] == 0.0
    assert np.isfinite(learnt).all()
    kept = np.array(learnt)
    assert kept[2] / kept[4] == pytest.approx(TRUE[2] / TRUE[4], abs=0.02)
    # Neither was learnt from, so both moved with the mean alone
    straight = GainTracker(array())
    for _ in range(16):
        straight.update_gains(*block(0.0, spoilt=(0,)))
    learnt = straight.diodes.gains
    assert learnt[0] / learnt[4] == pytest.approx(1.0, rel=1e-12)
    assert learnt[1] / learnt[4] == pytest.approx(TRUE[1], abs=0.05)


@pytest.mark.parametrize('spread', [0.0, 0.005, 0.01])
def test_no_spread_is_more_than_that_of_the_prior(spread):
    tracker = GainTracker(array(spread))
    assert tracker.diodes.spread == spread
    tracker.update_gains(*block(0.0))
    assert tracker.diodes.spread == spread


def test_a_lamp_behind_the_hull_teaches_nothing():
    tracker = GainTracker(array())
    tracker.update_gains(*block(0.4))
    learnt = tracker.diodes
    peaks, direction = block(1.2)
    # The diode that faces the lamp reads half of what its neighbours say
    peaks.amplitude[int(np.argmin(np.abs(ANGLES - 1.2)))] *= 0.5
    tracker.update_gains(peaks, direction)
    assert tracker.diodes == learnt


def find_directions(finder, angles, **options):
    """Return the errors of the directions of a lamp that stands at each of some angles. [rad]"""
    errors = []
    for angle in angles:
        found = finder.find(block(angle, **options)[0], 6.0, LampPrior())
        errors.append(math.remainder(found.azimuth - angle, math.tau))
    return np.array(errors)


def test_directions_become_better_while_the_drone_turns():
    diodes = replace(array(), response_deviation=0.5)
    turn = np.arange(112) * math.tau / 16
    learning = DirectionFinder(diodes, learns=True)
    before = find_directions(learning, turn[:-16])
    after = find_directions(learning, turn[-16:])
    fixed = find_directions(DirectionFinder(diodes, learns=False), turn[:16])
    # The first block is read with the file's gains
    assert before[0] == fixed[0]
    assert np.sqrt(np.mean(after**2)) < 0.5 * np.sqrt(np.mean(fixed**2))
    assert learning.diodes.spread < 0.6 * diodes.spread


def test_many_blocks_from_one_direction_count_once():
    once, often = (DirectionFinder(array(), learns=True) for _ in range(2))
    find_directions(once, [0.2])
    find_directions(often, [0.2 + 0.01 * math.sin(k) for k in range(50)])
    assert once.diodes == often.diodes
    # Also across the turn at half a revolution
    find_directions(often, [math.pi - 0.02, 0.02 - math.pi])
    find_directions(once, [math.pi - 0.02])
    assert once.diodes.gains == pytest.approx(often.diodes.gains, abs=1e-12)

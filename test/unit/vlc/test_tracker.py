"""A beacon's expected frequency and its presence from block to block, by hand."""

from lta_vlc.presence import Presence
from lta_vlc.tracker import reach, Tracker
import pytest


def test_the_error_moves_a_quarter_of_the_way_and_stays_within_reach():
    tracker = Tracker(150.0).heard(154.0, 20.0)
    assert tracker == Tracker(150.0, 1.0, 0)
    tracker = tracker.heard(154.0, 20.0)
    assert tracker.error == pytest.approx(1.75)
    assert tracker.heard(154.0, 2.0).error == 2.0
    assert Tracker(150.0).heard(130.0, 2.0).error == -2.0


def test_after_twenty_silent_blocks_the_nominal_frequency_is_expected():
    tracker = Tracker(150.0, 1.5)
    for silent in range(1, 20):
        tracker = tracker.missed()
        assert tracker == Tracker(150.0, 1.5, silent)
    assert tracker.missed() == Tracker(150.0, 0.0, 20)
    assert Tracker(150.0, 1.5, 4).missed(15) == Tracker(150.0, 1.5, 19)
    assert Tracker(150.0, 1.5, 4).missed(16) == Tracker(150.0, 0.0, 20)
    assert Tracker(150.0, 1.5, 19).heard(151.5, 20.0) == Tracker(150.0, 1.5, 0)


@pytest.mark.parametrize(
    ('beacons', 'flicker', 'apart', 'far'),
    [
        ((1000.0,), (), 30.0, 50.0),  # a twentieth of its frequency
        ((1000.0, 1120.0), (), 30.0, 30.0),  # half of the way to the next beacon, less `apart`
        ((880.0, 1000.0), (), 30.0, 30.0),
        ((1000.0,), (930.0, 1100.0), 30.0, 40.0),  # all of the way to the flicker, less `apart`
        ((1000.0, 1120.0), (1050.0,), 30.0, 20.0),
        ((1000.0, 1050.0), (), 30.0, 0.0),
    ],
)
def test_reach_ends_before_the_bins_of_other_beacons_and_of_flicker(beacons, flicker, apart, far):
    assert reach(1000.0, beacons, flicker, apart) == pytest.approx(far)


def test_a_beacon_is_found_after_two_blocks_and_lost_after_five():
    presence = Presence()
    assert presence == (False, 0)
    presence = presence.after(True)
    assert presence == (False, 1)
    assert presence.after(False) == (False, 0)
    presence = presence.after(True)
    assert presence == (True, 0)
    for against in range(1, 5):
        presence = presence.after(False)
        assert presence == (True, against)
    assert presence.after(False) == (False, 0)
    assert Presence().after(True, 2) == (True, 0)

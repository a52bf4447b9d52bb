"""A beacon's expected frequency and its presence from block to block, by hand."""

from lta_vlc.receiver import BeaconPresence, FrequencyTracker, tracking_range
import pytest


def test_the_error_moves_a_quarter_of_the_way_and_stays_within_reach():
    tracker = FrequencyTracker(150.0).update_frequency(154.0, 20.0)
    assert tracker == FrequencyTracker(150.0, 1.0, 0)
    tracker = tracker.update_frequency(154.0, 20.0)
    assert tracker.error == pytest.approx(1.75)
    assert tracker.update_frequency(154.0, 2.0).error == 2.0
    assert FrequencyTracker(150.0).update_frequency(130.0, 2.0).error == -2.0


def test_after_twenty_silent_blocks_the_nominal_frequency_is_expected():
    tracker = FrequencyTracker(150.0, 1.5)
    for silent in range(1, 20):
        tracker = tracker.coast_without_detection()
        assert tracker == FrequencyTracker(150.0, 1.5, silent)
    assert tracker.coast_without_detection() == FrequencyTracker(150.0, 0.0, 20)
    assert FrequencyTracker(150.0, 1.5, 4).coast_without_detection(15) == FrequencyTracker(
        150.0, 1.5, 19
    )
    assert FrequencyTracker(150.0, 1.5, 4).coast_without_detection(16) == FrequencyTracker(
        150.0, 0.0, 20
    )
    assert FrequencyTracker(150.0, 1.5, 19).update_frequency(151.5, 20.0) == FrequencyTracker(
        150.0, 1.5, 0
    )


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
    assert tracking_range(1000.0, beacons, flicker, apart) == pytest.approx(far)


def test_a_beacon_is_found_after_two_blocks_and_lost_after_five():
    presence = BeaconPresence()
    assert presence == (False, 0)
    presence = presence.update_presence(True)
    assert presence == (False, 1)
    assert presence.update_presence(False) == (False, 0)
    presence = presence.update_presence(True)
    assert presence == (True, 0)
    for against in range(1, 5):
        presence = presence.update_presence(False)
        assert presence == (True, against)
    assert presence.update_presence(False) == (False, 0)
    assert BeaconPresence().update_presence(True, 2) == (True, 0)

"""Which beacons are refused, and with what sentence."""

from lta_config.errors import BadInput
from lta_vlc.receiver import BeaconReceiver
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.bins import alias_frequency, check_beacons, mains_flicker_frequencies
import pytest


@pytest.mark.parametrize(
    ('frequency', 'appears'),
    [(150.0, 150.0), (5000.0, 5000.0), (6000.0, 4000.0), (10_000.0, 0.0), (10_150.0, 150.0)],
)
def test_sampling_folds_frequencies(frequency, appears):
    assert alias_frequency(frequency, 10_000.0) == pytest.approx(appears)


def test_lamps_on_the_mains_flicker_at_twice_its_frequency():
    assert mains_flicker_frequencies(60.0, 10_000.0) == [120.0 * k for k in range(1, 11)]
    assert mains_flicker_frequencies(0.0, 10_000.0) == []
    assert mains_flicker_frequencies(50.0, 250.0)[:4] == [100.0, 50.0, 50.0, 100.0]


@pytest.mark.parametrize(
    ('settings', 'sentence'),
    [
        ({'others': (190.0,)}, r'150 and 190 Hz are closer than the resolution of 50 Hz'),
        ({'others': (150.0,)}, 'closer than the resolution'),
        ({'others': (450.0,)}, 'Harmonic 3 of the beacon at 150 Hz falls on .* at 450 Hz'),
        (
            {'others': (3280.0,)},
            'Harmonic 3 of the beacon at 3280 Hz .* at 150 Hz',
        ),  # 9840, folded
        (
            {'frequency': 310.0},
            r'\(2 bins of 10 Hz on either side\) contains the flicker of mains lamps at 300 Hz',
        ),
        ({'frequency': 175.0}, 'flicker of mains lamps at 200 Hz; choose another'),
        ({'frequency': 230.0, 'mains': 60.0}, 'flicker of mains lamps at 240 Hz'),
        ({'others': (6000.0,)}, 'at 6000 Hz cannot be detected'),
        ({'others': (430.0,)}, 'Harmonic 3 of the beacon at 150 Hz falls on .* at 430 Hz'),
        ({'others': (470.0,)}, 'Harmonic 3 of the beacon at 150 Hz falls on .* at 470 Hz'),
        ({'others': (730.0,)}, 'Harmonic 5 of the beacon at 150 Hz falls on .* at 730 Hz'),
        (
            {'frequency': 320.0},
            r'\(2 bins of 10 Hz on either side\) contains the flicker of mains lamps at 300 Hz',
        ),
        (
            {'frequency': 1020.0},
            'flicker of mains lamps at 1000 Hz',
        ),  # the tenth harmonic of 100 Hz
    ],
)
def test_what_cannot_be_told_apart_is_refused_at_the_start(settings, sentence):
    with pytest.raises(BadInput, match=sentence):
        BeaconReceiver(DemodulationSettings(**settings), 10_000.0, 1000)


@pytest.mark.parametrize(
    'settings',
    [
        {'others': (250.0, 350.0)},
        {'others': (200.0,), 'mains': 0.0},
        {'frequency': 310.0, 'mains': 60.0},
        {'frequency': 150.0, 'others': (180.0,), 'window': 1},
        {'others': (420.0,), 'mains': 0.0},
        {'others': (480.0,), 'mains': 0.0},
        {'others': (720.0,), 'mains': 0.0},
        {'frequency': 330.0},
        {'frequency': 1100.0},  # harmonics of 100 Hz above the tenth are ignored
    ],
)
def test_what_can_be_told_apart_is_taken(settings):
    BeaconReceiver(DemodulationSettings(**settings), 10_000.0, 1000)


def test_many_beacons_leave_no_bins_for_the_noise():
    settings = DemodulationSettings(
        frequency=150.0, others=(2e2, 2.5e2, 3.5e2), window=0, mains=0.0
    )
    with pytest.raises(BadInput, match='250, 350 Hz and their harmonics leave only 2 FFT bins'):
        BeaconReceiver(settings, 800.0, 16)
    check_beacons((150.0, 250.0), settings, 10_000.0, 1000)

"""What /diagnostics says of the light, word by word."""

import math

from lta_graph.health import HealthLevel
from lta_vlc.demodulation import DemodulatedBlock, DiodeFault, Peaks
from lta_vlc.diagnostics import describe_beacons
from lta_vlc.receiver import BeaconPresence
import numpy as np

NOTHING = np.zeros(4)
LOST, FOUND = BeaconPresence(False), BeaconPresence(True)


def told(*presences, snr=(5.0, 3.0), faults=(DiodeFault.NONE,) * 4):
    """Return the facts of two beacons, at 150 and 250 Hz, that are heard 0.3 Hz too high."""
    peaks = tuple(
        Peaks(NOTHING, np.array([0.5 * best, best, 0.0, 0.0]), NOTHING, NOTHING) for best in snr
    )
    hearing = DemodulatedBlock(peaks, (150.3, 250.3), faults, NOTHING)
    return list(describe_beacons(hearing, (150.0, 250.0), presences, 7, 2))


def test_the_wanted_beacon_warns_where_no_diode_hears_it_and_another_never():
    assert [(fact.task, fact.level, fact.message) for fact in told(FOUND, FOUND)] == [
        ('light', HealthLevel.OK, 'beacon found'),
        ('beacon at 250 Hz', HealthLevel.OK, 'beacon found'),
    ]
    assert [(fact.level, fact.message) for fact in told(LOST, LOST)] == [
        (HealthLevel.WARN, 'no photodiode receives the beacon'),
        (HealthLevel.OK, 'no photodiode receives the beacon'),
    ]


def test_what_concerns_the_diodes_is_told_once():
    saturated = DiodeFault.SATURATED | DiodeFault.ALIASED
    faults = (
        saturated,
        DiodeFault.FLAT,
        DiodeFault.SATURATED,
        DiodeFault.SATURATED | DiodeFault.NOT_A_NUMBER,
    )
    wanted, other = told(FOUND, FOUND, faults=faults)
    assert wanted.values == {
        'beacon_Hz': '150',
        'best_snr': '5.0',
        'frequency_error_Hz': '0.300',
        'saturated_diodes': '3',
        'flat_diodes': '1',
        'wild_diodes': '1',
        'aliased_diodes': '1',
        'blocks_missing': '7',
        'blocks_refused': '2',
    }
    assert other.values == {
        'beacon_Hz': '250',
        'best_snr': '3.0',
        'frequency_error_Hz': '0.300',
    }


def test_one_that_is_not_heard_has_no_frequency_to_be_off():
    assert math.isnan(float(told(LOST, FOUND)[0].values['frequency_error_Hz']))
    deaf = told(FOUND, FOUND, snr=(0.0, 3.0))[0].values['frequency_error_Hz']
    assert math.isnan(float(deaf))
    faint = told(FOUND, FOUND, snr=(1.0, 1.0))[1].values['frequency_error_Hz']
    assert faint == '0.300'

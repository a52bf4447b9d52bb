"""Describe the state of the light reception for /diagnostics."""

from collections.abc import Iterator
import math

from lta_graph.health import HealthFact, HealthLevel
from lta_vlc.demodulation import DemodulatedBlock, DiodeFault
from lta_vlc.receiver import BeaconPresence

WANTED_TASK = 'light'  # diagnostics task of the wanted beacon


def describe_beacons(
    hearing: DemodulatedBlock,
    beacons: tuple[float, ...],
    presences: tuple[BeaconPresence, ...],
    missing: int,
    refused: int,
) -> Iterator[HealthFact]:
    """
    Yield a fact for each beacon; that of the wanted one, which is first, includes the diodes.

    `beacons` are nominal frequencies [Hz]; `missing` and `refused` count blocks since the start.
    """
    for one, beacon in enumerate(beacons):
        is_detected = presences[one].found
        best = float(hearing.peaks[one].snr.max())
        # A beacon that is not detected has no frequency error.
        error = hearing.frequencies[one] - beacon if is_detected and best > 0.0 else math.nan
        values = {
            'beacon_Hz': f'{beacon:g}',
            'best_snr': f'{best:.1f}',
            'frequency_error_Hz': f'{error:.3f}',
        }
        # Diode faults concern all beacons; they are reported once
        if one == 0:
            values |= {
                'saturated_diodes': _count_faulty_diodes(hearing, DiodeFault.SATURATED),
                'flat_diodes': _count_faulty_diodes(hearing, DiodeFault.FLAT),
                'wild_diodes': _count_faulty_diodes(hearing, DiodeFault.NOT_A_NUMBER),
                'aliased_diodes': _count_faulty_diodes(hearing, DiodeFault.ALIASED),
                'blocks_missing': str(missing),
                'blocks_refused': str(refused),
            }
        yield HealthFact(
            WANTED_TASK if one == 0 else f'beacon at {beacon:g} Hz',
            # Only the wanted beacon is needed for the flight
            HealthLevel.OK if is_detected or one > 0 else HealthLevel.WARN,
            'beacon found' if is_detected else 'no photodiode receives the beacon',
            values,
        )


def _count_faulty_diodes(hearing: DemodulatedBlock, fault: DiodeFault) -> str:
    """Return how many diodes have a fault."""
    return str(sum(fault in each for each in hearing.faults))

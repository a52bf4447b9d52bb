"""How the light stands, in the words and figures that /diagnostics shows."""

from collections.abc import Iterator
import math

from lta_graph.health import Fact, Level
from lta_vlc.demodulation import Hearing
from lta_vlc.faults import Fault
from lta_vlc.presence import Presence

WANTED = 'light'  # the task that tells of the beacon that is wanted


def conditions(
    hearing: Hearing,
    beacons: tuple[float, ...],
    presences: tuple[Presence, ...],
    missing: int,
    refused: int,
) -> Iterator[Fact]:
    """
    Yield a fact for each beacon, that of the wanted one with what concerns the diodes.

    Parameters
    ----------
    hearing : Hearing
        What the newest block says.
    beacons : tuple of float
        Where the beacons should flicker, the wanted one first. [Hz]
    presences : tuple of Presence
        How each stands.
    missing, refused : int
        Blocks that have not come, and that could not be used, since the start.

    """
    for one, beacon in enumerate(beacons):
        found = presences[one].found
        best = float(hearing.peaks[one].snr.max())
        # One that is not heard has no frequency to be off.
        error = hearing.frequencies[one] - beacon if found and best > 0.0 else math.nan
        values = {
            'beacon_Hz': f'{beacon:g}',
            'best_snr': f'{best:.1f}',
            'frequency_error_Hz': f'{error:.3f}',
        }
        if one == 0:
            values |= {
                'saturated_diodes': _count(hearing, Fault.SATURATED),
                'flat_diodes': _count(hearing, Fault.FLAT),
                'wild_diodes': _count(hearing, Fault.NOT_A_NUMBER),
                'aliased_diodes': _count(hearing, Fault.ALIASED),
                'blocks_missing': str(missing),
                'blocks_refused': str(refused),
            }
        yield Fact(
            WANTED if one == 0 else f'beacon at {beacon:g} Hz',
            Level.OK if found or one > 0 else Level.WARN,
            'beacon found' if found else 'no diode hears the beacon',
            values,
        )


def _count(hearing: Hearing, fault: Fault) -> str:
    """Return how many diodes have a fault."""
    return str(sum(fault in each for each in hearing.faults))

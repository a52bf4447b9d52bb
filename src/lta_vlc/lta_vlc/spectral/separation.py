"""Check that beacons can be separated from each other and from mains flicker."""

from collections.abc import Sequence
from itertools import combinations, permutations
from typing import TYPE_CHECKING

from lta_config.errors import BadInput
from lta_vlc.spectral.spectrum import target_bin

if TYPE_CHECKING:
    from lta_vlc.settings import DemodulationSettings

HARMONICS = 3, 5  # of a lamp that is on for half of the time; weaker ones `lta light plan` avoids
MAINS_HARMONICS = 10  # of the flicker at twice the mains' frequency: those of lamps and dimmers


def mains_flicker_frequencies(mains: float, sample_rate: float) -> list[float]:
    """
    Return the frequencies at which lamps on the mains appear to flicker. [Hz]

    Parameters
    ----------
    mains : float
        Frequency of the mains; 0 where there are none. [Hz]
    sample_rate : float
        Samples a second. [Hz]

    """
    orders = range(1, MAINS_HARMONICS + 1) if mains > 0.0 else ()
    return [alias_frequency(2.0 * mains * order, sample_rate) for order in orders]


def alias_frequency(frequency: float, sample_rate: float) -> float:
    """Return where a frequency appears once it is sampled. [Hz]"""
    return abs((frequency + sample_rate / 2.0) % sample_rate - sample_rate / 2.0)


def check_beacons(
    beacons: Sequence[float], settings: 'DemodulationSettings', sample_rate: float, samples: int
) -> None:
    """
    Refuse beacons that cannot be told apart.

    Parameters
    ----------
    beacons : sequence of float
        Their frequencies. [Hz]
    settings : Demodulation
        How to listen.
    sample_rate : float
        Samples a second of each diode. [Hz]
    samples : int
        Samples in a block.

    Raises
    ------
    BadInput
        If two are sought in the same bins, or if a strong harmonic of one or the flicker of the
        mains falls where another is sought, folded back by the sampling as it may be.

    """
    window, width = settings.window, sample_rate / samples
    places = {beacon: target_bin(beacon, sample_rate, samples) for beacon in beacons}
    apart = (2 * window + 1) * width
    for one, other in combinations(beacons, 2):
        if abs(places[one] - places[other]) <= 2 * window:
            raise BadInput(
                f'The beacons at {one:g} and {other:g} Hz are closer than the resolution of '
                f'{apart:g} Hz; choose others, take longer blocks or a narrower window.'
            )
    for one, other in permutations(beacons, 2):
        for order in HARMONICS:
            harmonic = target_bin(alias_frequency(order * one, sample_rate), sample_rate, samples)
            if abs(harmonic - places[other]) <= window:
                raise BadInput(
                    f'Harmonic {order} of the beacon at {one:g} Hz falls on the beacon at '
                    f'{other:g} Hz; choose another frequency.'
                )
    for order, flicker in enumerate(
        mains_flicker_frequencies(settings.mains, sample_rate), start=1
    ):
        for beacon in beacons:
            if abs(target_bin(flicker, sample_rate, samples) - places[beacon]) <= window:
                raise BadInput(
                    f'The beacon at {beacon:g} Hz is sought within {window} bins of {width:g} Hz, '
                    f'where lamps on the mains flicker, at {2.0 * settings.mains * order:g} Hz; '
                    'choose another frequency, narrow the window, or set mains (0 for none).'
                )

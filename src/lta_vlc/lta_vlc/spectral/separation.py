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
    """Return the apparent flicker frequencies of lamps on the mains; `mains` is 0 without. [Hz]"""
    orders = range(1, MAINS_HARMONICS + 1) if mains > 0.0 else ()
    return [alias_frequency(2.0 * mains * order, sample_rate) for order in orders]


def alias_frequency(frequency: float, sample_rate: float) -> float:
    """Return the apparent frequency after sampling. [Hz]"""
    # Fold into the range from 0 to the Nyquist frequency
    return abs((frequency + sample_rate / 2.0) % sample_rate - sample_rate / 2.0)


def check_beacons(
    beacons: Sequence[float], settings: 'DemodulationSettings', sample_rate: float, samples: int
) -> None:
    """
    Refuse beacons [Hz] that cannot be separated.

    Raise `BadInput` if the search bins of two overlap, or if a strong harmonic of one or the mains
    flicker, possibly aliased, falls into those of another.
    """
    window, width = settings.window, sample_rate / samples
    places = {beacon: target_bin(beacon, sample_rate, samples) for beacon in beacons}
    apart = (2 * window + 1) * width
    for one, other in combinations(beacons, 2):
        # Search windows overlap
        if abs(places[one] - places[other]) <= 2 * window:
            raise BadInput(
                f'The beacons at {one:g} and {other:g} Hz are closer than the resolution '
                f'of {apart:g} Hz; choose other frequencies, longer blocks or a narrower '
                'search window.'
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
                    f'The search window of the beacon at {beacon:g} Hz ({window} bins of '
                    f'{width:g} Hz on either side) contains the flicker of mains lamps at '
                    f'{2.0 * settings.mains * order:g} Hz; choose another frequency or a '
                    'narrower window, or set mains to 0 if there are no such lamps.'
                )

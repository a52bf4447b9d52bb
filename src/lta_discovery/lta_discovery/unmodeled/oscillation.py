"""
Detect slow oscillations of the latent wrench, such as those of a periodic wind.

The latent wrench follows oscillations slower than half a wave per knot interval, so that the
residuals do not show them (`spectral_line.py` covers faster ones). The search uses the wrench at
the knots of whole flights: forces in map axes, where a wind keeps its direction while the vehicle
turns, and forces and moments in body axes. All flights have to show one frequency; phases are
free.
"""

from collections.abc import Sequence
import math
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import MEMORY
from lta_discovery.flights.windows import LENGTH
from lta_discovery.unmodeled.latent_series import LatentSeries
from lta_discovery.unmodeled.spectral_line import (
    find_steady_line,
    level_spectrum,
    LeveledSpectrum,
    NEAR,
    STEPS,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SLOWEST: Final = 0.05  # Hz
# Of the Nyquist frequency of the knots; at 1 all knots may lie at zeros of the wave.
FOLLOWED: Final = 0.9
CYCLES: Final = 4.0  # fewest cycles in the shortest flight
BESIDE: Final = 0.3  # Hz; width of the running median that gives the level
# Noise floors; smallest RMS of an oscillation. Without missing effects no axis reaches it.
WORTH: Final = 1.5
# A steep spectrum has local peaks without relevant power.
PART: Final = 0.01  # of the power of its axes; smallest power of an oscillation
TAKES: Final = 0.5  # of the power of its axes; a stronger oscillation explains them


@final
class LatentOscillation(NamedTuple):
    """An oscillation of the latent wrench."""

    channel: str
    hertz: float  # frequency [Hz]
    amplitude: float  # of the force [N] or moment [N m], mean of the flights
    # Of the power of its axes: for a force in the map, of both horizontal axes, or the vertical
    share: float

    @property
    def axes(self) -> tuple[str, ...]:
        """Axes of the body on which it acts."""
        return CHANNELS[self.channel][0]

    @property
    def sentence(self) -> str:
        """Description in words."""
        unit = 'mN' if CHANNELS[self.channel][1] < 3 else 'mN m'
        size = f'{1e3 * self.amplitude:.2g} {unit}'
        return f'an oscillation of the {self.channel} at {self.hertz:.2f} Hz, {size}'


# Body axes on which each acts, and the index of its noise floor.
CHANNELS: Final[dict[str, tuple[tuple[str, ...], int]]] = {
    'force along x of the map': (('surge', 'sway'), 0),
    'force along y of the map': (('surge', 'sway'), 1),
    'vertical force': (('heave',), 2),
    'surge force': (('surge',), 0),
    'sway force': (('sway',), 1),
    'roll moment': (('roll',), 3),
    'pitch moment': (('pitch',), 4),
    'yaw moment': (('yaw',), 5),
}
OF_MAP: Final = tuple(CHANNELS)[:2]
OF_BODY: Final = tuple(CHANNELS)[3:5]


def stack_channels(series: LatentSeries) -> Array:
    """Return the wrench in the order of CHANNELS, shape (N, 8). [N, N m]"""
    return np.hstack([series.ground, series.body[:, :2], series.body[:, 3:]])


def fit_wave_power(time: Array, values: Array, hertz: Array) -> Array:
    """
    Return squared amplitudes of single waves fitted to series, shape (B, C).

    Least squares, after removal of a linear trend. The times may have gaps.
    """
    # Centred times keep the fit well conditioned
    at = time - time.mean()
    line = np.column_stack([np.ones_like(at), at])
    rest = values - line @ np.linalg.lstsq(line, values, rcond=None)[0]
    out = np.empty((len(hertz), values.shape[1]))
    for k, each in enumerate(2.0 * np.pi * hertz):
        wave = np.column_stack([np.cos(each * at), np.sin(each * at)])
        out[k] = np.sum(np.linalg.lstsq(wave, rest, rcond=None)[0] ** 2, axis=0)
    return out


def find_common_oscillations(
    series: Sequence[LatentSeries], floor: Array, knots: int
) -> tuple[LatentOscillation, ...]:
    """Return the oscillations that all flights show, the strongest first."""
    # The lower limit follows from the shortest flight
    least = max(SLOWEST, CYCLES / max(min(each.duration for each in series), 1e-9))
    # Just below the Nyquist frequency of the knots
    highest = FOLLOWED * 0.5 * (knots - 1) / LENGTH
    if highest - least < BESIDE:
        return ()
    # Start at one cycle, so that the lowest frequencies have neighbours for their level.
    step = 1.0 / (STEPS * max(each.duration for each in series))
    hertz = step * np.arange(STEPS, math.floor(highest / step) + 1, dtype=np.float64)
    # Whiten the spectrum of noise with correlation time MEMORY.
    colour: Array = 1.0 + (2.0 * np.pi * hertz * MEMORY) ** 2
    power = [fit_wave_power(each.time, stack_channels(each), hertz) for each in series]
    total = [np.mean(stack_channels(each) ** 2, axis=0) for each in series]
    oscillations = []
    for k, (name, (_, place)) in enumerate(CHANNELS.items()):
        seen = [level_spectrum(hertz, each[:, k] * colour, 1, BESIDE, least) for each in power]
        at = find_steady_line(seen)
        if at is None:
            continue
        size = [_peak_power(one, at) for one in seen]
        amplitude = float(np.mean(np.sqrt(size)))
        pair = [j for j, other in enumerate(CHANNELS) if _shares_power(other, name)]
        # The power of a wave is half its squared amplitude
        share = 0.5 * sum(size) / float(np.sum([each[pair] for each in total]))
        # The limit is an RMS; the amplitude is root 2 of it
        if share > PART and amplitude > math.sqrt(2.0) * WORTH * floor[place]:
            oscillations.append(
                LatentOscillation(name, float(seen[0].hertz[at]), amplitude, share)
            )
    return tuple(sorted(_select_frame(oscillations), key=lambda one: -one.share))


def _peak_power(spectrum: LeveledSpectrum, at: int) -> float:
    """Return the squared amplitude of a flight's wave near a bin."""
    beside = slice(max(at - NEAR * STEPS, 0), at + NEAR * STEPS + 1)
    colour = 1.0 + (2.0 * np.pi * spectrum.hertz[beside] * MEMORY) ** 2
    return float(np.max(spectrum.power[beside] / colour))


def _shares_power(other: str, name: str) -> bool:
    """Return whether the power of a channel counts for the share of another."""
    return other == name or (name in OF_MAP and other in OF_MAP)


def _select_frame(candidates: Sequence[LatentOscillation]) -> list[LatentOscillation]:
    """Return the oscillations in the frame, map or body, in which they are stronger."""
    strength = [
        sum(one.amplitude**2 for one in candidates if one.channel in some)
        for some in (OF_MAP, OF_BODY)
    ]
    # A wave in one frame leaks into the other as the vehicle turns
    less = OF_BODY if strength[0] >= strength[1] else OF_MAP
    return [one for one in candidates if one.channel not in less]


def dominant_oscillations(
    oscillations: Sequence[LatentOscillation],
) -> dict[str, LatentOscillation]:
    """Return the strongest oscillation of each axis that oscillations mainly explain."""
    share: dict[str, float] = {}
    for one in oscillations:
        for axis in one.axes:
            share[axis] = share.get(axis, 0.0) + one.share
    return {
        axis: max((one for one in oscillations if axis in one.axes), key=lambda one: one.share)
        for axis, part in share.items()
        if part > TAKES
    }

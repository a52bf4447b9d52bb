"""Estimate bearing and lamp position from the peaks of one beacon."""

from typing import final, NamedTuple

from lta_vlc.bearing import Bearing, estimate_bearing
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import DiodeArray
from lta_vlc.gain_tracking import build_direction_finder
from lta_vlc.lamp import estimate_lamp_position, LampEstimate, LampPrior


class LampDetection(NamedTuple):
    """The paper's vector, and the lamp in the body frame; None where nothing is detected."""

    towards: Bearing | None = None
    lamp: LampEstimate | None = None


@final
class LampFinder:
    """Find the lamp with an array of diodes; `learns` if it learns their gains and response."""

    def __init__(self, diodes: DiodeArray, *, learns: bool = False) -> None:
        self.diodes = diodes
        self._finder = build_direction_finder(diodes, learns=learns)

    def prepare(self) -> None:
        """Compile the fit, or load it from disk, before the first block."""
        self._finder.prepare()

    def find_lamp(self, peaks: Peaks, threshold: float, prior: LampPrior) -> LampDetection:
        """Return bearing and position of the wanted beacon; `threshold` is an SNR."""
        towards = estimate_bearing(peaks, self.diodes.ring, threshold)
        direction = self._finder.find(peaks, threshold, prior)
        return LampDetection(
            towards, None if direction is None else estimate_lamp_position(direction, prior)
        )

"""Define the receiver: the drone, its diodes and its demodulator."""

from dataclasses import dataclass
from typing import final

from lta_config.topics import AdcBlockShape
from lta_model.vehicle import Vehicle
from lta_vlc.settings import DemodulationSettings


@final
@dataclass(frozen=True, slots=True)
class LightReceiver:
    """
    Receiver of the lamps.

    Attributes
    ----------
    vehicle : Vehicle
        Hull and photodiode ring.
    demodulation : DemodulationSettings
        Demodulator; its frequency is replaced by that of each lamp.
    light : AdcBlockShape
        Sampling rate and block length.
    margin : float
        Required SNR relative to the threshold.

    """

    vehicle: Vehicle
    demodulation: DemodulationSettings
    light: AdcBlockShape
    margin: float

    @property
    def required_snr(self) -> float:
        """SNR above which a lamp counts as received."""
        return self.margin * self.demodulation.threshold

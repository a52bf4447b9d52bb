"""Define the receiver: the drone, its diodes and its demodulator."""

from dataclasses import dataclass
from typing import final

from lta_config.topics import AdcBlockShape
from lta_model.vehicle import Vehicle
from lta_vlc.settings import DemodulationSettings


@final
@dataclass(frozen=True, slots=True)
class LightReceiver:
    """Receiver of the lamps."""

    vehicle: Vehicle  # hull and photodiode ring
    # Demodulator; its frequency is replaced by that of each lamp
    demodulation: DemodulationSettings
    light: AdcBlockShape  # sampling rate and block length
    margin: float  # required SNR relative to the threshold

    @property
    def required_snr(self) -> float:
        """SNR above which a lamp counts as received."""
        return self.margin * self.demodulation.threshold

"""Who listens: the drone, its diodes and its demodulator."""

from dataclasses import dataclass
from typing import final

from lta_config.topics import AdcBlockShape
from lta_model.vehicle import Vehicle
from lta_vlc.settings import DemodulationSettings


@final
@dataclass(frozen=True, slots=True)
class LightReceiver:
    """
    Who listens.

    Attributes
    ----------
    vehicle : Vehicle
        Its hull and ring.
    demodulation : Demodulation
        How it listens; the frequency is each lamp's.
    light : Light
        Sampling rate and block length.
    margin : float
        How far above the threshold the SNR must be.

    """

    vehicle: Vehicle
    demodulation: DemodulationSettings
    light: AdcBlockShape
    margin: float

    @property
    def required_snr(self) -> float:
        """The SNR from which a lamp counts as heard."""
        return self.margin * self.demodulation.threshold

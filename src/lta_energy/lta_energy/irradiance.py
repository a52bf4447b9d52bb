# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simulate the light on the perch over days, minute by minute, and forecast it.

Clear sky after Haurwitz (1945, Insolation in relation to cloudiness and cloud density, J.
Meteorology 2, 154-166): 1098 W/m2 sin(h) exp(-0.057 / sin(h)) on level ground at the solar
elevation h, with Cooper's declination (1969, Solar Energy 12, 333-346), times the transmittance of
the glass. Clouds are a random sequence of covered and clear intervals.

The forecast knows lamps and clear sky exactly, but only the mean transmittance of the clouds.
"""

from dataclasses import dataclass
import math
from typing import final, NamedTuple

from lta_config.schema.mission_file import CloudSequence, DAY, LightDay, SunModel, TimedLamp
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float64]
MINUTE = 60.0  # s
MINUTES = round(DAY / MINUTE)


class PanelIrradiance(NamedTuple):
    """Irradiance of the panel at one time."""

    sun: float  # direct and diffuse sunlight [W/m2]
    lamps: float  # lamps that burn steadily [W/m2]
    beacon: float  # the flickering lamp while it is on [W/m2]
    duty: float  # duty cycle of the flickering lamp [1]


NO_IRRADIANCE = PanelIrradiance(0.0, 0.0, 0.0, 1.0)


@final
@dataclass(frozen=True, slots=True, eq=False)
class IrradianceSeries:
    """Irradiance over several days, one sample per minute."""

    # As in `PanelIrradiance`, shape (n,) [W/m2]
    sun: Array
    lamps: Array
    beacon: Array
    duty: float
    clear: Array  # `sun` without clouds, shape (n,) [W/m2]
    mean: float  # mean transmittance of the clouds [1]
    efficacies: tuple[float, float, float]  # of sun, lamps and beacon [lm/W]

    def at(self, time: float) -> PanelIrradiance:
        """Return the irradiance at a time since the first midnight [s]."""
        k = self._minute_index(time)
        return PanelIrradiance(
            float(self.sun[k]), float(self.lamps[k]), float(self.beacon[k]), self.duty
        )

    def forecast_irradiance(self, time: float) -> PanelIrradiance:
        """Return the expected irradiance at a time [s], also after the last day."""
        k = int(time / MINUTE) % MINUTES  # all days are of one date
        sun = self.mean * float(self.clear[k])
        return PanelIrradiance(sun, float(self.lamps[k]), float(self.beacon[k]), self.duty)

    def illuminance(self) -> Array:
        """Return the illuminance of the panel, with the beacon averaged over its flicker [lx]."""
        sun, lamps, beacon = self.efficacies
        # [W/m2] times [lm/W]
        return sun * self.sun + lamps * self.lamps + beacon * self.duty * self.beacon

    @property
    def end(self) -> float:
        """End of the last day [s]."""
        return len(self.sun) * MINUTE

    def _minute_index(self, time: float) -> int:
        # Clamp, so that rounding at the last step does not index past the end
        return min(max(int(time / MINUTE), 0), len(self.sun) - 1)


def simulate_irradiance(day: LightDay, days: int, seed: int) -> IrradianceSeries:
    """Simulate the light of some days, all of one date; the seed sets the clouds."""
    # Midpoints of the minutes
    times: Array = np.arange(0.5, days * MINUTES) * MINUTE
    nothing = np.zeros(len(times))
    clear = nothing if day.sun is None else clear_sky_irradiance(day.sun, times)
    sun, mean = clear, 1.0
    if day.sun is not None:
        # The tag separates this random stream from others that use the same seed
        chance = np.random.default_rng(np.random.SeedSequence([seed, 0xC10D]))
        sun = clear * np.concatenate(
            [simulate_cloud_transmittance(day.sun.clouds, chance) for _ in range(days)]
        )
        mean = mean_cloud_transmittance(day.sun.clouds)
    # A duty cycle below 1 marks the flickering beacon
    steady = [lamp for lamp in day.lamps.values() if lamp.duty.si == 1.0]
    beacon = [lamp for lamp in day.lamps.values() if lamp.duty.si < 1.0]
    return IrradianceSeries(
        sun,
        sum((lamp_irradiance(lamp, times) for lamp in steady), nothing),
        sum((lamp_irradiance(lamp, times) for lamp in beacon), nothing),
        beacon[0].duty.si if beacon else 1.0,
        clear,
        mean,
        (
            day.sun.efficacy.si if day.sun else 1.0,
            steady[0].efficacy.si if steady else 1.0,
            beacon[0].efficacy.si if beacon else 1.0,
        ),
    )


def solar_elevation_sine(latitude: float, day: int, times: Array) -> Array:
    """Return the sine of the solar elevation at solar times since midnight [s]."""
    # Cooper's equation; `day` counts from 1 January
    declination = math.radians(23.45) * math.sin(2.0 * math.pi * (284 + day) / 365.0)
    # Hour angle, zero at solar noon
    hour = 2.0 * math.pi * (times / DAY - 0.5)
    up = math.sin(latitude) * math.sin(declination)
    return up + math.cos(latitude) * math.cos(declination) * np.cos(hour)


def clear_sky_irradiance(sun: SunModel, times: Array) -> Array:
    """Return the clear-sky irradiance of a horizontal surface behind the glass [W/m2]."""
    # The lower bound keeps the exponent finite below the horizon, where the result is set to 0
    sine = np.maximum(solar_elevation_sine(sun.latitude.si, sun.day, times), 1e-3)
    outside = 1098.0 * sine * np.exp(-0.057 / sine)
    return sun.through.si * np.where(sine > 1e-3, outside, 0.0)


def simulate_cloud_transmittance(clouds: CloudSequence, chance: Generator) -> Array:
    """Simulate the cloud transmittance of one day, one value per minute [1]."""
    low, high = clouds.cover.vector
    cover = float(chance.uniform(low, high))
    share = np.ones(MINUTES)
    if cover <= 0.0:
        return share
    # Mean lengths in minutes; the mean gap follows from the cover = length / (length + gap)
    length = clouds.length.si / MINUTE
    gap = length * (1.0 - cover) / cover
    low, high = clouds.through.vector
    # The day begins under a cloud with the probability of the cover
    at = 0.0 if chance.random() < cover else chance.exponential(gap)
    while at < MINUTES:
        end = at + chance.exponential(length)
        share[round(at) : round(end)] = chance.uniform(low, high)
        at = end + chance.exponential(gap)
    return share


def mean_cloud_transmittance(clouds: CloudSequence) -> float:
    """Return the mean transmittance of the clouds [1]."""
    # Cover and transmittance are drawn uniformly and independently: use the means of their ranges
    cover = sum(clouds.cover.vector) / 2.0
    return 1.0 - cover * (1.0 - sum(clouds.through.vector) / 2.0)


def lamp_irradiance(lamp: TimedLamp, times: Array) -> Array:
    """Return the irradiance of a lamp that is switched by a timer [W/m2]."""
    begin, end = lamp.hours.vector
    clock = times % DAY
    # A timer with begin > end burns over midnight
    on = (begin <= clock) & (clock < end) if begin <= end else (clock >= begin) | (clock < end)
    return np.where(on, lamp.light.si / lamp.efficacy.si, 0.0)

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
A flickering lamp with a wide beam: where it is, how bright, and when.

A Lambertian emitter, :math:`I = \frac{m+1}{2\pi} \Phi \cos^m\alpha` (Kahn and Barry, Wireless
infrared communications, Proc. IEEE 85, 1997, eq. 9). At the half-power angle :math:`\alpha_{1/2}`
it shines half as bright as ahead: :math:`m = -\ln 2 / \ln\cos\alpha_{1/2}` (eq. 10), 1 for 60
degrees.

A lamp is on for the first `duty` of each period and off for the rest: its wave is 1 or 0. Time is
in integer nanoseconds; the phase of the first of a set of times is computed in whole numbers, so
it neither drifts nor loses digits, however long the clock has run.

Its clock may have a constant offset and a drift. With the nominal frequency f, offset o and drift
d the wave's phase after t is f ((1 + o) t + d t^2 / 2). Around a time t0 that is a wave of the
frequency f (1 + o + d t0) whose phase at time zero is less by f d t0^2 / 2; the rest of d t^2,
some 1e-8 of a cycle in 0.1 s at 1 ppm/s, is neglected.
"""

from dataclasses import dataclass, replace
import math
from typing import final

from lta_config.errors import BadInput
from lta_config.schema.spectrum_file import PEAK_EFFICACY
import numpy as np
from numpy.typing import NDArray


def require(holds: bool, sentence: str) -> None:
    """Raise `BadInput` with the sentence unless the condition holds."""
    if not holds:
        raise BadInput(sentence)


def require_efficacy(efficacy: float) -> None:
    """Raise `BadInput` for an impossible luminous efficacy [lm/W]."""
    require(
        0.0 < efficacy <= PEAK_EFFICACY,
        f'The light has a luminous efficacy of {efficacy} lm/W; it must be above 0 and at '
        f'most {PEAK_EFFICACY:g} lm/W.',
    )


def require_lux(what: str, lux: float) -> None:
    """Raise `BadInput` for a negative or infinite illuminance [lx]."""
    require(
        math.isfinite(lux) and lux >= 0.0,
        f'{what} is {lux} lx; it must be 0 or more.',
    )


SECOND_NS = 1_000_000_000


def phase_in_cycles(
    times: NDArray[np.int64], frequency: float, phase: float = 0.0
) -> NDArray[np.float64]:
    """
    Return the position within the period, in [0, 1), at int64 times [ns], at least one [cycles].

    `phase` is the position at time zero. Only differences to the first time are multiplied in
    floating point: over a span of one second the error is some 1e-14 of the cycles in it.
    """
    top, bottom = frequency.as_integer_ratio()
    bottom *= SECOND_NS
    # Exact integer arithmetic, whatever the age of the clock
    start = (int(times[0]) * top % bottom) / bottom + phase
    position: NDArray[np.float64] = (start + (times - times[0]) * (frequency / SECOND_NS)) % 1.0
    # A tiny negative position is rounded up to one whole cycle by the modulo.
    position[position == 1.0] = 0.0
    return position


@final
@dataclass(frozen=True, slots=True)
class SquareWave:
    """A wave that is 1 for the first part of each period and 0 for the rest."""

    frequency: float  # positive [Hz]
    duty: float = 0.5  # share of the period that it is on, between 0 and 1, both excluded
    phase: float = 0.0  # position in the period at time zero [cycles]

    def __post_init__(self) -> None:
        """Refuse an invalid wave."""
        if not (math.isfinite(self.frequency) and self.frequency > 0.0):
            raise BadInput(
                f'The lamp flickers at {self.frequency} Hz; the frequency must be positive.'
            )
        if not 0.0 < self.duty < 1.0:
            raise BadInput(
                f'The lamp has a duty cycle of {self.duty}; the duty cycle must be between '
                '0 and 1.'
            )
        if not math.isfinite(self.phase):
            raise BadInput(
                f'The lamp has a phase of {self.phase} cycles; the phase must be finite.'
            )

    def phase_in_cycles(self, times: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the position in the period, in [0, 1), at times in ns, shape (n,)."""
        return phase_in_cycles(times, self.frequency, self.phase)

    def sample_filtered(
        self, times: NDArray[np.int64], time_constant: float
    ) -> NDArray[np.float64]:
        r"""
        Return the wave as a first-order low pass passes it on, long after its start.

        Parameters
        ----------
        times : ndarray of int64, shape (n,)
            Times. [ns]
        time_constant : float
            Time constant of the low pass, positive. [s]

        Returns
        -------
        ndarray of float64, shape (n,)
            Output of the low pass, in [0, 1].

        Notes
        -----
        Exact at any time constant, with edges between the samples. With periods :math:`x`, duty
        :math:`d` and :math:`k = 1/(f\tau)` the periodic solution of :math:`\tau y' = s - y` is

        .. math::
            y = 1 - \frac{1 - e^{-k(1-d)}}{1 - e^{-k}} e^{-kx} \ (x < d), \qquad
            y = \frac{1 - e^{-kd}}{1 - e^{-k}} e^{-k(x-d)} \ (x \ge d)

        """
        position = self.phase_in_cycles(times)
        rate = 1.0 / (self.frequency * time_constant)
        # expm1 keeps the digits for long time constants
        whole = -math.expm1(-rate)
        # Distance from 1 at the rising edge, and from 0 at the falling edge, in the periodic state
        missing = -math.expm1(-rate * (1.0 - self.duty)) / whole
        left = -math.expm1(-rate * self.duty) / whole
        on = position < self.duty
        # Since the last edge
        decay = np.exp(-rate * np.where(on, position, position - self.duty))
        return np.where(on, 1.0 - missing * decay, left * decay)


MAX_CLOCK_OFFSET = 0.01  # an error above one percent means a broken clock


@final
@dataclass(frozen=True, slots=True)
class DriftingClock:
    """Offset and drift of a clock."""

    offset: float = 0.0
    drift: float = 0.0

    def __post_init__(self) -> None:
        """Refuse an impossible clock error."""
        require(
            abs(self.offset) <= MAX_CLOCK_OFFSET,
            f'The clock of the lamp is off by {1e6 * self.offset:g} ppm; the offset must '
            f'be at most {1e6 * MAX_CLOCK_OFFSET:g} ppm.',
        )
        require(
            math.isfinite(self.drift),
            f"The drift of the lamp's clock is {self.drift}/s; it must be a finite number.",
        )

    def distort_wave(self, wave: SquareWave, time: int) -> SquareWave:
        """Return a wave as timed by this clock around a time [ns]."""
        if self.offset == 0.0 and self.drift == 0.0:
            return wave
        seconds = time / SECOND_NS
        return replace(
            wave,
            # Instantaneous frequency at that time
            frequency=wave.frequency * (1.0 + self.offset + self.drift * seconds),
            # Keeps the phase continuous at that time
            phase=wave.phase - 0.5 * wave.frequency * self.drift * seconds * seconds,
        )


EXACT_CLOCK = DriftingClock()
Array = NDArray[np.float64]
Vector = tuple[float, float, float]


def lambertian_order(half_power: float) -> float:
    """Return the Lambertian order of a lamp with a half-power angle [rad]."""
    # Rounded: 60 degrees are the order 1 exactly, which needs no power.
    return round(-math.log(2.0) / math.log(math.cos(half_power)), 12)


@final
@dataclass(frozen=True, slots=True)
class BeaconLamp:
    """A flickering lamp without optics."""

    # Centre of the emitting disc [m], and direction of the beam, of any length but zero [map]
    position: Vector
    axis: Vector
    flux: float  # luminous flux while on [lm]
    wave: SquareWave  # when it is on
    efficacy: float  # luminous flux by radiant flux [lm/W]
    order: float = 1.0  # Lambertian order: 1 for a half-power angle of 60 degrees
    radius: float = 0.015  # radius of the emitting disc, which bounds the light close by [m]
    # Time from 10 % to 90 % of its light at switching on, and back at switching off [s]
    rise: float = 0.0
    clock: DriftingClock = EXACT_CLOCK  # timing error of its flicker

    def __post_init__(self) -> None:
        """Refuse an impossible lamp."""
        numbers = (*self.position, *self.axis, self.flux, self.order, self.radius, self.rise)
        require(
            all(map(math.isfinite, numbers)),
            'A number of the lamp is infinite or NaN; correct it. Position, axis, luminous flux, '
            f'Lambertian order, radius and rise time are {numbers}.',
        )
        require(
            math.hypot(*self.axis) > 0.0,
            'The axis of the lamp is zero; give the direction in which the lamp faces.',
        )
        require(
            self.flux >= 0.0,
            f'The lamp has a luminous flux of {self.flux} lm; the flux must be 0 or more.',
        )
        require(
            self.order > 0.0,
            f'The lamp has the Lambertian order {self.order}; the order must be above 0.',
        )
        require(
            self.radius > 0.0,
            f'The lamp has a radius of {self.radius} m; the radius must be positive.',
        )
        # The lamp must reach full light within each phase of its period
        shortest = min(self.wave.duty, 1.0 - self.wave.duty) / self.wave.frequency
        require(
            0.0 <= self.rise <= shortest,
            f'The lamp takes {1e3 * self.rise:g} ms to reach full light but is on or off for '
            f'only {1e3 * shortest:g} ms of each flicker period; shorten its rise time or lower '
            'its frequency.',
        )
        require_efficacy(self.efficacy)

    @property
    def intensity(self) -> float:
        """Luminous intensity on the axis while on [cd]."""
        # Integrates to the flux over the half space
        return (self.order + 1.0) / (2.0 * math.pi) * self.flux

    @property
    def direction(self) -> Vector:
        """Return the unit axis [map]."""
        length = math.hypot(*self.axis)
        x, y, z = self.axis
        return x / length, y / length, z / length


def direct_illuminance(lamp: BeaconLamp, points: Array, normals: Array) -> Array:
    """
    Return the illuminance by the lamp alone while it is on, without reflections [lx].

    `points` [m] and unit `normals` of the planes are in `map`, shape (..., 3). The result is zero
    behind lamp and plane. The distance enters as d^2 + radius^2: exact on the axis of a Lambertian
    disc, and finite at the lamp.
    """
    ray = points - np.array(lamp.position)
    squared = np.einsum('...k,...k->...', ray, ray)
    # The tiny summand avoids 0 / 0 at the lamp itself
    distance = np.sqrt(squared) + np.finfo(np.float64).tiny
    leaving = np.maximum(ray @ np.array(lamp.direction) / distance, 0.0) ** lamp.order
    arriving = np.maximum(-np.einsum('...k,...k->...', ray, normals) / distance, 0.0)
    return np.asarray(lamp.intensity * leaving * arriving / (squared + lamp.radius**2))

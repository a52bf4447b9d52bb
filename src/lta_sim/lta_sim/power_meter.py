"""
INA219 power meter on a 0.1 ohm shunt: voltage and current of the cell or of the panel.

TI's data sheet: bus voltage in steps of 4 mV, shunt voltage in steps of 10 uV up to 320 mV,
typical errors of 0.2 % and, at the widest gain, 40 uV of shunt offset. The resolution of 10 uV
needs an average over 128 conversions in 68 ms, which fits a period of 100 ms. The data sheet
states no noise: half a step is assumed.
"""

from dataclasses import dataclass
from typing import final

from numpy.random import Generator


@final
@dataclass(frozen=True, slots=True)
class PowerMeterSettings:
    """Steps, limits and errors of the meter; errors are bounds of uniform distributions."""

    # Of voltage and current: one count, and standard deviation of the noise before rounding [V, A]
    voltage_step: float = 4e-3
    voltage_noise: float = 2e-3
    current_step: float = 1e-4
    current_noise: float = 5e-5
    current_range: float = 3.2  # largest current in either direction [A]
    scale: float = 0.002  # largest relative scale error of voltage and current [1]
    current_offset: float = 4e-4  # largest zero offset of the current [A]


@final
@dataclass(frozen=True, slots=True)
class PowerMeterErrors:
    """Errors that stay constant during a flight: two gains, and the current offset. [A]"""

    voltage_gain: float
    current_gain: float
    current_offset: float


def draw_errors(settings: PowerMeterSettings, rng: Generator) -> PowerMeterErrors:
    """Return the errors of one flight."""
    voltage, current, offset = rng.uniform(-1.0, 1.0, 3).tolist()
    return PowerMeterErrors(
        voltage_gain=1.0 + settings.scale * voltage,
        current_gain=1.0 + settings.scale * current,
        current_offset=settings.current_offset * offset,
    )


def measure_voltage_and_current(
    settings: PowerMeterSettings,
    errors: PowerMeterErrors,
    voltage: float,
    current: float,
    rng: Generator,
) -> tuple[float, float]:
    """
    Return one reading of a true voltage [V] and a signed current [A].

    The measured voltage is never below 0 and the current is clipped at the range.
    """
    x, y = rng.standard_normal(2).tolist()
    volts = errors.voltage_gain * voltage + settings.voltage_noise * x
    amperes = errors.current_gain * current + errors.current_offset + settings.current_noise * y
    limit = settings.current_range
    return (
        max(0.0, round(volts / settings.voltage_step) * settings.voltage_step),
        max(-limit, min(limit, round(amperes / settings.current_step) * settings.current_step)),
    )

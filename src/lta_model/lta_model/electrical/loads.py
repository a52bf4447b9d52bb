# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Power of the consumers: electronics and rotors.

The power of a turning rotor is affine in its thrust. That fits Bitcraze's bench table of four 7 mm
coreless motors with an rmse of 63 mW for all four.

By duty and voltage, a small brushed rotor under pulse-width modulation sees the mean voltage
v = duty x voltage, and

    thrust = A v^2 + B v,   power = offset + slope thrust,   current = power / voltage

with A and B fitted here to that table (`BENCH`: 47 mm propellers): residuals of 2.8 mN rms per
rotor, and 15 mW rms for power over thrust. Bitcraze's own polynomials in voltage
(platform_defaults_cf2.h) miss that table by 10 to 13 mN. A vehicle file's curve depends on duty
alone; with the effect `battery_sag` at 3.5 V it is 3.2 mN rms off the table, without it 2.9 mN.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, final, NamedTuple, Self

from lta_config.constants import STANDARD_GRAVITY
from lta_config.files import StrictModel
from lta_config.schema.vehicle_energy import EnergyBlock
from pydantic import Field

NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


@final
class LoadModel(StrictModel):
    """
    Power of each consumer.

    Attributes `idle`, `transmitting`: electronics without radio, and addition while the radio
    sends [W]. Attributes `rotor_offset`, `rotor_slope`: a turning rotor at vanishing thrust [W],
    and its power by thrust [W/N].
    """

    idle: NotNegative
    transmitting: NotNegative
    rotor_offset: NotNegative
    rotor_slope: NotNegative

    @classmethod
    def from_energy(cls, energy: EnergyBlock) -> Self:
        """Return the consumers of a vehicle file."""
        return cls(
            idle=energy.loads.idle.si,
            transmitting=energy.loads.transmitting.si,
            rotor_offset=energy.loads.rotor_idle.si,
            rotor_slope=energy.loads.rotor_power.si,
        )


def navigation_power(energy: EnergyBlock, strategy: str) -> float:
    """
    Return the power of sensing and computing for a navigation strategy, '' for none [W].

    Entries missing in the file count as 0. A strategy from a file ./mine.py is called `mine`.
    """
    powers = (energy.loads.sensing, energy.loads.computing.get(Path(strategy).stem))
    return sum(power.si for power in powers if power is not None) if strategy else 0.0


def rotor_power(thrust: float, offset: float, slope: float) -> float:
    """
    Return the electrical power of one rotor [W] at a thrust of either sign [N].

    At exactly 0 the rotor is off and takes nothing.
    """
    return offset + slope * abs(thrust) if thrust != 0.0 else 0.0


def power_demand(loads: LoadModel, thrusts: Sequence[float], transmitting: bool) -> float:
    """Return the power of the whole drone [W] at the thrust of each rotor [N]."""
    rotors, offset, slope = 0.0, loads.rotor_offset, loads.rotor_slope
    for thrust in thrusts:
        rotors += rotor_power(thrust, offset, slope)
    return loads.idle + (loads.transmitting if transmitting else 0.0) + rotors


THRUST_BY_SQUARE = 8.64139e-3  # N/V2, least squares over BENCH
THRUST_BY_VOLTAGE = 1.665601e-2  # N/V


@final
class RotorBenchPoint(NamedTuple):
    """One row of the bench: total current [A], lift of four rotors [g], voltage [V], duty."""

    current: float
    lift: float
    voltage: float
    duty: float

    @property
    def thrust(self) -> float:
        """Thrust of one rotor [N]."""
        # Gram-force of four rotors to newtons of one
        return self.lift * 1e-3 * STANDARD_GRAVITY / 4.0

    @property
    def power(self) -> float:
        """Total power, electronics of the Crazyflie included [W]."""
        return self.current * self.voltage


# Bitcraze, crazyflie-firmware, docs/functional-areas/pwm-to-thrust.md.
BENCH = tuple(
    RotorBenchPoint(*row)
    for row in (
        (0.24, 0.0, 4.01, 0.0),
        (0.37, 1.6, 3.98, 0.0625),
        (0.56, 4.8, 3.95, 0.125),
        (0.75, 7.9, 3.92, 0.1875),
        (0.94, 10.9, 3.88, 0.25),
        (1.15, 13.9, 3.84, 0.3125),
        (1.37, 17.3, 3.80, 0.375),
        (1.59, 21.0, 3.76, 0.4325),
        (1.83, 24.4, 3.71, 0.5),
        (2.11, 28.6, 3.67, 0.5625),
        (2.39, 32.8, 3.65, 0.625),
        (2.71, 37.3, 3.62, 0.6875),
        (3.06, 41.7, 3.56, 0.75),
        (3.46, 46.0, 3.48, 0.8125),
        (3.88, 51.9, 3.40, 0.875),
        (4.44, 57.9, 3.30, 0.9375),
    )
)


def thrust_at_duty(duty: float, voltage: float) -> float:
    """Return the thrust of one rotor at a duty cycle and a battery voltage [V] [N]."""
    mean = duty * voltage
    # The absolute value keeps the sign of the duty in the quadratic term
    return (THRUST_BY_SQUARE * abs(mean) + THRUST_BY_VOLTAGE) * mean


def power_at_duty(duty: float, voltage: float, offset: float, slope: float) -> float:
    """Return the electrical power of one rotor; offset and slope as in `loads.rotor_power` [W]."""
    return rotor_power(thrust_at_duty(duty, voltage), offset, slope)

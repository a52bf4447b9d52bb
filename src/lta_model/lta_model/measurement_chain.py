# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What stands between a true value and a reading: measurement effects, and rounding to counts.

The effects of a channel act on the true value in registry order; noise, quantisation and limits
of the sensor come after them. An effect at its null values is not called, so that a vehicle
without any reads the truth bit for bit.
"""

from collections.abc import Callable, Mapping

from lta_model.effects.protocol import CHANNEL_SIZES, Effect, MeasurementEffect, Values

Reading = Callable[[Values, Values, float], Values]
# The readings of a channel in their order, each with its parameters.
Chain = tuple[tuple[Reading, Values], ...]
# Adding and subtracting it rounds a number below 2^51 to an integer, halves to even
ROUNDING_OFFSET = 6755399441055744.0


def round_to_step(value: float, step: float) -> float:
    """Round to the nearest multiple of a step, halves to even; compiles."""
    return ((value / step + ROUNDING_OFFSET) - ROUNDING_OFFSET) * step


def build_chains(
    parameters: Mapping[str, Mapping[str, float]], effects: Mapping[str, Effect]
) -> dict[str, Chain]:
    """Return the effects of each channel."""
    out: dict[str, Chain] = dict.fromkeys(CHANNEL_SIZES, ())
    for name, effect in effects.items():
        if not isinstance(effect, MeasurementEffect):
            continue
        own = parameters.get(name, {})
        p = tuple(
            float(own.get(parameter.name, parameter.null)) for parameter in effect.parameters
        )
        # Effects at null are left out, so that the truth passes bit for bit
        if any(x != parameter.null for x, parameter in zip(p, effect.parameters, strict=True)):
            out[effect.channel] += ((effect.reading, p),)
    return out


def apply_chain(chain: Chain, values: Values, time: float) -> Values:
    """Return a reading after all effects of its channel, at a flight time [s]."""
    for reading, p in chain:
        values = reading(p, values, time)
    return values

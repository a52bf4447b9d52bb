"""
Define the finite-difference steps of the free parameters.

The differences are of rates, not of trajectories, so that rounding errors stay small.
"""

from typing import Final

from lta_model.effects.protocol import EffectParameter

STEP: Final = 1e-5  # of relative parameters
FINE: Final = 1e-4  # of the typical size of other parameters
# Larger steps for discontinuous effects, which small steps would miss.
STEPS: Final[dict[str, float]] = {
    'motor_deadband.threshold': 0.03,
    'command_delay.delay': 1e-3,
    'motor_lag': 1e-4,
    # Negative, towards a delay: held commands have another slope on the other side.
    'clock_offset.offset': -5e-6,
}
FINER: Final[dict[str, float]] = {**STEPS, 'motor_deadband.threshold': 0.004}


def fine_step(name: str, parameter: EffectParameter) -> float:
    """Return the finite-difference step away from 0, in the unit of the parameter."""
    usual = STEP if parameter.unit == '1' and parameter.null == 1.0 else FINE * parameter.spread
    return FINER.get(name, usual)


def first_step(name: str, parameter: EffectParameter) -> float:
    """Return the finite-difference step at 0, in the unit of the parameter."""
    return STEPS.get(name, fine_step(name, parameter))

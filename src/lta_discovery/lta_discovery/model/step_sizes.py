"""
How far a knob is turned to see what it does: the steps of its finite differences.

Rates are differenced, not trajectories: nothing is lost to rounding.
"""

from typing import Final

from lta_model.effects.protocol import EffectParameter

STEP: Final = 1e-5  # of what is a part of 1
FINE: Final = 1e-4  # of the typical size, else
# Where a finite difference that small would see too few of the jumps that it is about.
STEPS: Final[dict[str, float]] = {
    'motor_deadband.threshold': 0.03,
    'command_delay.delay': 1e-3,
    'motor_lag': 1e-4,
    # Towards the side on which a delay is: commands that are held have another slope on the other.
    'clock_offset.offset': -5e-6,
}
FINER: Final[dict[str, float]] = {**STEPS, 'motor_deadband.threshold': 0.004}


def fine_step(name: str, parameter: EffectParameter) -> float:
    """
    Return the step of a knob that stands away from 0.

    Parameters
    ----------
    name : str
        Of the knob.
    known : Parameter
        The parameter that it moves, or the first of them.

    Returns
    -------
    float
        In the unit of the parameter.

    """
    usual = STEP if parameter.unit == '1' and parameter.null == 1.0 else FINE * parameter.spread
    return FINER.get(name, usual)


def first_step(name: str, parameter: EffectParameter) -> float:
    """Return the step of a knob that stands at 0; parameters and unit as for `fine_step`."""
    return STEPS.get(name, fine_step(name, parameter))

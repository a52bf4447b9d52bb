"""
First-order lag of each motor, with separate time constants up and down.

    d/dt m = (u - m) / tau,   tau = `up` while |u| > |m| and u m >= 0, else `down`

u is the commanded duty, m (memory) the one at which the rotor turns; a reversing rotor brakes
first. With both time constants zero the rotor turns at u. 72 ms fits a 7 mm motor with a 45 mm
propeller (Eschmann, Albani and Loianno 2024, arXiv:2404.07837).
"""

from collections.abc import Mapping

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values

_SOURCE = 'Eschmann 2024: 72 ms for a 7 mm motor; spread: scatter of published motors'

SHARED = (
    EffectParameter('up', 's', 0.0, 1e-3, 10.0, 0.03, _SOURCE),
    EffectParameter('down', 's', 0.0, 1e-3, 10.0, 0.03, _SOURCE),
)


def compute_output(p: Values, memory: Values, duty: float, surroundings: Values) -> float:
    """Return the duty at which the rotor turns."""
    up, down = p
    # Without a lag the memory is not integrated and must not be used
    return duty if up + down == 0.0 else memory[0]


def compute_memory_rate(p: Values, memory: Values, duty: float, surroundings: Values) -> Values:
    """Return d/dt of the lagged duty."""
    up, down = p
    # Opposite signs: the rotor brakes first, with the time constant down
    tau = up if abs(duty) > abs(memory[0]) and duty * memory[0] >= 0.0 else down
    return ((duty - memory[0]) / tau if tau > 0.0 else 0.0,)


def find_conflict(values: Mapping[str, float]) -> str:
    """Return an objection to a lag in one direction only: its memory would jump."""
    if (values['up'] == 0.0) != (values['down'] == 0.0):
        return 'the time constants up and down must both be zero (no lag) or both be positive'
    return ''


EFFECT = ActuatorEffect(
    'motor_lag', SHARED, (), compute_output, (('duty', 0.0),), compute_memory_rate, find_conflict
)

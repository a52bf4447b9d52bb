# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Propagate small changes along a trajectory by the variational equation.

    d/dt x = F x + g

x is the change of position (map), attitude (rotation vector in the body), body velocity and body
rates. F and g are finite differences of the model's rates at the states of the trajectory. Because
rates, not trajectories, are differenced, parameters that can be scaled together without changing
the motion (thrust, mass, drag, inertia) cancel to rounding at every step. Differences of long
trajectories would leave spurious evidence.
"""

from typing import Final

from lta_discovery.model.quaternions import quaternion_exponential, quaternion_product
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STATE_WIDTH: Final = 12
NUDGE: Final = np.array([1e-4] * 3 + [1e-5] * 3 + [1e-5] * 3 + [1e-5] * 3)  # m, rad, m/s, rad/s


def apply_state_changes(states: Array, change: Array) -> Array:
    """Apply changes, shape (..., 12), to states, shape (..., 13)."""
    # Multiply from the right: the rotation vector is in the body frame
    turned = quaternion_product(states[..., 3:7], quaternion_exponential(change[..., 3:6]))
    return np.concatenate(
        [states[..., :3] + change[..., :3], turned, states[..., 7:13] + change[..., 6:12]],
        axis=-1,
    )


def integrate_dynamics(jacobian: Array, dt: float) -> Array:
    """Return B of x' = A x + B g over a step in which F and g are constant."""
    eye = np.eye(STATE_WIDTH)
    # Taylor series of the integral of exp(F t) in Horner form, of fourth order
    hf = dt * jacobian
    half = eye + hf / 4.0
    third = eye + (hf / 3.0) @ half
    b: Array = dt * (eye + (hf / 2.0) @ third)
    return b

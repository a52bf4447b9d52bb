"""
How a trajectory answers to small changes, by the variational equation along it.

    d/dt x = F x + g

x is the change of position (map), attitude (rotation vector in the body), body velocity and body
rates; F and g are finite differences of the model's own rates at the states of the trajectory.
The rates are differenced, not the trajectories: parameters that can be scaled together without
any change of motion (thrust, mass, drag, inertia) then cancel to rounding at every step, where
differences of long trajectories would leave what looks like evidence.
"""

from typing import Final

from lta_analysis.discovery.turning import exponential, product
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WIDTH: Final = 12
NUDGE: Final = np.array([1e-4] * 3 + [1e-5] * 3 + [1e-5] * 3 + [1e-5] * 3)  # m, rad, m/s, rad/s


def moved(states: Array, change: Array) -> Array:
    """Return states, shape (..., 13), after changes, shape (..., 12)."""
    turned = product(states[..., 3:7], exponential(change[..., 3:6]))
    return np.concatenate(
        [states[..., :3] + change[..., :3], turned, states[..., 7:13] + change[..., 6:12]],
        axis=-1,
    )


def nudged(states: Array, k: int) -> Array:
    """Return states after a small change of the kth of the twelve."""
    change = np.zeros(WIDTH)
    change[k] = NUDGE[k]
    return moved(states, np.broadcast_to(change, (*states.shape[:-1], WIDTH)))


def middles(states: Array) -> Array:
    """Return the states half way between neighbours, shape (S, n, 13) from (S, n + 1, 13)."""
    middle = 0.5 * (states[:, :-1] + states[:, 1:])
    middle[..., 3:7] /= np.linalg.norm(middle[..., 3:7], axis=-1, keepdims=True)
    return middle


def spread_rates(rates: Array) -> Array:
    """Return rates of position, velocity and body rates, (..., 9), as rates of a change."""
    out = np.zeros((*rates.shape[:-1], WIDTH))
    out[..., :3], out[..., 6:] = rates[..., :3], rates[..., 3:]
    return out


def turning_rows(jacobian: Array, rates: Array) -> None:
    """Write what attitude does: it follows the rates, in a frame that turns with them."""
    p, q, r = np.moveaxis(rates, -1, 0)
    zero = np.zeros_like(p)
    cross = np.array([[zero, -r, q], [r, zero, -p], [-q, p, zero]])
    jacobian[..., 3:6, :] = 0.0
    jacobian[..., 3:6, 3:6] = -np.moveaxis(cross, (0, 1), (-2, -1))
    jacobian[..., 3:6, 9:12] = np.eye(3)


def transitions(jacobian: Array, dt: float) -> tuple[Array, Array]:
    """Return A and B of x' = A x + B g over a step in which F and g are constant."""
    eye = np.eye(WIDTH)
    hf = dt * jacobian
    half = eye + hf / 4.0
    third = eye + (hf / 3.0) @ half
    b = dt * (eye + (hf / 2.0) @ third)
    return eye + jacobian @ b, b


def carried(a: Array, b: Array, begin: Array, inputs: Array, every: int) -> Array:
    """
    Return the changes at every so many steps.

    Parameters
    ----------
    a, b : ndarray, shape (S, n, 12, 12)
        Of `transitions`.
    begin : ndarray, shape (12, C) or (S, 12, C)
        At the beginning.
    inputs : ndarray, shape (S, n, 6, C)
        Accelerations.
    every : int
        Steps between what is returned; n is a multiple.

    Returns
    -------
    ndarray, shape (S, n // every + 1, 12, C)
        The changes.

    """
    pieces, steps = a.shape[:2]
    now = np.broadcast_to(begin, (pieces, *begin.shape[-2:])).copy()
    out = np.empty((pieces, steps // every + 1, *begin.shape[-2:]))
    out[:, 0] = now
    push = b[..., 6:]
    for k in range(steps):
        now = a[:, k] @ now + push[:, k] @ inputs[:, k]
        if (k + 1) % every == 0:
            out[:, (k + 1) // every] = now
    return out

"""
Fit linear and quadratic drag to the points of a sweep.

    F = D1 v + D2 v^2,   D1, D2 >= 0

The fit minimises the squared relative errors (non-negative least squares, Lawson and Hanson
1974), so that the slow points, at which a drone flies, count as much as the fast ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

from lta_config.errors import BadInput
import numpy as np
from scipy.optimize import nnls


@final
@dataclass(frozen=True, slots=True)
class DragFit:
    """Drag along or about one axis."""

    # N s/m and N s2/m2 along, N m s and N m s2 about an axis
    linear: float
    quadratic: float
    error: float  # largest relative error of the points [1]
    exponent: float  # exponent of a power law through the points; NaN for one point [1]

    def drag_at(self, speed: float) -> float:
        """Return the drag at a speed. [N or N m]."""
        return self.linear * speed + self.quadratic * speed**2


def fit_drag(speeds: Sequence[float], drags: Sequence[float]) -> DragFit:
    """
    Fit linear and quadratic drag to points of speed (m/s or rad/s) and drag (N or N m).

    Raise `BadInput` if a speed or a drag is not positive.
    """
    v, f = np.array(speeds, dtype=float), np.array(drags, dtype=float)
    if len(v) == 0 or len(v) != len(f) or not (np.all(v > 0.0) and np.all(f > 0.0)):
        raise BadInput(
            f'Cannot fit a drag curve to the drags {f.tolist()} at the speeds '
            f'{v.tolist()}: all must be positive. Inspect the flow at the speeds with zero '
            'or negative drag.'
        )
    # Divided by the drag, each row's target is 1: the errors are relative.
    matrix = np.column_stack((v / f, v**2 / f))
    if len(v) == 1:
        matrix[:, 0] = 0.0  # one point cannot determine two terms; use the quadratic one
    (linear, quadratic), _ = nnls(matrix, np.ones(len(v)))
    error = float(np.max(np.abs(matrix @ (linear, quadratic) - 1.0)))
    # Slope in logarithms: 1 for linear, 2 for quadratic drag
    exponent = float(np.polyfit(np.log(v), np.log(f), 1)[0]) if len(v) > 1 else float('nan')
    return DragFit(float(linear), float(quadratic), error, exponent)

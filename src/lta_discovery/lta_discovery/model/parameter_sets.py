"""The sets of parameters that the compiled replay goes between, knob by knob."""

from typing import final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class ParameterSteps(NamedTuple):
    """
    Knobs, each as two sets of parameters and the step between them.

    Attributes
    ----------
    rows, on : ndarray, shape (R, W) and (R, F)
        The sets: rows and flags of the body's kernel.
    faced : ndarray of int, shape (R,)
        Which of what there is to meet (Q of them) each set meets.
    commands, memory, wrench : ndarray, shape (Q, G, ...)
        As in `replay.Ready`, by grid period.
    before, after : ndarray of int, shape (K,)
        Which sets each knob goes between.
    steps : ndarray, shape (K,)
        How far.

    """

    rows: Array
    on: NDArray[np.uint8]
    faced: NDArray[np.int64]
    commands: Array
    memory: Array
    wrench: Array
    before: NDArray[np.int64]
    after: NDArray[np.int64]
    steps: Array

"""Store pairs of parameter sets for finite differences in the compiled replay."""

from typing import final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class ParameterSteps(NamedTuple):
    """
    Free parameters, each as two parameter sets and the step between them.

    Attributes
    ----------
    rows, on : ndarray, shape (R, W) and (R, F)
        Rows and flags of the body kernel for each set.
    faced : ndarray of int, shape (R,)
        Index of each set's inputs (Q of them).
    commands, memory, wrench : ndarray, shape (Q, G, ...)
        As in `replay.BodyInputs`, by grid period.
    before, after : ndarray of int, shape (K,)
        The two sets of each parameter.
    steps : ndarray, shape (K,)
        Their difference.

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

"""Store pairs of parameter sets for finite differences in the compiled replay."""

from typing import final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class ParameterSteps(NamedTuple):
    """Free parameters, each as two parameter sets and the step between them."""

    # Rows and flags of the body kernel for each set, shape (R, W)
    rows: Array
    on: NDArray[np.uint8]
    faced: NDArray[np.int64]  # index of each set's inputs (Q of them), shape (R,)
    # As in `replay.BodyInputs`, by grid period, shape (Q, G, ...)
    commands: Array
    memory: Array
    wrench: Array
    # The two sets of each parameter, shape (K,)
    before: NDArray[np.int64]
    after: NDArray[np.int64]
    steps: Array  # their difference, shape (K,)

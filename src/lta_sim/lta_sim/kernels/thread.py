# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
One vehicle of many: its constants are a row, all else is in tuples.

For batches of flights (`lta_flight.batch`), on the CPU and with one vehicle a thread on a GPU, by
numba-cuda and the packages in requirements-gpu.txt. Both use double precision; the GPU may fuse
multiplications and additions, so results differ from the CPU's in the last bits.
"""

from importlib import import_module
from types import ModuleType
from typing import final

from lta_config.errors import BadInput
from lta_sim.kernels.layout import EffectLayout, format_tuple, indent_lines, ModelStage, ROW_PARTS
import numpy as np

# Constant arrays of a vehicle, in the order of the row `fixed`, and those that are tuples
CONSTANTS = ('parameters', 'body', 'inverse')
# Few threads per block of a GPU: each holds a whole vehicle, and they share the registers
BLOCK_THREADS = 64

# The model, with the arithmetic of states that are tuples
THREAD_MODEL = '''
$INLINE
def ahead(state, rate, dt):
    """Return the state after dt at a constant rate."""
    return $ahead


$INLINE
def mean(a, b, c, d):
    """Return the mean rate of the classical Runge-Kutta step."""
    return $mean


$INLINE
def normalised(state):
    """Return the state with a quaternion of length one."""
    x, y, z, w = state[3:7]
    n = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    return state[0:3] + (x * n, y * n, z * n, w * n) + state[7:]


$INLINE
def rates(state, fixed, command, surroundings):
    """Return d/dt of the state."""
$bare
    return $rate
'''


@final
class ThreadAccess:
    """Access of a thread: constants are in the row `fixed`, all else has its own name."""

    loops = False

    def format_number(self, name: str, place: int, layout: EffectLayout, each: int = 0) -> str:
        """Return the source of one number; `each` is unused, because there are no loops."""
        del each
        return (
            f'fixed[{self._row_offset(name, layout) + place}]'
            if name in CONSTANTS
            else f'{name}[{place}]'
        )

    def format_all_numbers(self, name: str, layout: EffectLayout) -> str:
        """Return the source of all numbers of an array."""
        if name not in CONSTANTS:
            return name
        return format_tuple(self.format_number(name, k, layout) for k in range(ROW_PARTS[name]))

    def build_template_parts(
        self, parts: list[ModelStage], layout: EffectLayout
    ) -> dict[str, str]:
        """Return all stages in sequence, those of the thrusts, and the arithmetic of states."""
        size = range(layout.size)
        thrusts = [line for part in parts if part.actuates for line in part.lines]
        return {
            'ahead': format_tuple(f'state[{k}] + dt * rate[{k}]' for k in size),
            # Same order of operations as in the scalar kernel, so that results agree
            'mean': format_tuple(
                f'(a[{k}] + 2.0 * (b[{k}] + c[{k}]) + d[{k}]) / 6.0' for k in size
            ),
            'bare': indent_lines(line for stage in parts for line in stage.lines),
            'rate': layout.rate_source,
            'actuation': indent_lines(thrusts),
        }

    def _row_offset(self, name: str, layout: EffectLayout) -> int:
        counts = {'parameters': layout.parameters, **ROW_PARTS}
        return sum(counts[name_before] for name_before in CONSTANTS[: CONSTANTS.index(name)])


def require_cuda() -> ModuleType:
    """Return numba's CUDA target; raise BadInput if numba-cuda or a usable GPU is missing."""
    # numba-cuda 0.30 still uses a function that numpy 2.5 removed.
    vars(np).setdefault('row_stack', np.vstack)
    try:
        cuda = import_module('numba.cuda')
    except ImportError as error:
        raise BadInput(
            f'Cannot import numba-cuda ({error}); install the packages in '
            'requirements-gpu.txt, or simulate on the CPU.'
        ) from None
    if not cuda.is_available():
        raise BadInput(
            'numba-cuda finds no GPU; use a machine with an NVIDIA GPU, its driver and '
            'the packages in requirements-gpu.txt, or simulate on the CPU.'
        )
    return cuda

"""
Advance many vehicles on a GPU, one per thread, compiled with numba-cuda.

Needs an NVIDIA GPU and the packages in requirements-gpu.txt. Uses double precision; the GPU may
fuse multiplications and additions, so results differ from the CPU's in the last bits.
"""

from functools import cache
from importlib import import_module
from string import Template
from types import ModuleType

from lta_config.compilation.kernel_cache import load_kernel
from lta_config.errors import BadInput
from lta_model.effects import EFFECTS
from lta_sim.kernels.columns import ThreadAccess
from lta_sim.kernels.compose import KernelTarget, render_kernel_source
from lta_sim.kernels.vehicle_batch import pack_blocks, select_used_numbers, VehicleBatch
import numpy as np
from numpy.typing import ArrayLike, NDArray

# Few threads per block: each holds a whole vehicle, and they share the registers.
THREADS = 64

# The arithmetic of states that are tuples.
STATE_ARITHMETIC = '''
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
'''

GPU_ENTRIES = f'''{STATE_ARITHMETIC}

$INLINE
def rates(state, fixed, width, i):
    """Return d/dt of the state of vehicle i."""
$bare
    return $rate


$ENTRY
def advance_many(fixed, block, width, dt, steps):
    """Advance vehicle i, a column of the blocks, in thread i."""
    i = cuda.grid(1)
    if i < width:
        state = $state
        for _ in range(steps):
            a = rates(state, fixed, width, i)
            b = rates(ahead(state, a, 0.5 * dt), fixed, width, i)
            c = rates(ahead(state, b, 0.5 * dt), fixed, width, i)
            d = rates(ahead(state, c, dt), fixed, width, i)
            state = normalised(ahead(state, mean(a, b, c, d), dt))
$stores
'''

GPU_TARGET = KernelTarget(
    'from numba import cuda\n',
    '@cuda.jit(device=True)',
    '@cuda.jit',
    ThreadAccess('width'),
    Template(GPU_ENTRIES),
)


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


@cache
def _load_kernel(names: tuple[str, ...]) -> ModuleType:
    """Load the kernel of the given effects only, because registers are scarce."""
    return load_kernel(render_kernel_source({name: EFFECTS[name] for name in names}, GPU_TARGET))


def advance_many(
    states: ArrayLike,
    vehicles: VehicleBatch,
    commands: ArrayLike,
    surroundings: ArrayLike,
    dt: float,
    steps: int,
) -> NDArray[np.float64]:
    """
    Return the states after `steps` classical Runge-Kutta steps under constant commands.

    Parameters and shapes as for `batch.advance_many`.

    Raises
    ------
    BadInput
        If there is no GPU or no numba-cuda.
    ValueError
        If an array has the wrong shape.

    """
    cuda = require_cuda()
    used = select_used_numbers(states, vehicles, commands, surroundings)
    count = len(vehicles)
    # One block as wide as the batch
    fixed, there = (
        cuda.to_device(pack_blocks(parts, count).ravel()) for parts in (used.fixed, [used.state])
    )
    # Rounded up; surplus threads of the last block do nothing
    blocks = -(-count // THREADS)
    _load_kernel(used.names).advance_many[blocks, THREADS](
        fixed, there, count, float(dt), int(steps)
    )
    return used.merge_states(there.copy_to_host().reshape(-1, count).T)

"""
Advance many vehicles on the CPU, with SIMD instructions and on all cores.

Each state equals that of the scalar kernel to the last bit: the compiler may run the same
arithmetic for several vehicles at once, but may not reorder it.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import cache
from string import Template
from types import ModuleType

from lta_config.compilation.compiler import OWN
from lta_config.compilation.kernel_cache import load_kernel
from lta_config.machine import count_cores
from lta_model.effects import MODEL_EFFECTS
from lta_sim.kernels.columns import ColumnAccess
from lta_sim.kernels.compose import KernelTarget, render_kernel_source
from lta_sim.kernels.vehicle_batch import pack_columns, VehicleBatch
import numpy as np
from numpy.typing import ArrayLike, NDArray

ENTRIES = '''
# Block size such that the working numbers of a block stay in the L1 cache.
WIDTH = 16


$loops


$LOOP
def slopes(fixed, on, trial, rate, scratch):
    """Write d/dt of a block of states; what no vehicle has on is left out."""
$calls


$LOOP
def ahead(state, rate, dt, trial):
    """Write a block of states after dt at constant rates."""
    for k in range($size * WIDTH):
        trial[k] = state[k] + dt * rate[k]


$LOOP
def step(state, a, b, c, d, dt):
    """End a step of a block of states: the mean rate, then quaternions of length one."""
    for k in range($size * WIDTH):
        state[k] = state[k] + dt * ((a[k] + 2.0 * (b[k] + c[k]) + d[k]) / 6.0)
    for i in range(WIDTH):
        x, y = state[3 * WIDTH + i], state[4 * WIDTH + i]
        z, w = state[5 * WIDTH + i], state[6 * WIDTH + i]
        n = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
        state[3 * WIDTH + i], state[4 * WIDTH + i] = x * n, y * n
        state[5 * WIDTH + i], state[6 * WIDTH + i] = z * n, w * n


$ENTRY
def advance_blocks(fixed, on, states, dt, steps):
    """Advance blocks of WIDTH vehicles; a row of `fixed`, `on` and `states` is a block."""
    trial, scratch = np.empty($size * WIDTH), np.empty($scratch * WIDTH)
    stages = np.empty((4, $size * WIDTH))
    for block in range(states.shape[0]):
        state = states[block]
        stages[:] = 0.0  # memory of effects that are off stays as it is
        for _ in range(steps):
            trial[:] = state
            for stage in range(4):
                slopes(fixed[block], on[block], trial, stages[stage], scratch)
                h = dt if stage == 2 else 0.5 * dt
                ahead(state, stages[stage], h, trial)
            step(state, stages[0], stages[1], stages[2], stages[3], dt)
'''

FORM = KernelTarget(
    'from numba import njit\nimport numpy as np\n',
    f'@njit({OWN}, forceinline=True)',
    # No fastmath, which would reorder arithmetic; nogil lets the thread pool run in parallel
    "@njit(error_model='numpy', fastmath=False, nogil=True, cache=True)",
    ColumnAccess('WIDTH', 'trial'),
    Template(ENTRIES),
)


@cache
def _load_kernel() -> ModuleType:
    """Load the kernel with all effects."""
    return load_kernel(render_kernel_source(MODEL_EFFECTS, FORM))


def _pack_blocks(rows: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Split columns into blocks of vehicles; copies of the last vehicle fill the last block."""
    filled = np.pad(rows, ((0, 0), (0, -rows.shape[1] % width)), mode='edge')
    # Shape (blocks, numbers, width), each block contiguous
    blocks = filled.reshape(len(rows), -1, width).swapaxes(0, 1)
    return np.ascontiguousarray(blocks).reshape(len(blocks), -1)


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

    Parameters
    ----------
    states : array_like, shape (V, N)
        Layout of `lta_model.state`, SI.
    commands : array_like, shape (V, up to COMMAND)
        Duties and the position of the moving mass.
    surroundings : array_like, shape (V, up to SURROUNDINGS)
        Wind, noise, irradiance, voltage.
    dt : float
        Length of a step; below about 2.7 times the shortest time constant. [s]

    Returns
    -------
    ndarray, shape (V, N)
        New states, equal to those of `kernel.advance` to the last bit.

    Raises
    ------
    ValueError
        If an array has the wrong shape.

    """
    kernel = _load_kernel()
    fixed, state = pack_columns(states, vehicles, commands, surroundings)
    size, count = state.shape
    constants, moving = _pack_blocks(fixed, kernel.WIDTH), _pack_blocks(state, kernel.WIDTH)
    starts = np.arange(0, count, kernel.WIDTH)
    # An effect runs for a whole block if any of its vehicles has it on
    on = np.maximum.reduceat(vehicles.on, starts, axis=0)
    cores = count_cores()
    # More pieces than cores, so that a delayed core does not hold up the rest.
    pieces = min(len(moving), 4 * cores)
    with ThreadPoolExecutor(cores) as pool:
        done = pool.map(
            lambda part: kernel.advance_blocks(*part, float(dt), int(steps)),
            zip(*(np.array_split(part, pieces) for part in (constants, on, moving)), strict=True),
        )
        # Raises exceptions of the workers
        list(done)
    columns_now = moving.reshape(-1, size, kernel.WIDTH).swapaxes(0, 1).reshape(size, -1)
    # Drop the padding of the last block
    return np.ascontiguousarray(columns_now[:, :count].T)

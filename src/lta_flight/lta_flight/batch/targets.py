# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The targets of a batch flight, CPU and GPU, and its schedule."""

from dataclasses import dataclass
from string import Template
from typing import final

from lta_config.compilation.compiler import ENTRY_DECORATOR, INNER_DECORATOR
from lta_control import allocation
from lta_model.model import STEP_NS
from lta_sim.kernels.thread import THREAD_MODEL
from lta_vlc.reading_model import FIT_SCRATCH

SENSOR_STEP = STEP_NS * 1e-9  # integration step [s]
SCRATCH = max(allocation.DUTY_SCRATCH, FIT_SCRATCH)  # shared, since both are used in turn


@final
@dataclass(frozen=True, slots=True)
class BatchSchedule:
    """Schedule of a simulated flight."""

    # Integration steps per control period, and per sample of the range finder
    control: int
    range: int
    # Control periods per sample of the barometer, and per light block
    pressure: int
    light: int
    dt: float = SENSOR_STEP  # integration step [s]
    # Whether reflections are computed only after the drone has moved (`has_moved`)
    reuse_reflections: bool = False

    @property
    def period(self) -> float:
        """Control period [s]."""
        return self.dt * self.control

    @property
    def block_time(self) -> float:
        """Duration of a light block [s]."""
        return self.light * self.period

    @property
    def block_middle(self) -> int:
        """Control periods from the start of a light block to its middle."""
        return self.light // 2


@final
@dataclass(frozen=True, slots=True)
class CompileTarget:
    """A target."""

    imports: str  # import statements
    # Decorators of a function, and of one that is merged into its caller
    inline: str
    merge: str
    entry: str  # template of the entry


# The model of one vehicle, whose constants are a row
MODEL = Template(
    f'''{THREAD_MODEL}

$INLINE
def thrusts_of(state, fixed, command, surroundings):
    """Return the thrust of each rotor."""
$actuation
    return u
'''
)
CPU = CompileTarget(
    'from numba import njit\nimport numpy as np\n',
    INNER_DECORATOR,
    INNER_DECORATOR.replace('njit(', 'njit(forceinline=True, '),
    f'''
{ENTRY_DECORATOR.replace('cache=True', 'nogil=True, cache=True')}
def fly_some(fixed, constants, winds, spans, seeds, out):
    """Fly some vehicles, a row each."""
    work = $work(
        np.empty({SCRATCH}), np.empty(($rows, $diodes)), np.empty(($rows, $diodes)),
        np.empty($pencils),
    )
    for i in range(seeds.shape[0]):
        results = $fly(
            $constants, fixed[i], winds[spans[i, 0] : spans[i, 1]], seeds[i], work
        )
        for k in range(out.shape[1]):
            out[i, k] = results[k]
''',
)
GPU = CompileTarget(
    'from numba import cuda, float64\n',
    '@cuda.jit(device=True)',
    '@cuda.jit(device=True)',
    f'''
@cuda.jit
def fly_some(fixed, constants, winds, spans, seeds, out):
    """Fly vehicle i in thread i."""
    i = cuda.grid(1)
    if i < seeds.shape[0]:
        work = $work(
            cuda.local.array({SCRATCH}, float64),
            cuda.local.array(($rows, $diodes), float64),
            cuda.local.array(($rows, $diodes), float64),
            cuda.local.array($pencils, float64),
        )
        results = $fly(
            $constants, fixed[i], winds[spans[i, 0] : spans[i, 1]], seeds[i], work
        )
        for k in range(out.shape[1]):
            out[i, k] = results[k]
''',
)

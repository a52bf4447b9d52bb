# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly a batch of flights on all CPU cores or on a GPU."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from types import ModuleType
from typing import Any, Literal

from lta_config.compilation.flat import TupleLayout
from lta_config.compilation.kernel_cache import load_kernel
from lta_config.machine import count_cores
from lta_config.topics import load_topic_table
from lta_control.strategies.protocol import NavigationStrategy
from lta_flight.batch.batch_flight import BatchFlight, build_schedule
from lta_flight.batch.codegen import build_source
from lta_flight.batch.flight_loop import FIGURES
from lta_flight.batch.targets import CPU, GPU
from lta_sim.kernels.thread import BLOCK_THREADS, require_cuda
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Seeds = NDArray[np.int64]
Rows = NDArray[np.intp]
Device = Literal['cpu-batch', 'gpu']
FLIGHTS_PER_PIECE = 8  # flights per task of a thread; small, because their lengths differ


@cache
def _compile_kernel(
    names: tuple[str, ...],
    strategy: NavigationStrategy,
    layout: TupleLayout[Any],
    diodes: int,
    lamps: int,
    device: Device,
) -> ModuleType:
    """Return the compiled flight for some effects."""
    target = GPU if device == 'gpu' else CPU
    schedule = build_schedule(load_topic_table())
    source = build_source(names, strategy, layout, diodes, lamps, schedule, target)
    return load_kernel(source)


def fly_many(
    flights: Sequence[BatchFlight],
    seeds: Sequence[int],
    device: Device = 'cpu-batch',
    *,
    which: NDArray[np.intp] | None = None,
    on: NDArray[np.uint8] | None = None,
) -> Array:
    """
    Fly many vehicles, each to the end of its own flight.

    Parameters
    ----------
    seeds : sequence of int
        Random seed of each flight; the lower 32 bits are used.
    device : str
        'cpu-batch' for the CPU cores, 'gpu' for a GPU.
    which : ndarray of int, optional
        Index into `flights` for each seed; by default one after the other.
    on : ndarray of uint8, optional
        Flags of the effects that the kernel has in addition to those of `flights`, so that several
        calls share a kernel.

    Returns
    -------
    ndarray, shape (V, len(FIGURES))
        Results of each flight, in the order of `flight_loop.FIGURES`.

    Raises
    ------
    BadInput
        If there is no GPU or numba-cuda is not installed.

    """
    out = np.full((len(seeds), len(FIGURES)), np.nan)
    chosen = np.arange(len(seeds)) if which is None else which
    # The counter-based generator has 32-bit keys
    named = np.asarray(seeds, dtype=np.int64) & 0xFFFFFFFF
    # The union of the effects of all vehicles; those without an effect switch it off by its flag
    flags = [each.model.on for each in flights]
    on = np.maximum.reduce(flags if on is None else [*flags, on])
    names = tuple(name for name in SIM_LAYOUT.effects if on[SIM_LAYOUT.flag_index(name)])
    parameters, _ = SIM_LAYOUT.find_effect_indices(names)
    # Flights of equal form and strategy share a kernel
    # By its place, as two files may define strategies of one name
    strategies = list(dict.fromkeys(each.strategy for each in flights))
    forms = np.array([f'{strategies.index(each.strategy)} {each.form}' for each in flights])
    for form in dict.fromkeys(forms.tolist()):
        alike = np.flatnonzero(forms == form)
        inside = np.flatnonzero(np.isin(chosen, alike))
        # Row of each flight among those of its form
        rows = np.searchsorted(alike, chosen[inside])
        first = flights[int(alike[0])]
        kernel = _compile_kernel(
            names,
            first.strategy,
            TupleLayout(first.craft),
            len(first.craft.listening.planes),
            len(first.craft.listening.lamps),
            device,
        )
        models = [flights[k].model for k in alike.tolist()]
        fixed = np.array([[*m.parameters[parameters], *m.body, *m.inverse] for m in models])
        constants = np.array([flights[k].numbers for k in alike.tolist()])
        winds, spans = _stack_winds([flights[k] for k in alike.tolist()])
        arrays = fixed[rows], constants[rows], winds, spans[rows], named[inside]
        run = _fly_on_gpu if device == 'gpu' else _fly_on_cores
        out[inside] = run(kernel, *arrays)
    return out


def _stack_winds(flights: Sequence[BatchFlight]) -> tuple[Array, Rows]:
    """Return the recorded winds below each other, and first and last row of each flight."""
    # Most flights share their wind
    tables = {id(each.recorded): each.recorded for each in flights}
    ends = np.cumsum([len(table) for table in tables.values()]).tolist()
    places = {key: (end - len(tables[key]), end) for key, end in zip(tables, ends, strict=True)}
    # A GPU takes no empty array, hence the row of zeros
    winds = np.vstack([*tables.values(), np.zeros((1, 6))])
    return winds, np.array([places[id(each.recorded)] for each in flights])


def _fly_on_cores(
    kernel: ModuleType, fixed: Array, constants: Array, winds: Array, spans: Rows, seeds: Seeds
) -> Array:
    """Fly on all CPU cores; a thread takes a few flights at a time."""
    out = np.empty((len(seeds), len(FIGURES)))
    cores = count_cores()

    def fly_chunk(begin: int) -> None:
        part = slice(begin, begin + FLIGHTS_PER_PIECE)
        kernel.fly_some(fixed[part], constants[part], winds, spans[part], seeds[part], out[part])

    # Threads suffice, because the compiled flight releases the GIL
    with ThreadPoolExecutor(cores) as pool:
        list(pool.map(fly_chunk, range(0, len(seeds), FLIGHTS_PER_PIECE)))
    return out


def _fly_on_gpu(
    kernel: ModuleType, fixed: Array, constants: Array, winds: Array, spans: Rows, seeds: Seeds
) -> Array:
    """Fly on a GPU with one thread per vehicle."""
    cuda = require_cuda()
    there = [
        # Column-major, so that neighbouring threads read neighbouring numbers
        cuda.to_device(np.asfortranarray(part))
        for part in (fixed, constants, spans, np.empty((len(seeds), len(FIGURES))))
    ]
    # Number of blocks, rounded up, and threads per block
    kernel.fly_some[-(-len(seeds) // BLOCK_THREADS), BLOCK_THREADS](
        there[0], there[1], cuda.to_device(winds), there[2],
        cuda.to_device(np.ascontiguousarray(seeds)), there[3],
    )  # fmt: skip
    return np.ascontiguousarray(there[3].copy_to_host())

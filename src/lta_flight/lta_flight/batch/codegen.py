# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write the source of a whole flight: model, sensors, estimator, control, mission and battery.

`flight_loop.fly` is the flight; this module adds what depends on effects, diodes and target. CPU
and GPU use the same source; they differ in decorators and in how a thread finds its vehicle.
The kernel contains only the effects that some vehicle of the batch uses.
"""

from collections.abc import Sequence
from string import Template
from typing import Any

from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.flat import CORE_PREFIX, settings_to_tuples, TupleLayout
from lta_control.autopilot import begin_memory
from lta_control.laws import cascade
from lta_control.strategies.protocol import NavigationStrategy
from lta_flight.batch.control_period import (
    advance_vehicle,
    FlightKernel,
    sense_and_control,
    simulate_period,
    WorkArrays,
)
from lta_flight.batch.flight import amplitude_error
from lta_flight.batch.flight_loop import fly
from lta_flight.batch.targets import BatchSchedule, CompileTarget, MODEL
from lta_model.effects import EFFECTS, initial_memory
from lta_model.light.reflected_light import DAYLIGHT_ROW, LAMP_ROWS, scratch_size
from lta_model.state import RIGID
from lta_sim.compiled_sensors import draw_turbulence_memory
from lta_sim.kernels.compose import KernelTarget, render_kernel_source
from lta_sim.kernels.layout import format_tuple, indent_lines
from lta_sim.kernels.thread import ThreadAccess
from lta_sim.light_link import sample_magnitude
from lta_sim.simulated_vehicle import SIM_LAYOUT

# Merged into their caller, because passing the memory of a flight takes a quarter of the time
MERGED = {
    f'{CORE_PREFIX}_{function.__name__}'
    for function in (simulate_period, sense_and_control, advance_vehicle)
}


def build_kernel(names: Sequence[str], diodes: int) -> FlightKernel:
    """Return the kernel of some effects; its functions are those of `write_flight_source`."""
    return FlightKernel(
        dark=(0.0,) * diodes,
        begin=settings_to_tuples(begin_memory(cascade.CASCADE_LAW)),
        turbulence='turbulence' in names,
        superheat='superheat' in names,
    )


def build_source(
    names: Sequence[str],
    strategy: NavigationStrategy,
    constants: TupleLayout[Any],
    diodes: int,
    lamps: int,
    schedule: BatchSchedule,
    target: CompileTarget,
) -> str:
    """
    Return the source of a flight.

    Parameters
    ----------
    names : sequence of str
        Effects of the kernel, in registry order.
    constants : TupleLayout
        Of `batch_flight.FlightConstants`.
    diodes, lamps : int
        Number of diodes and of lamps.
    target : CompileTarget
        `CPU` or `GPU`.

    """
    kernel = build_kernel(names, diodes)
    extract = SourceExtract(
        kernel=kernel, strategy=strategy, schedule=schedule, law=cascade.CASCADE_LAW
    )
    name = extract.add_function(fly, CORE_PREFIX)
    entry = Template(target.entry).substitute(
        fly=name,
        work=extract.add_named_tuple(WorkArrays),
        diodes=diodes,
        rows=LAMP_ROWS + lamps,
        pencils=scratch_size(lamps),
        constants=constants.render_expression('constants[i]'),
    )
    return write_flight_source(names, extract, [constants], target, diodes, entry)


def write_flight_source(
    names: Sequence[str],
    extract: SourceExtract,
    layouts: Sequence[TupleLayout[Any]],
    target: CompileTarget,
    diodes: int,
    entry: str,
) -> str:
    """
    Return the source of a function that uses a `FlightKernel`, with that kernel and an entry.

    Parameters
    ----------
    names : sequence of str
        Effects of the kernel, in registry order.
    extract : SourceExtract
        With the function.
    layouts : sequence of TupleLayout
        The tuples that the entry builds from arrays.
    target : CompileTarget
        CPU or GPU.

    """
    generated = (_write_add_effects(names, extract), *_write_diode_functions(diodes, extract))
    for layout in layouts:
        layout.add_types(extract)
    form = KernelTarget(target.imports, target.inline, '', ThreadAccess(), MODEL)
    model = render_kernel_source({name: EFFECTS[name] for name in names}, form)
    functions = [f'{target.inline}\n{text}' for text in generated]
    cores = extract.render_pieces(target.inline, target.merge, MERGED)
    return '\n\n\n'.join((model, cores, *functions, entry))


def _write_add_effects(names: Sequence[str], extract: SourceExtract) -> str:
    """Return the source of `FlightKernel.add_effects`."""
    memories = [
        # Turbulence starts in its stationary state instead of at zero
        f'{extract.add_function(draw_turbulence_memory, CORE_PREFIX)}(seed)'
        if name == 'turbulence'
        else format_tuple(map(repr, initial_effect_memory(name)))
        for name in names
        if SIM_LAYOUT.memory_size(name)
    ]
    return f'def add_effects(state, seed):\n    return {" + ".join(["state", *memories])}'


def initial_effect_memory(name: str) -> tuple[float, ...]:
    """Return the initial memory of an effect."""
    first = SIM_LAYOUT.remembers[name]
    whole = (0.0,) * RIGID + initial_memory()
    return whole[first : first + SIM_LAYOUT.memory_size(name)]


def _write_diode_functions(diodes: int, extract: SourceExtract) -> tuple[str, str]:
    """Return the source of `FlightKernel.read_diodes` and `FlightKernel.daylight_of`."""
    sample = extract.add_function(sample_magnitude, CORE_PREFIX)
    error = extract.add_function(amplitude_error, CORE_PREFIX)
    lines = [
        # One scalar variable per diode, because GPU code has no dynamic arrays
        f'a_{k}, s_{k} = {sample}('
        f'link, lamp, {k}, lights, lights[{DAYLIGHT_ROW}, {k}] - before[{k}], seed, step)'
        for k in range(diodes)
    ]
    readings = (
        format_tuple(f'a_{k}' for k in range(diodes)),
        format_tuple(f's_{k}' for k in range(diodes)),
        format_tuple(f'{error}(a_{k}, s_{k})' for k in range(diodes)),
    )
    lines.append(f'return {", ".join(readings)}')
    daylight = format_tuple(f'lights[{DAYLIGHT_ROW}, {k}]' for k in range(diodes))
    return (
        f'def read_diodes(link, lamp, lights, before, seed, step):\n{indent_lines(lines)}',
        f'def daylight_of(lights):\n    return {daylight}',
    )

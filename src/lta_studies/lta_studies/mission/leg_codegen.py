"""
Write the source of one leg of a mission: `leg_state.fly_leg` with the kernel of a vehicle.

Unlike a flight of a batch, a leg starts from the state that the leg before left, and returns its
own state for the next.
"""

from collections.abc import Sequence
from typing import Any

from lta_config.compilation.compiler import ENTRY_DECORATOR
from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.flat import CORE_PREFIX, TupleLayout
from lta_config.errors import BadInput
from lta_control.laws import cascade
from lta_control.strategies.homing import HOMING_STRATEGY
from lta_flight.batch.codegen import build_kernel, write_flight_source
from lta_flight.batch.control_period import WorkArrays
from lta_flight.batch.targets import BatchSchedule, CPU, SCRATCH, SENSOR_STEP
from lta_model.light.reflected_light import LAMP_ROWS, scratch_size
from lta_studies.mission.leg_state import fly_leg

COARSE = 2  # steps of the full loop per step here; a Runge-Kutta step of 5 ms is as accurate


def coarse_schedule(schedule: BatchSchedule) -> BatchSchedule:
    """
    Return the schedule of a leg from that of a batch flight: longer steps.

    Raise `BadInput` if a period is not a whole number of these steps.
    """
    if schedule.control % COARSE or schedule.range % COARSE:
        raise BadInput(
            f'Missions are simulated in steps of {1e3 * COARSE * SENSOR_STEP:g} ms, so '
            'control_period and the period of the topic range must be whole multiples of that; '
            'change them in config/topics.yaml.'
        )
    return BatchSchedule(
        schedule.control // COARSE,
        schedule.range // COARSE,
        schedule.pressure,
        schedule.light,
        dt=COARSE * SENSOR_STEP,
        reuse_reflections=True,
    )


def generate_leg_source(
    names: Sequence[str],
    constants: TupleLayout[Any],
    leg: TupleLayout[Any],
    memory: TupleLayout[Any],
    diodes: int,
    schedule: BatchSchedule,
) -> str:
    """
    Return the source of a leg.

    Parameters
    ----------
    names : sequence of str
        Effects of the kernel, in registry order.
    constants, leg, memory : TupleLayout
        Layouts of `FlightConstants`, `LegPlan` and `LegState`.
    diodes : int
        Number of diodes in the ring.
    schedule : BatchSchedule
        Schedule of a batch flight.

    """
    kernel = build_kernel(names, diodes, closed=True)
    extract = SourceExtract(
        kernel=kernel,
        strategy=HOMING_STRATEGY,
        schedule=coarse_schedule(schedule),
        law=cascade.CASCADE_LAW,
    )
    name, work = extract.add_function(fly_leg, CORE_PREFIX), extract.add_named_tuple(WorkArrays)
    light = f'np.empty(({LAMP_ROWS + 1}, {diodes}))'
    lines = [
        ENTRY_DECORATOR.replace('cache=True', 'nogil=True, cache=True'),
        'def fly_leg(fixed, c, g, m, seed, track):',
        f'    work = {work}(np.empty({SCRATCH}), {light}, {light}, np.empty({scratch_size(1)}))',
        f'    constants = {constants.render_expression("c")}',
        f'    leg = {leg.render_expression("g")}',
        f'    before = {memory.render_expression("m")}',
        f'    after = {name}(constants, leg, before, fixed, np.empty((0, 6)), seed, work, track)',
        *(f'    m[{k}] = after.{path}' for k, path in enumerate(memory.paths)),
    ]
    return write_flight_source(
        names, extract, [constants, leg, memory], CPU, diodes, '\n'.join(lines)
    )

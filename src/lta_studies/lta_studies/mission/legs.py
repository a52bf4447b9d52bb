# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly legs: compile their source once and call it with arrays."""

from collections.abc import Sequence
from functools import cache
import math
from types import ModuleType
from typing import Any, final

from lta_config.compilation.compiler import ENTRY_DECORATOR
from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.flat import CORE_PREFIX, TupleLayout
from lta_config.compilation.kernel_cache import load_kernel
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_control.autopilot import begin_memory
from lta_control.laws import cascade
from lta_control.mission import Phase
from lta_control.strategies.homing import HOMING_STRATEGY
from lta_flight.batch.batch_flight import BatchFlight, build_schedule
from lta_flight.batch.codegen import build_kernel, initial_effect_memory, write_flight_source
from lta_flight.batch.control_period import begin_flight, WorkArrays
from lta_flight.batch.targets import BatchSchedule, CPU, SCRATCH, SENSOR_STEP
from lta_model.electrical.mppt_charger import PowerFlow, resting_flow
from lta_model.light.reflected_light import LAMP_ROWS, scratch_size
from lta_model.state import pack_state, RIGID
from lta_sim.compiled_sensors import draw_turbulence_memory
from lta_sim.kernels.layout import ROW_PARTS
from lta_sim.simulated_vehicle import SIM_LAYOUT
from lta_studies.mission.leg_state import fly_leg, ground_leg_state, LAND, LegPlan, LegState
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


NO_TRACK = np.empty((0, 8))


@cache
def _compile_leg(
    names: tuple[str, ...],
    constants: TupleLayout[Any],
    leg: TupleLayout[Any],
    memory: TupleLayout[Any],
    diodes: int,
) -> ModuleType:
    """Compile the leg for a set of effects."""
    return load_kernel(
        generate_leg_source(
            names, constants, leg, memory, diodes, build_schedule(load_topic_table())
        )
    )


@final
class LegPilot:
    """
    Flies the legs of one vehicle in one scene.

    Parameters
    ----------
    flight : BatchFlight
        Vehicle and scene, from `MissionScene`: not held, and without a reserve of its own.
    leg : LegPlan
        Any plan; only its layout is used.

    Attributes
    ----------
    period : float
        Control period. [s]

    """

    def __init__(self, flight: BatchFlight, leg: LegPlan) -> None:
        model = flight.model
        # Only the effects of this vehicle are compiled in; the source is cached by their names.
        self.names = tuple(n for n in SIM_LAYOUT.effects if model.on[SIM_LAYOUT.flag_index(n)])
        parameters, _ = SIM_LAYOUT.find_effect_indices(self.names)
        self._fixed = np.array([*model.parameters[parameters], *model.body, *model.inverse])
        self.period = build_schedule(load_topic_table()).period
        self._dark = (0.0,) * len(flight.craft.listening.planes)
        self._leg = TupleLayout(leg)
        # Any state: only its layout matters
        store = resting_flow(1.0)
        self._memory = TupleLayout(self.ground_state((0.0, 0.0, 0.0), 0.0, store, 1.0, 0))
        self._fly = _compile_leg(
            self.names, TupleLayout(flight.craft), self._leg, self._memory, len(self._dark)
        ).fly_leg

    def pack_constants(self, flight: BatchFlight) -> Array:
        """Return the constants of a flight with the same layout, shape (n,)."""
        return np.array(flight.numbers)

    def ground_state(
        self,
        place: tuple[float, float, float],
        heading: float,
        store: PowerFlow,
        charge: float,
        seed: int,
    ) -> LegState:
        """
        Return the state of a drone on the ground.

        Parameters
        ----------
        place : tuple of float
            Hull centre. [m, map]
        heading : float
            Heading. [rad]
        store : PowerFlow
            State of the power path.
        charge : float
            Charge estimate of the drone. [1]

        """
        state = tuple(pack_state(place, heading)[:RIGID].tolist())
        for name in self.names:
            state += (
                draw_turbulence_memory(seed)
                if name == 'turbulence'
                else initial_effect_memory(name)
            )
        # The first leg computes the command and the first range
        flight = begin_flight(
            HOMING_STRATEGY,
            begin_memory(cascade.CASCADE_LAW),
            state,
            (0.0,) * ROW_PARTS['command'],
            self._dark,
            store,
            math.nan,
        )
        return ground_leg_state(flight, charge)

    def fly_leg(
        self, constants: Array, leg: LegPlan, memory: LegState, seed: int, track: Array = NO_TRACK
    ) -> LegState:
        """
        Return the state after a leg.

        `constants`: from `pack_constants`. `memory`: state after the leg before, with the outcome
        reset to `FLYING`. `seed`: random seed of the flight; only 32 bits are used. `track`: see
        `leg_state.fly_leg`.
        """
        if leg.kind == LAND:
            mission = memory.flight.mission._replace(phase=Phase.LAND)
            memory = memory._replace(flight=memory.flight._replace(mission=mission))
        numbers = self._memory.write(memory)
        self._fly(self._fixed, constants, self._leg.write(leg), numbers, seed & 0xFFFFFFFF, track)
        return self._memory.read(numbers)


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
    kernel = build_kernel(names, diodes)
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

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Prepare the parameter sets of a linearization, and the inputs of the body kernel for each.

The vehicles of all parameter sets are built once (`LinearizationPoint`). What they meet in a
flight is computed for each flight.
"""

from collections.abc import Sequence
from typing import final, NamedTuple, Self

from lta_discovery.model.nominal import NominalVehicle, ReplayRows
from lta_discovery.model.parameters import apply_parameters, FreeParameter
from lta_discovery.replay.replay import BodyInputs, FlightReplay, ParameterSteps
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class BuiltVehicle(NamedTuple):
    """A vehicle and its rows."""

    nominal: NominalVehicle
    rows: ReplayRows


@final
class VehicleStep(NamedTuple):
    """A parameter: the vehicles before and after its step."""

    column: int  # of the parameter
    parameter: FreeParameter
    before: BuiltVehicle
    after: BuiltVehicle
    step: float


@final
class LinearizationPoint(NamedTuple):
    """A vehicle about which flights are linearized, and the steps of its parameters."""

    base: BuiltVehicle
    steps: tuple[VehicleStep, ...]
    column_count: int  # K, of the parameters, with and without a step
    strengths: Array  # of wrenches (`FlightSystem.with_terms`), shape (J,)

    @classmethod
    def build(
        cls,
        nominal: NominalVehicle,
        parameters: Sequence[FreeParameter],
        values: Array,
        columns: NDArray[np.bool_] | None = None,
    ) -> Self:
        """
        Return the point of some values; raise `BadInput` for an impossible vehicle.

        `values`: of the parameters and wrenches, relative to the vehicle, shape (K + J,).
        `columns`: parameters that are stepped, shape (K,). All by default.
        """
        strengths = values[len(parameters) :]
        nominal, values = apply_parameters(nominal, parameters, values[: len(parameters)])
        base = BuiltVehicle(nominal, nominal.build_replay_rows())
        steps = []
        for k, one in enumerate(parameters):
            if columns is not None and not columns[k]:
                continue
            present, step = one.enable_effect(nominal), one.step_at(float(values[k]))
            before, after = (
                base if each is nominal
                else BuiltVehicle(each, each.update_replay_rows(nominal, base.rows))
                for each in (present, one.apply_to(nominal, step))
            )  # fmt: skip
            steps.append(VehicleStep(k, one, before, after, step))
        return cls(base, tuple(steps), len(parameters), strengths)


@final
class SensorStep(NamedTuple):
    """A sensor parameter: the rows before and after its step, and the step."""

    column: int  # of the parameter
    before: ReplayRows
    after: ReplayRows
    step: float


@final
class LinearizationInputs(NamedTuple):
    """Inputs of a linearization about a point."""

    # Of the point itself
    rows: ReplayRows
    ready: BodyInputs
    turns: ParameterSteps  # of all parameters
    turned: tuple[SensorStep, ...]  # of the parameters that change only the readings


def prepare_linearization(replay: FlightReplay, point: LinearizationPoint) -> LinearizationInputs:
    """Prepare the linearization of a flight about a point."""
    # Parameter sets, of which the first is the point itself, and by what each is driven: several
    # sets share the same inputs
    sets = [replay.adapt_rows(*point.base)]
    inputs, faced = [replay.compute_body_inputs(sets[0])], [0]

    def add_set(parameter: FreeParameter, built: BuiltVehicle) -> int:
        """Add the set of a vehicle, and recompute only what its parameter affects."""
        if built is point.base:
            return 0
        rows = replay.adapt_rows(*built)
        sets.append(rows)
        if parameter.reaches == 'body':
            # Commands and memory do not depend on it
            faced.append(0)
            return len(sets) - 1
        if parameter.reaches == 'wrench':
            inputs.append(replay.update_wrench(rows, inputs[0]))
        else:
            # The slow actuator simulation is repeated only if thrusts change
            before = inputs[0] if parameter.reaches == 'memory' else None
            inputs.append(replay.compute_body_inputs(rows, before))
        faced.append(len(inputs) - 1)
        return len(sets) - 1

    turned = list[SensorStep]()
    pairs = [(0, 0, 1.0)] * point.column_count
    for one in point.steps:
        # Parameters of readings do not change the motion, and need no simulation.
        if one.parameter.reaches != 'reading' or replay.delays_commands(one.parameter):
            before, after = (add_set(one.parameter, each) for each in (one.before, one.after))
            pairs[one.column] = (before, after, one.step)
        else:
            is_same = one.before is point.base
            rows = sets[0] if is_same else replay.adapt_rows(*one.before)
            turned.append(SensorStep(one.column, rows, replay.adapt_rows(*one.after), one.step))
    # Sensitivities are computed per grid period, the trajectory per integrator step
    commands, memory, wrench = zip(*(one.average_periods() for one in inputs), strict=True)
    table = np.array(pairs, dtype=np.float64).reshape(-1, 3)
    turns = ParameterSteps(
        np.array([rows.body for rows in sets]),
        np.array([rows.body_on for rows in sets]),
        np.array(faced, dtype=np.int64),
        np.array(commands),
        np.array(memory),
        np.array(wrench),
        table[:, 0].astype(np.int64),
        table[:, 1].astype(np.int64),
        table[:, 2].copy(),
    )
    return LinearizationInputs(sets[0], inputs[0], turns, tuple(turned))

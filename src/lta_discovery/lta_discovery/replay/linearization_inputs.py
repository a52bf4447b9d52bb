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
        return cls(base, tuple(steps), strengths)


@final
class SensorStep(NamedTuple):
    """A sensor parameter: the rows before and after its step, and the step."""

    before: ReplayRows
    after: ReplayRows
    step: float


@final
class LinearizationInputs(NamedTuple):
    """Inputs of a linearization about a point."""

    # Of the point itself
    rows: ReplayRows
    ready: BodyInputs
    # Parameters that change the motion, and those that change only the readings
    moving: tuple[int, ...]
    reading: tuple[int, ...]
    turns: ParameterSteps  # of the former
    turned: tuple[SensorStep, ...]  # of the latter


@final
class _ParameterSets:
    """Parameter sets and their inputs; the first is the point itself."""

    def __init__(self, replay: FlightReplay, base: BuiltVehicle) -> None:
        self._replay = replay
        self.rows = [replay.adapt_rows(*base)]
        self.ready = [replay.compute_body_inputs(self.rows[0])]
        # Index of the inputs of each set; several sets share the same inputs
        self.faced = [0]

    def add_pair(self, base: BuiltVehicle, one: VehicleStep) -> tuple[int, int, float]:
        """Add the two sets of a parameter's step; return their indices and the step."""
        before = 0 if one.before is base else self._add_set(one.parameter, one.before)
        return before, self._add_set(one.parameter, one.after), one.step

    def _add_set(self, knob: FreeParameter, built: BuiltVehicle) -> int:
        """Add the set of a vehicle with a changed parameter."""
        rows = self._replay.adapt_rows(*built)
        self.faced.append(self._select_inputs(knob, rows))
        self.rows.append(rows)
        return len(self.rows) - 1

    def _select_inputs(self, knob: FreeParameter, rows: ReplayRows) -> int:
        """Return the index of a set's inputs, recomputing only what the parameter affects."""
        # Commands and memory do not depend on it
        if knob.reaches == 'body':
            return 0
        if knob.reaches == 'wrench':
            self.ready.append(self._replay.update_wrench(rows, self.ready[0]))
        else:
            # The slow actuator simulation is repeated only if thrusts change
            before = self.ready[0] if knob.reaches == 'memory' else None
            self.ready.append(self._replay.compute_body_inputs(rows, before))
        return len(self.ready) - 1

    def stack_parameter_sets(self, pairs: Sequence[tuple[int, int, float]]) -> ParameterSteps:
        """Return all sets as arrays."""
        before, after, steps = zip(*pairs, strict=True) if pairs else ((), (), ())
        # Sensitivities are computed per grid period, the trajectory per integrator step
        met_by = [ready.average_periods() for ready in self.ready]
        return ParameterSteps(
            np.array([rows.body for rows in self.rows]),
            np.array([rows.body_on for rows in self.rows]),
            np.array(self.faced, dtype=np.int64),
            np.array([means[0] for means in met_by]),
            np.array([means[1] for means in met_by]),
            np.array([means[2] for means in met_by]),
            np.array(before, dtype=np.int64),
            np.array(after, dtype=np.int64),
            np.array(steps, dtype=np.float64),
        )


def prepare_linearization(replay: FlightReplay, point: LinearizationPoint) -> LinearizationInputs:
    """Prepare the linearization of a flight about a point."""
    sets, pairs, turned = _ParameterSets(replay, point.base), [], []
    moving, reading = [], []
    base = sets.rows[0]
    for one in point.steps:
        # Parameters of readings do not change the motion, and need no simulation.
        if one.parameter.reaches != 'reading' or replay.delays_commands(one.parameter):
            moving.append(one.column)
            pairs.append(sets.add_pair(point.base, one))
            continue
        reading.append(one.column)
        before = base if one.before is point.base else replay.adapt_rows(*one.before)
        turned.append(SensorStep(before, replay.adapt_rows(*one.after), one.step))
    turns = sets.stack_parameter_sets(pairs)
    return LinearizationInputs(
        base, sets.ready[0], tuple(moving), tuple(reading), turns, tuple(turned)
    )

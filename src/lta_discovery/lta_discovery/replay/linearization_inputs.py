"""Prepare the parameter sets of a linearization, and the inputs of the body kernel for each."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_discovery.model.nominal import NominalVehicle, ReplayRows
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.replay import BodyInputs, FlightReplay, ParameterSteps
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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

    def __init__(self, replay: FlightReplay, nominal: NominalVehicle) -> None:
        self._replay, self._nominal = replay, nominal
        self.rows = [replay.build_replay_rows(nominal)]
        self.ready = [replay.compute_body_inputs(self.rows[0])]
        # Index of the inputs of each set; several sets share the same inputs
        self.faced = [0]

    def add_pair(self, knob: FreeParameter, value: float) -> tuple[int, int, float]:
        """Add the two sets of a parameter's step; return their indices and the step."""
        present, step = knob.enable_effect(self._nominal), knob.step_at(value)
        before = 0 if present is self._nominal else self._add_set(knob, present)
        return before, self._add_set(knob, knob.apply_to(self._nominal, step)), step

    def _add_set(self, knob: FreeParameter, nominal: NominalVehicle) -> int:
        """Add the set of a vehicle with a changed parameter."""
        rows = self._replay.update_replay_rows(nominal, self._nominal, self.rows[0])
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


def prepare_linearization(
    replay: FlightReplay,
    knobs: Sequence[FreeParameter],
    nominal: NominalVehicle,
    values: Array,
    columns: NDArray[np.bool_] | None = None,
) -> LinearizationInputs:
    """
    Prepare a linearization about a vehicle; raise BadInput for an impossible one.

    `values`: of the parameters in this vehicle, relative to that of the file, shape (K,).
    """
    sets, pairs, turned = _ParameterSets(replay, nominal), [], []
    moving, reading = [], []
    base = sets.rows[0]
    for k, knob in enumerate(knobs):
        if columns is not None and not columns[k]:
            continue
        value = float(values[k])
        # Parameters of readings do not change the motion, and need no simulation.
        if knob.reaches != 'reading' or replay.delays_commands(knob):
            moving.append(k)
            pairs.append(sets.add_pair(knob, value))
            continue
        reading.append(k)
        present, step = knob.enable_effect(nominal), knob.step_at(value)
        turned_by = knob.apply_to(nominal, step)
        after = replay.update_replay_rows(turned_by, nominal, base)
        same = present is nominal
        before = base if same else replay.update_replay_rows(present, nominal, base)
        turned.append(SensorStep(before, after, step))
    turns = sets.stack_parameter_sets(pairs)
    return LinearizationInputs(
        base, sets.ready[0], tuple(moving), tuple(reading), turns, tuple(turned)
    )

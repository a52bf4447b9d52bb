# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Linearize the model about the measured motion of a flight, one grid period at a time.

From the measured state at a grid point the model flies one period. How far it misses the next
measured state (the defect), and how the miss depends on state, unexplained wrench and parameters,
is all that a linear filter needs. Nothing diverges, however wrong the vehicle file is: errors do
not add up beyond a period, because the filter, not the linearization, carries them on.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import final

from lta_discovery.flights.measured_flight import ALL_CHANNELS, GRID_PERIOD, MeasuredFlight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_logarithm,
    quaternion_product,
)
from lta_discovery.model.replay_kernel import BODY_PLACES
from lta_discovery.replay.linearization_inputs import (
    LinearizationInputs,
    LinearizationPoint,
    prepare_linearization,
)
from lta_discovery.replay.replay import AXIS_COUNT, FlightReplay, STEPS_PER_PERIOD
from lta_discovery.replay.sensing import (
    apply_sensor_effects,
    estimate_floor_pressure,
    ideal_readings,
    pose_sensitivity,
    predict_pose,
    SensorPlaces,
    transform_to_map,
    transform_to_tracker,
)
from lta_discovery.replay.state_changes import (
    apply_state_changes,
    integrate_dynamics,
    NUDGE,
    reading_jacobians,
    STATE_WIDTH,
)
from lta_discovery.state_filter.motion import collect_readings, find_runs, fit_motion
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

POSE_SIZE = 6  # number of pose channels, the first of ALL_CHANNELS
MIDDLE = STEPS_PER_PERIOD // 2  # step of a period that begins in its middle
UNKNOWN_MOTION = np.array([0.0] * 6 + [1.0] + [0.0] * 6)  # state where the motion is not known


@final
@dataclass(frozen=True, slots=True)
class LinearFlight:
    """
    A flight as a linear system about its measured motion, of n grid points and K parameters.

    A change of state has twelve components: position in the map, rotation vector in the body, body
    velocity and rates. One period takes it to `step @ change + push @ wrench + moved @ parameters
    + defect`. Readings less those of the measured motion are `read @ change + felt @ wrench +
    read_moved @ parameters`, and noise.
    """

    motion: Array  # states of the body in the map, shape (n, 13)
    step: Array  # shape (n, 12, 12)
    push: Array  # per unit of the unexplained wrench, shape (n, 12, 6)
    moved: Array  # shape (n, 12, K)
    defect: Array  # shape (n, 12)
    left: Array  # measured less predicted readings; NaN where nothing was read, shape (n, m)
    read: Array  # shape (n, m, 12)
    felt: Array  # shape (n, m, 6)
    read_moved: Array  # shape (n, m, K)
    count: Array  # number of poses that a reading is the mean of, shape (n,)
    runs: Sequence[tuple[int, int]]  # first and end of the parts in which the motion is known
    # How the state that poses show at the beginning of each run depends on the frames of tracker
    # and markers, shape (R, 12, K); 0 until the motion is smoothed
    begun: Array
    nominal: NominalVehicle  # the vehicle of this point

    @property
    def is_finite(self) -> bool:
        """Whether the model could be linearized wherever the motion is known."""
        return all(
            bool(np.isfinite(part[begin : end - 1]).all())
            for begin, end in self.runs
            for part in (self.step, self.push, self.moved, self.defect)
        )

    def keep_columns(self, columns: Flags) -> 'LinearFlight':
        """Return the flight with some of its parameters, the others at their values."""
        return replace(
            self,
            moved=np.compress(columns, self.moved, axis=-1),
            read_moved=np.compress(columns, self.read_moved, axis=-1),
            begun=np.compress(columns, self.begun, axis=-1),
        )

    def add_wrenches(self, wrenches: Array, strengths: Array) -> 'LinearFlight':
        """
        Return the flight with columns of wrenches.

        `wrenches`: of strength 1 in each grid period, shape (n, 6, J) [N, N m]. `strengths`: about
        which to linearize, shape (J,).
        """
        if not wrenches.shape[2]:
            return self
        moved, read_moved = self.push @ wrenches, self.felt @ wrenches
        return replace(
            self,
            moved=np.concatenate([self.moved, moved], axis=2),
            read_moved=np.concatenate([self.read_moved, read_moved], axis=2),
            defect=self.defect + moved @ strengths,
            left=self.left - read_moved @ strengths,
            begun=np.pad(self.begun, ((0, 0), (0, 0), (0, wrenches.shape[2]))),
        )


@final
class FlightSystem:
    """
    A measured flight, ready to be linearized for any parameters.

    `with_future`: whether the measured motion at a point may use later poses. Forecasts must not.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        flight: MeasuredFlight,
        parameters: Sequence[FreeParameter],
        with_future: bool = True,
    ) -> None:
        self.flight, self.parameters, self.vehicle = flight, list(parameters), vehicle
        self._motion = fit_motion(flight, with_future)
        self.runs = find_runs(flight, self._motion)
        readings, self._count = collect_readings(flight, self._motion)
        self._position, self._quaternion = readings[:, :3], readings[:, 3:]
        count = len(flight.time) - 1
        every = np.arange(count)
        self.replay = FlightReplay(flight, every, 1, vehicle.pack_command(()))
        places = SensorPlaces.from_vehicle(vehicle, 0.0)
        self._places = SensorPlaces.from_vehicle(vehicle, estimate_floor_pressure(flight, places))
        self.channels = POSE_SIZE if flight.has_only_pose else len(ALL_CHANNELS)
        self._terms = np.zeros((len(flight.time), AXIS_COUNT, 0))
        self._wrench = np.zeros((len(flight.time), AXIS_COUNT))
        self._is_smooth = False
        inverse = NominalVehicle.from_vehicle(vehicle).build_model().inverse
        self._inverse = np.array(inverse).reshape(AXIS_COUNT, AXIS_COUNT)

    def with_parameters(self, parameters: Sequence[FreeParameter]) -> 'FlightSystem':
        """Return the flight with other assumptions about its parameters."""
        out = copy(self)
        out.parameters, out._terms = list(parameters), self._terms[..., :0]
        return out

    def with_terms(self, parameters: Sequence[FreeParameter], wrenches: Array) -> 'FlightSystem':
        """
        Return the flight with further parameters: the strengths of wrenches that act on it.

        `wrenches`: of strength 1 in each grid period, shape (n, 6, J). [N, N m]
        """
        out = copy(self)
        out.parameters = [*self._own_parameters, *parameters]
        out._terms = wrenches
        return out

    @property
    def _own_parameters(self) -> list[FreeParameter]:
        """Return the parameters of the vehicle: all but the strengths of wrenches."""
        return self.parameters[: len(self.parameters) - self._terms.shape[2]]

    def with_motion(self, motion: Array, wrench: Array, nominal: NominalVehicle) -> 'FlightSystem':
        """
        Return the flight with a better estimate of its motion, about which it is linearized.

        `motion`: of the body in the map, NaN where unknown, shape (n, 13). `wrench`: what acts
        beside the model, shape (n, 6) [N, N m]; without it the model would leave the motion in
        each period, and turn what should turn with the motion by another angle. `nominal`: the
        vehicle with which both were estimated.
        """
        out = copy(self)
        acting = self.replay.build_replay_rows(nominal).acting
        there = transform_to_tracker(motion, acting)
        better = np.isfinite(there).all(axis=1, keepdims=True)
        out._motion = np.where(better, there, self._motion)
        out._wrench = np.where(better, wrench, 0.0)
        out._is_smooth = True
        return out

    @property
    def wrench(self) -> Array:
        """Return what acts beside the linearized model, shape (n, 6) [N, N m]."""
        return self._wrench

    def linearize(
        self, nominal: NominalVehicle, values: Array, columns: Flags | None = None
    ) -> LinearFlight:
        """
        Linearize about parameters, relative to a vehicle, shape (K,).

        `columns`: parameters whose columns are computed; the others are 0. All by default. Raise
        `BadInput` for an impossible vehicle.
        """
        return self.linearize_about(self.build_point(nominal, values, columns))

    def build_point(
        self, nominal: NominalVehicle, values: Array, columns: Flags | None = None
    ) -> LinearizationPoint:
        """Return what a linearization needs that is the same for flights with these parameters."""
        return LinearizationPoint.build(nominal, self._own_parameters, values, columns)

    def linearize_about(self, point: LinearizationPoint) -> LinearFlight:
        """Linearize about a point (`build_point`)."""
        about = prepare_linearization(self.replay, point)
        column_count = len(self._own_parameters)
        acting = about.rows.acting
        motion_there = np.where(np.isfinite(self._motion), self._motion, UNKNOWN_MOTION)
        motion = transform_to_map(motion_there, acting)
        states, step, push, moved, defect = self._linearize_steps(motion, about)
        n, m = len(motion), self.channels
        left, read = np.full((n, m), np.nan), np.zeros((n, m, STATE_WIDTH))
        felt, read_moved = np.zeros((n, m, AXIS_COUNT)), np.zeros((n, m, column_count))
        first = motion_there[[begin for begin, _ in self.runs]]
        begun = np.zeros((len(self.runs), STATE_WIDTH, column_count))
        time = self.flight.time[None]
        # The last point needs a state after it only where a pose is shifted in time
        grid = np.concatenate([motion, motion[-1:]])[None]
        position, quaternion = predict_pose(grid, time, acting)
        left[:, :3] = self._position - position[0]
        left[:, 3:POSE_SIZE] = _rotation_between(quaternion[0], self._quaternion)
        eye = np.ascontiguousarray(
            np.broadcast_to(np.eye(STATE_WIDTH), (n, STATE_WIDTH, STATE_WIDTH))
        )
        read[:, :POSE_SIZE] = pose_sensitivity(eye, motion, acting)
        for turn in about.turned:
            # Most steps begin at the vehicle itself
            is_same = turn.before is about.rows
            before = (
                (position, quaternion) if is_same else predict_pose(grid, time, turn.before.acting)
            )
            after = predict_pose(grid, time, turn.after.acting)
            change = [(after[0] - before[0])[0], _rotation_between(before[1][0], after[1][0])]
            read_moved[:, :POSE_SIZE, turn.column] = np.concatenate(change, axis=1) / turn.step
            # From afar, a calibration finds better values where the first state does not turn
            if self._is_smooth:
                pair = (transform_to_map(first, rows.acting) for rows in (turn.before, turn.after))
                begun[..., turn.column] = _change_between(*pair) / turn.step
        if m > POSE_SIZE:
            parts = (left, read, felt, read_moved)
            self._linearize_sensors(states, about, parts, (step, push, moved))
        left[~self.flight.usable] = np.nan
        linear = LinearFlight(
            motion, step, push, moved, defect, left, read, felt, read_moved, self._count,
            self.runs, begun, point.base.nominal,
        )  # fmt: skip
        return linear.add_wrenches(self._terms, point.strengths)

    def _linearize_steps(
        self, motion: Array, about: LinearizationInputs
    ) -> tuple[Array, Array, Array, Array, Array]:
        """Return the states within each period, and its step, push, moved and defect."""
        n, replay = len(motion), self.replay
        # About a smoothed motion, unexplained wrenches are those on the vehicle of the file: on
        # one that is lighter in all respects, which moves alike, they must not be smaller. From
        # afar, a calibration finds better values where they are those on the vehicle itself.
        own = about.rows.body[BODY_PLACES['inverse']].reshape(AXIS_COUNT, AXIS_COUNT)
        inverse = self._inverse if self._is_smooth else own
        wrench = self._wrench[:-1, None] @ np.linalg.solve(own, inverse).T
        latent = np.repeat(wrench, replay.span, axis=1)
        begin = np.ascontiguousarray(motion[:-1])
        states = replay.integrate_pieces(about.rows, about.ready, begin, latent)
        end, middle = states[:, -1], np.ascontiguousarray(states[:, MIDDLE, None])
        jacobians = replay.state_jacobians(about.turns, middle, wrench)
        b = integrate_dynamics(jacobians, GRID_PERIOD)
        # Accelerations enter the last six components of a change only
        b = np.ascontiguousarray(b[:, 0, :, AXIS_COUNT:])
        # What the unexplained wrench does depends on no parameter
        answers = replay.parameter_sensitivities(about.turns, middle, np.zeros_like(wrench))[:, 0]
        step, push = (
            np.zeros((n, STATE_WIDTH, STATE_WIDTH)),
            np.zeros((n, STATE_WIDTH, AXIS_COUNT)),
        )
        moved = np.zeros((n, STATE_WIDTH, len(self._own_parameters)))
        defect = np.zeros((n, STATE_WIDTH))
        # Differences of whole periods: what turns or shifts all motion leaves no trace, which
        # rates in the middle of a period would leave
        for k, nudge in enumerate(np.diag(NUDGE)):
            if k < 3 and not jacobians[..., k].any():
                # Nothing depends on the place
                step[:-1, k, k] = 1.0
                continue
            near = apply_state_changes(begin, np.broadcast_to(nudge, (n - 1, STATE_WIDTH)))
            ends = replay.integrate_pieces(about.rows, about.ready, near, latent)[:, -1]
            step[:-1, :, k] = _change_between(end, ends) / NUDGE[k]
        push[:-1] = b @ inverse
        np.matmul(b, answers, out=moved[:-1])
        # The wrench is part of the state, and counts from 0
        defect[:-1] = _change_between(motion[1:], end) - _apply(push, self._wrench)[:-1]
        return states, step, push, moved, defect

    def _linearize_sensors(
        self,
        states: Array,
        about: LinearizationInputs,
        out: tuple[Array, Array, Array, Array],
        steps: tuple[Array, Array, Array],
    ) -> None:
        """
        Write the rows of inertial unit, range finder and barometer.

        A rate or force is a mean over the period, so that it depends on the state after it as
        well, which follows from the one before.
        """
        left, read, felt, read_moved = out
        step, push, moved = (each[:-1] for each in steps)
        # Each period as a piece of its own, from the measured state to the model's
        grid, time = states[:, :: 2 * MIDDLE], self.flight.time[:-1, None]
        acting, places = about.rows.acting, self._places
        exact = ideal_readings(grid[:, :1], states[:, MIDDLE, None], grid[:, 1:], places)
        base = apply_sensor_effects(exact, time, acting)[:, 0]
        left[:-1, POSE_SIZE:] = self.flight.readings[:-1] - base
        first, last = reading_jacobians(grid, exact, time, acting, places)
        first, last = first[:, 0], last[:, 0]
        # Range and pressure are of an instant
        last[:, 6:] = 0.0
        read[:-1, POSE_SIZE:] = first + last @ step
        felt[:-1, POSE_SIZE:] = last @ push
        left[:-1, POSE_SIZE:] += _apply(felt[:, POSE_SIZE:], self._wrench)[:-1]
        read_moved[:-1, POSE_SIZE:] = last @ moved
        for turn in about.turned:
            before, after = (
                apply_sensor_effects(exact, time, rows.acting)[:, 0]
                for rows in (turn.before, turn.after)
            )
            read_moved[:-1, POSE_SIZE:, turn.column] += (after - before) / turn.step
        absent = ~np.isfinite(self.flight.noise[POSE_SIZE:])
        left[:, POSE_SIZE:][:, absent] = np.nan


def _apply(matrices: Array, vectors: Array) -> Array:
    """Return the product of a matrix and a vector at each point."""
    product: Array = (matrices @ vectors[..., None])[..., 0]
    return product


def _change_between(first: Array, second: Array) -> Array:
    """Return the changes of state from some states to others, shape (..., 12)."""
    turn = _rotation_between(first[..., 3:7], second[..., 3:7])
    moved = second[..., :3] - first[..., :3]
    return np.concatenate([moved, turn, second[..., 7:] - first[..., 7:]], axis=-1)


def _rotation_between(first: Array, second: Array) -> Array:
    """Return the rotation vectors from some attitudes to others, in the axes of the first."""
    return quaternion_logarithm(quaternion_product(quaternion_conjugate(first), second))

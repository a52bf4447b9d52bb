# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Data of a simulated flight in the form that results and pages use, without a bag."""

from functools import cached_property
from typing import final, NamedTuple

from lta_config.compilation.flat import Array
from lta_control.autopilot import ESTIMATE_LAYOUT
from lta_data.scene import describe_exceeded_region, list_motion, RecordedScene
from lta_flight.closed_loop import ClosedLoop
from lta_flight.report.goal import FlightGoal
from lta_flight.report.view import half_block_time
from lta_model.state import POSITION, QUATERNION, RATES, VELOCITY
from lta_report.curves import (
    align_start,
    build_motion,
    DirectionCurve,
    ElectricalCurve,
    MotionCurve,
    PeakCurves,
    subtract_wind,
    TimeCurve,
    vector_directions,
)
import numpy as np
from numpy.typing import NDArray

# Topics that the data stand for: always, and once there is a light block
KEPT_TOPICS = {'ground_truth/odom', 'odom', 'battery'}
LIT = {'light/bearing', 'light/estimate', 'light/peaks', 'setpoint/pose', 'setpoint/velocity'}


class LoopLightBlock(NamedTuple):
    """Results of one light block, and the setpoint after it."""

    began: float  # [s]
    bearing: tuple[float, float]  # the paper's vector; (0, 0) for none
    lamp: tuple[float, float]  # estimated position [m, body]; (0, 0) for none
    snr: NDArray[np.float64]  # of each diode
    frequency: NDArray[np.float64]  # of each diode's peak [Hz]
    altitude: float  # [m]
    speed: float  # [m/s]


@final
class LoopView:
    """
    Record each step for the results, with what they need of `FlightView`.

    `loop`: the flight; `record_step` reads its newest step.
    """

    def __init__(self, loop: ClosedLoop) -> None:
        self._loop = loop
        world = loop.world
        self._start = world.stamp_ns
        self.scene = RecordedScene(world.scenario, world.vehicle.file)
        self._times: list[float] = []
        self._truth: list[tuple[float, ...]] = []
        self._winds: list[tuple[float, ...]] = []
        self._estimates: list[Array] = []
        self._light: list[LoopLightBlock] = []
        self._power: list[tuple[float, float, float]] = []

    def record_step(self) -> None:
        """Record the newest step; call it before the simulation advances."""
        loop, readings = self._loop, self._loop.readings
        time = (readings.stamp_ns - self._start) * 1e-9
        self._times.append(time)
        if readings.truth is not None:
            self._truth.append((time, *readings.truth))
        self._estimates.append(loop.autopilot.copy_estimate())
        if (
            readings.block is not None
            and loop.light is not None
            and loop.next_setpoint is not None
        ):
            bearing, lamp, setpoint = loop.light.bearing, loop.light.lamp, loop.next_setpoint
            block = LoopLightBlock(
                began=(readings.block[0] - self._start) * 1e-9,
                bearing=(0.0, 0.0) if bearing is None else (bearing.x, bearing.y),
                lamp=(0.0, 0.0) if lamp is None else (lamp.x, lamp.y),
                # As in the message, so that results equal those of a bag
                snr=loop.light.peaks.snr.astype(np.float32).astype(np.float64),
                frequency=loop.light.peaks.frequency,
                altitude=setpoint.altitude,
                speed=setpoint.speed,
            )
            self._light.append(block)
        if loop.energy is not None and readings.battery is not None:
            reading = loop.energy.reading
            self._power.append((time, reading.voltage, reading.current))
            self._winds.append((time, *loop.world.wind))

    def has_topics(self, *topics: str) -> bool:
        """Return whether all these topics have data."""
        return set(topics) <= (KEPT_TOPICS | LIT if self._light else KEPT_TOPICS)

    @property
    def span(self) -> tuple[float, float]:
        """First and last time [s]."""
        return self._times[0], self._times[-1]

    @cached_property
    def goal(self) -> FlightGoal:
        """Return the target lamps, and when each was reached."""
        return FlightGoal(self.scene.scenario, self.truth, self._loop.policy.strategy.name)

    @cached_property
    def truth(self) -> MotionCurve:
        """Return the true motion, with the speed relative to the air."""
        # Columns: time, then the values
        table, wind = np.array(self._truth), np.array(self._winds)
        time, state = table[:, 0], table[:, 1:]
        motion = build_motion(
            time, state[:, POSITION], state[:, QUATERNION], state[:, VELOCITY][:, 0]
        )
        return subtract_wind(motion, wind[:, 0], wind[:, 1:])

    @property
    def true_positions(self) -> Array:
        """Return the times and true positions, shape (n, 4) [s, m]."""
        return np.array(self._truth)[:, :4]

    @property
    def true_poses(self) -> Array:
        """Return the times, true positions and attitudes x y z w, shape (n, 8) [s, m]."""
        table = np.array(self._truth)
        state = table[:, 1:]
        return np.column_stack([table[:, 0], state[:, POSITION], state[:, QUATERNION]])

    @property
    def warning(self) -> str:
        """Return a warning if the flight leaves its vehicle file's region of validity, else ''."""
        state = np.array(self._truth)[:, 1:]
        motion = list_motion(state[:, QUATERNION], state[:, VELOCITY], state[:, RATES])
        vehicle = self.scene.vehicle
        return '' if vehicle is None else describe_exceeded_region(vehicle, motion)

    @cached_property
    def estimate(self) -> MotionCurve:
        """Return the estimated motion, aligned with the truth at the start."""
        estimates, time = ESTIMATE_LAYOUT.view(np.array(self._estimates)), np.array(self._times)
        # The estimator keeps x, y and the altitude separately
        place = np.column_stack([estimates['position'], estimates['altitude']['height']])
        surge = estimates['airspeed']['surge']
        return align_start(build_motion(time, place, estimates['attitude'], surge), self.truth)

    @property
    def altitude_setpoint(self) -> TimeCurve:
        """Altitude to hold [m]."""
        return TimeCurve(self._block_starts, np.array([block.altitude for block in self._light]))

    @property
    def speed_setpoint(self) -> TimeCurve:
        """Forward airspeed to hold [m/s]."""
        return TimeCurve(self._block_starts, np.array([block.speed for block in self._light]))

    @cached_property
    def peaks(self) -> PeakCurves:
        """SNR and frequency of each diode's peak, at the middle of each block."""
        names = ('snr', 'frequency')
        fields = {
            name: np.array([getattr(block, name) for block in self._light]) for name in names
        }
        return PeakCurves(self._block_middles, fields)

    @cached_property
    def sighting(self) -> DirectionCurve:
        """Direction to the lamp by the fit, at the middle of each block."""
        return DirectionCurve(
            self._block_middles, vector_directions(np.array([block.lamp for block in self._light]))
        )

    @cached_property
    def bearing(self) -> DirectionCurve:
        """Return the paper's bearing of the lamp, at the middle of each block."""
        return DirectionCurve(
            self._block_middles,
            vector_directions(np.array([block.bearing for block in self._light])),
        )

    @property
    def _block_starts(self) -> NDArray[np.float64]:
        return np.array([block.began for block in self._light])

    @property
    def _block_middles(self) -> NDArray[np.float64]:
        return self._block_starts + half_block_time()

    @cached_property
    def battery(self) -> ElectricalCurve:
        """Return the battery as measured."""
        time, voltage, current = np.array(self._power).T
        return ElectricalCurve(time, voltage, current)

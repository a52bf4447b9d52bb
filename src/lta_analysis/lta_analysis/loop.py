"""
The closed loop in one process, without ROS: the same cores in the same order as the graph.

Used for tuning and for tests that need many flights. As in lockstep, the estimator sees the duties
of the step before, and the controller a setpoint one control period after its light block ended.
Numbers that a message would round are rounded alike (`lta_control.wire`).
"""

from dataclasses import dataclass, field
import math
from typing import final

from lta_config.topics import TopicTable
from lta_control.autopilot import Autopilot, drone_of
from lta_control.cascade import CascadeGains, Measured, Setpoint
from lta_control.control import TILT_LIMIT
from lta_control.estimator import Estimate, EstimatorSettings
from lta_control.mission import Mission, mission_step, MissionSettings
from lta_control.strategies.protocol import Sight, Strategy
from lta_control.wire import as_setpoint, single
from lta_sim.readings import Outcome, Readings
from lta_sim.world import World
from lta_vlc.array import bearing, even_ring
from lta_vlc.demodulation import demodulate, Demodulation, plan_bins
from lta_vlc.lamp import bearing_through, LampPrior
import numpy as np
from numpy.typing import NDArray


@final
@dataclass(frozen=True, slots=True)
class Policy:
    """Everything that can be chosen about what the drone decides."""

    strategy: Strategy
    gains: CascadeGains
    estimator: EstimatorSettings = field(default_factory=EstimatorSettings)
    mission: MissionSettings = field(default_factory=MissionSettings)
    demodulation: Demodulation = field(default_factory=Demodulation)
    prior: LampPrior = field(default_factory=LampPrior)
    tilt_limit: float = TILT_LIMIT  # [rad]


@final
class Loop:
    """
    One flight, step by step.

    Parameters
    ----------
    world : World
        The drone and its scene.
    table : TopicTable
        Periods and block shape.
    policy : Policy
        What the drone decides by.

    """

    def __init__(self, world: World, table: TopicTable, policy: Policy) -> None:
        self.world = world
        self._policy = policy
        self._block = table['photodiodes'].period_ns * 1e-9
        self._half_block = table['photodiodes'].period_ns // table.control_ns // 2
        vehicle = world.vehicle
        dt = table.control_ns * 1e-9
        self.autopilot = Autopilot(
            drone_of(vehicle, policy.estimator, policy.gains, dt, policy.tilt_limit)
        )
        self._ring = even_ring(vehicle.diodes.count)
        self._bins = plan_bins(
            policy.demodulation, table.light.sample_rate.si, table.light.samples
        )
        self.duties = self.autopilot.duties
        self.setpoint: Setpoint | None = None
        self.mission = Mission()
        self._headings: list[float] = []
        self._pending: Setpoint | None = None

    @property
    def estimate(self) -> Estimate:
        """All that the estimator remembers."""
        return self.autopilot.estimate

    def measured(self) -> Measured | None:
        """Return what the controller acts on; None while the estimator is learning."""
        return self.autopilot.measured

    def step(self) -> Outcome:
        """Sense, decide and fly one control period; return how the flight stands."""
        readings = self.world.sense()
        if self._pending is not None:
            self.setpoint, self._pending = self._pending, None
            self.autopilot.guide(self.setpoint)
        self._decide(readings)
        if readings.block is not None:
            self._pending = self._navigate(readings.block[1])
        self.world.advance(self.duties)
        return self.world.outcome

    def _decide(self, readings: Readings) -> None:
        self.duties = self.autopilot.step(
            readings.rates,
            readings.force,
            single(readings.ranges[-1][1]) if readings.ranges else math.nan,
            math.nan if readings.pressure is None else readings.pressure,
        )
        self._headings.append(self.autopilot.heading)

    def _navigate(self, block: NDArray[np.uint16]) -> Setpoint:
        """Return what the light of a block asks for, as the controller gets it."""
        peaks = demodulate(block, self._bins)
        found = bearing(peaks, self._ring, self._policy.demodulation.threshold)
        sight = Sight(
            seen=found is not None,
            bearing=0.0 if found is None else bearing_through(found.angle, self._policy.prior),
            heading=self._headings[-1 - self._half_block],
            amplitudes=tuple(peaks.amplitude.astype(np.float32).tolist()),
            interval=self._block,
        )
        measured = self.measured()
        setpoint, self.mission = mission_step(
            self._policy.mission,
            self._policy.strategy,
            self.mission,
            sight,
            None if measured is None else measured.altitude,
            False,
        )
        return as_setpoint(setpoint)

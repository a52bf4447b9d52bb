"""
The closed loop in one process, without ROS: the same cores in the same order as the graph.

Used for tuning and for tests that need many flights. As in lockstep, the estimator sees the duties
of the step before, and the controller a setpoint one control period after its light block ended.
"""

from dataclasses import dataclass, field
import math
from typing import final

from lta_config.topics import TopicTable
from lta_control.attitude import heading
from lta_control.cascade import CascadeGains, Measured, Setpoint
from lta_control.control import control_step, ControlMemory, landed
from lta_control.estimator import Estimate, estimator_step, EstimatorSettings, Inputs
from lta_control.mission import Mission, mission_step, MissionSettings
from lta_control.strategies.protocol import Sight, Strategy
from lta_control.vehicle_side import body_of, rotors_of, surge_drag_of
from lta_sim.readings import Outcome, Readings
from lta_sim.world import World
from lta_vlc.array import bearing, even_ring
from lta_vlc.demodulation import demodulate, Demodulation, plan_bins
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
        self._dt = table.control_ns * 1e-9
        self._block = table['photodiodes'].period_ns * 1e-9
        self._half_block = table['photodiodes'].period_ns // table.control_ns // 2
        vehicle = world.vehicle
        self._drag = surge_drag_of(vehicle)
        self._body = body_of(vehicle)
        self._rotors = rotors_of(vehicle)
        self._ring = even_ring(vehicle.diodes.count)
        self._bins = plan_bins(
            policy.demodulation, table.light.sample_rate.si, table.light.samples
        )
        self.estimate = Estimate()
        self.duties = self.estimate.duties
        self.setpoint: Setpoint | None = None
        self.mission = Mission()
        self._memory = ControlMemory()
        self._headings: list[float] = []
        self._pending: Setpoint | None = None

    def step(self) -> Outcome:
        """Sense, decide and fly one control period; return how the flight stands."""
        readings = self.world.sense()
        self._estimate(readings)
        self.setpoint = self._pending or self.setpoint
        if readings.block is not None:
            self._pending = self._navigate(readings.block[1])
        self._control()
        self.world.advance(self.duties)
        return self.world.outcome

    def _estimate(self, readings: Readings) -> None:
        inputs = Inputs(
            rates=readings.rates,
            force=readings.force,
            range=readings.ranges[-1][1] if readings.ranges else math.nan,
            pressure=math.nan if readings.pressure is None else readings.pressure,
            duties=self.duties,
        )
        self.estimate = estimator_step(
            self._policy.estimator, self._body, self.estimate, inputs, self._dt
        )
        self._headings.append(heading(self.estimate.attitude))

    def measured(self) -> Measured | None:
        """Return what the controller acts on; None while the estimator is learning."""
        estimate = self.estimate
        if not estimate.ready:
            return None
        return Measured(
            altitude=estimate.altitude.height,
            climb=estimate.altitude.climb,
            heading=self._headings[-1],
            yaw_rate=estimate.rates[2],
            speed=estimate.airspeed.surge,
            sway=estimate.airspeed.sway,
        )

    def _navigate(self, block: NDArray[np.uint16]) -> Setpoint:
        peaks = demodulate(block, self._bins)
        found = bearing(peaks, self._ring, self._policy.demodulation.threshold)
        sight = Sight(
            seen=found is not None,
            bearing=0.0 if found is None else found.angle,
            heading=self._headings[-1 - self._half_block],
            amplitudes=tuple(peaks.amplitude.tolist()),
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
        return setpoint

    def _control(self) -> None:
        measured = self.measured()
        if measured is None or self.setpoint is None:
            return
        if landed(measured, self.setpoint, self._body.standing_height):
            self.duties, self._memory = (0.0, 0.0, 0.0, 0.0), ControlMemory()
            return
        self.duties, self._memory = control_step(
            self._policy.gains,
            self._rotors,
            self._drag,
            self._memory,
            measured,
            self.setpoint,
            self._dt,
        )

"""
The closed loop in one process, without ROS: the same cores in the same order as the graph.

As in lockstep, the estimator sees the duties of the step before, the controller a setpoint one
control period after its light block ended, and the navigator the energy of the turn before. What
the graph sends as a message goes through what the message makes of it (`lta_control.carried`), so
that both fly the same flight to the last bit.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
import math
from typing import final

from lta_config.topics import TopicTable
from lta_control import carried
from lta_control.attitude import heading, up_in_body
from lta_control.cascade import CascadeGains, Measured, Setpoint
from lta_control.control import control_step, ControlMemory, landed
from lta_control.estimator import Estimate, estimator_step, EstimatorSettings, Inputs
from lta_control.mission import Mission, mission_step, MissionSettings
from lta_control.strategies.protocol import Sight, Strategy
from lta_control.vehicle_side import body_of, rotors_of, surge_drag_of
from lta_energy import monitor
from lta_sim.readings import Outcome, Readings
from lta_sim.vehicle import Vehicle
from lta_sim.world import World
from lta_vlc.array import Bearing, bearing, even_ring
from lta_vlc.demodulation import demodulate, Demodulation, Peaks, plan_bins
from lta_vlc.lamp import lamp_estimate, LampEstimate, LampPrior
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
    energy: monitor.MonitorSettings = field(default_factory=monitor.MonitorSettings)
    tilt_limit: float = 1.0  # beyond it the motors stop [rad]


@final
@dataclass(frozen=True, slots=True)
class Light:
    """What one light block says; None where no lamp is heard."""

    peaks: Peaks
    bearing: Bearing | None
    lamp: LampEstimate | None


@final
@dataclass(frozen=True, slots=True)
class Energy:
    """What the meters have said, and what is known since."""

    reading: monitor.Reading
    estimate: monitor.Estimate


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
    known : Vehicle or None
        The vehicle as the drone knows it; by default the true one in standard air, as the nodes
        read it from its file.

    Attributes
    ----------
    readings, estimate, duties : Readings, Estimate, tuple of float
        What was sensed, believed and done at the newest step.
    light, asked : Light, Setpoint
        What the newest light block said, and what the navigator made of it; None before it.
    setpoint : Setpoint or None
        What the controller acts on.
    energy : Energy or None
        The newest turn of the meters.

    """

    def __init__(
        self, world: World, table: TopicTable, policy: Policy, known: Vehicle | None = None
    ) -> None:
        self.world = world
        self.policy = policy
        self._table = table
        self._dt = table.control_ns * 1e-9
        self._block = table['photodiodes'].period_ns * 1e-9
        self._half_block = table['photodiodes'].period_ns // table.control_ns // 2
        vehicle = known or Vehicle(world.vehicle.file)
        self._drag = surge_drag_of(vehicle)
        self._body = body_of(vehicle)
        self._rotors = rotors_of(vehicle)
        self._cell = vehicle.battery
        self._ring = even_ring(vehicle.diodes.count)
        self._bins = plan_bins(
            policy.demodulation, table.light.sample_rate.si, table.light.samples
        )
        ranger = world.range_settings
        self._reach = carried.single(ranger.minimum), carried.single(ranger.maximum)
        self.readings = Readings(world.stamp_ns)
        self.estimate = Estimate()
        self.duties = self.estimate.duties
        self.light: Light | None = None
        self.asked: Setpoint | None = None
        self.setpoint: Setpoint | None = None
        self.energy: Energy | None = None
        self.mission = Mission()
        self._memory = ControlMemory()
        self._stopped = False
        self._headings: list[float] = []

    def step(self) -> Outcome:
        """Sense, decide and fly one control period; return how the flight stands."""
        self.decide()
        self.world.advance(self.duties)
        return self.world.outcome

    def flight(self) -> Iterator[Outcome]:
        """Fly to where the graph would end; each step is yielded decided, before it is flown."""
        while True:
            self.decide()
            yield self.world.outcome
            over = self.world.outcome is not Outcome.FLYING
            if over and self._table.settled(self.world.stamp_ns):
                return
            self.world.advance(self.duties)

    def decide(self) -> None:
        """Sense and decide, without flying on."""
        readings = self.readings = self.world.sense()
        self._estimate(readings)
        self.setpoint = self.asked or self.setpoint
        if readings.block is not None:
            self._navigate(readings.block[1])
        if readings.battery is not None:
            self._count(readings)
        self._control()

    def _estimate(self, readings: Readings) -> None:
        inputs = Inputs(
            rates=readings.rates,
            force=readings.force,
            range=self._distance(readings),
            pressure=math.nan if readings.pressure is None else readings.pressure,
            duties=self.duties,
        )
        if all(map(math.isfinite, (*inputs.rates, *inputs.force))):
            self.estimate = estimator_step(
                self.policy.estimator, self._body, self.estimate, inputs, self._dt
            )
        self._headings.append(heading(self.estimate.attitude))

    def _distance(self, readings: Readings) -> float:
        """Return the newest range as its message carries it, NaN where there is none. [m]"""
        if not readings.ranges:
            return math.nan
        return carried.reach(carried.single(readings.ranges[-1][1]), *self._reach)

    def measured(self) -> Measured | None:
        """Return what the controller acts on; None while the estimator is learning."""
        estimate = self.estimate
        if not estimate.ready:
            return None
        return carried.measured(
            estimate.attitude,
            estimate.altitude.height,
            carried.velocity(estimate),
            estimate.rates[2],
        )

    def _navigate(self, block: NDArray[np.uint16]) -> None:
        peaks = demodulate(block, self._bins)
        found = bearing(peaks, self._ring, self.policy.demodulation.threshold)
        lamp = None if found is None else lamp_estimate(found, self.policy.prior)
        self.light = Light(peaks, found, lamp)
        sight = Sight(
            seen=lamp is not None,
            bearing=0.0 if lamp is None else math.atan2(lamp.position[1], lamp.position[0]),
            heading=self._headings[-1 - self._half_block],
            amplitudes=tuple(peaks.amplitude.astype(np.float32).tolist()),
            interval=self._block,
        )
        measured = self.measured()
        energy = self.energy
        self.asked, self.mission = mission_step(
            self.policy.mission,
            self.policy.strategy,
            self.mission,
            sight,
            None if measured is None or energy is None else measured.altitude,
            energy is not None and energy.estimate.reserve,
        )

    def _count(self, readings: Readings) -> None:
        """Keep the energy books of one turn of the meters."""
        nothing = math.nan, math.nan
        voltage, current = map(carried.single, readings.battery or nothing)
        panel_voltage, panel_current = map(carried.single, readings.panel or nothing)
        lux = readings.illuminance
        reading = monitor.Reading(
            stamp_ns=readings.stamp_ns,
            voltage=voltage,
            current=current,
            harvest=panel_voltage * panel_current,
            illuminance=math.nan if lux is None else lux,
        )
        before = monitor.Estimate() if self.energy is None else self.energy.estimate
        self.energy = Energy(
            reading, monitor.update(self.policy.energy, self._cell, before, reading)
        )

    def _control(self) -> None:
        measured = self.measured()
        asked = self.setpoint
        if measured is None or self._turned_over(measured) or asked is None:
            self._off()
            return
        setpoint = carried.setpoint(asked.altitude, carried.level(asked.heading), asked.speed)
        self._stopped = not all(map(math.isfinite, (*measured, *setpoint)))
        if self._stopped or landed(measured, setpoint, self._body.standing_height):
            self._off()
            return
        self.duties, self._memory = control_step(
            self.policy.gains,
            self._rotors,
            self._drag,
            self._memory,
            measured,
            setpoint,
            self._dt,
        )

    def _turned_over(self, measured: Measured) -> bool:
        """Tell whether the drone has turned over, for good."""
        upright = up_in_body(self.estimate.attitude)[2] >= math.cos(self.policy.tilt_limit)
        self._stopped = self._stopped or (not upright and all(map(math.isfinite, measured)))
        return self._stopped

    def _off(self) -> None:
        """Stop the motors, and forget what the loops had wound up."""
        self.duties, self._memory = (0.0, 0.0, 0.0, 0.0), ControlMemory()

"""
The closed loop in one process, without ROS: the same cores in the same order as the graph.

As in lockstep, the estimator sees the duties of the step before, the controller a setpoint one
control period after its light block ended, and the navigator the energy of the turn before. What
the graph sends as a message goes through what the message makes of it (`lta_control.carried`), so
that both fly the same flight to the last bit.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
import math
from typing import final

from lta_config.compilation.compiled import compiled
from lta_config.topics import TopicTable
from lta_control import carried
from lta_control.cascade import Measured, Setpoint
from lta_control.estimator import Estimate
from lta_control.mission import course_step, mission_step
from lta_control.phases import Mission
from lta_control.pilot import Pilot
from lta_control.reserve import Order, order_of, Word
from lta_control.sighting import Lamp, Reckoned, sighted
from lta_energy.monitoring.aboard import Aboard
from lta_energy.monitoring.estimate import Estimate as Known
from lta_energy.monitoring.monitor import update
from lta_energy.monitoring.reading import Reading, Whereabouts
from lta_flight.policy import autopilot_of, Policy
from lta_model.ring import Ring
from lta_model.vehicle import Vehicle
from lta_sim.readings import Outcome, Readings
from lta_sim.world import World
from lta_vlc.array import Bearing, bearing
from lta_vlc.demodulation import Hearing, Peaks
from lta_vlc.diodes import diodes_of
from lta_vlc.direction import Direction, DirectionFinder
from lta_vlc.fit import fit
from lta_vlc.lamp import lamp_estimate, LampEstimate
from lta_vlc.listener import Listener
from lta_vlc.wish import NO_WISH
import numpy as np
from numpy.typing import NDArray


@final
@dataclass(frozen=True, slots=True)
class Light:
    """
    What one light block says.

    Parameters
    ----------
    hearing : Hearing
        What each diode sees of each beacon.
    bearing : Bearing or None
        The paper's, None where no diode is believed or the ring is evenly lit.
    direction : Direction or None
        The fit's, None where there is none.
    lamp : LampEstimate or None
        What the drone steers by: the lamp in the body frame, by the fit.

    """

    hearing: Hearing
    bearing: Bearing | None
    direction: Direction | None
    lamp: LampEstimate | None

    @property
    def peaks(self) -> Peaks:
        """What the diodes see of the lamp that is wanted."""
        return self.hearing.peaks[0]


@final
@dataclass(frozen=True, slots=True)
class Energy:
    """What the meters have said, and what is known since."""

    reading: Reading
    estimate: Known


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
    beacon : float
        Frequency that the navigator wants heard next; 0 for the demodulator's own. [Hz]
    energy : Energy or None
        The newest turn of the meters.

    """

    def __init__(
        self, world: World, table: TopicTable, policy: Policy, known: Vehicle | None = None
    ) -> None:
        self.world = world
        self.policy = policy
        self._table = table
        self._plan = world.scenario.course
        self._reversible = world.vehicle.reversible
        self._block = table['photodiodes'].period_ns * 1e-9
        self._half_block = table['photodiodes'].period_ns // table.control_ns // 2
        vehicle = known or Vehicle(world.vehicle.file)
        dt = table.control_ns * 1e-9
        self.autopilot = autopilot_of(policy, vehicle, dt)
        self._aboard = Aboard.of(vehicle.file.energy)
        diodes = diodes_of(vehicle.file.sensors.diodes)
        self._ring = diodes.ring
        self._finder = DirectionFinder(diodes, compiled(fit)[0], np.array)
        self._axes = carried_axes(self._ring)
        self._listener = Listener(
            policy.demodulation,
            table.light.sample_rate.si,
            table.light.samples,
            vehicle.file.sensors.diodes.top,
        )
        ranger = world.range_settings
        self._reach = carried.single(ranger.minimum), carried.single(ranger.maximum)
        self.readings = Readings(world.stamp_ns)
        self.duties = self.autopilot.duties
        self.light: Light | None = None
        self.asked: Setpoint | None = None
        self.setpoint: Setpoint | None = None
        self.beacon = NO_WISH
        self.energy: Energy | None = None
        self.mission = Mission()
        self._reckoned: deque[Reckoned] = deque(maxlen=self._half_block + 1)

    @property
    def estimate(self) -> Estimate:
        """What the drone believes at the newest step."""
        return self.autopilot.estimate

    def step(self) -> Outcome:
        """Sense, decide and fly one control period; return how the flight stands."""
        self.decide()
        self.act()
        return self.world.outcome

    def flight(self) -> Iterator[Outcome]:
        """Fly to where the graph would end; each step is yielded decided, before it is flown."""
        while True:
            self.decide()
            yield self.world.outcome
            over = self.world.outcome is not Outcome.FLYING
            if over and self._table.settled(self.world.stamp_ns):
                return
            self.act()

    def act(self) -> None:
        """Fly one control period by the newest command."""
        pilot = self.autopilot
        place = pilot.command.mass_place if isinstance(pilot, Pilot) else None
        self.world.advance(self.duties, place)

    def decide(self) -> None:
        """Sense and decide, without flying on."""
        readings = self.readings = self.world.sense()
        course = self.policy.course
        if course is not None:
            self.asked = self.setpoint = asked = course(self.world.elapsed)
            self.autopilot.guide(asked)
        elif self.asked is not self.setpoint and self.asked is not None:
            self.setpoint = asked = self.asked
            level = carried.level(asked.heading)
            self.autopilot.guide(carried.setpoint(asked.altitude, level, asked.speed))
        self._fly(readings)
        if readings.block is not None and course is None:
            self._navigate(*readings.block)
        if readings.battery is not None:
            self._count(readings)

    def _fly(self, readings: Readings) -> None:
        """Estimate and control."""
        if isinstance(self.autopilot, Pilot) and readings.truth is not None:
            self.autopilot.see(readings.truth)
        self.duties = self.autopilot.step(
            readings.rates,
            readings.force,
            self._distance(readings),
            math.nan if readings.pressure is None else readings.pressure,
        )
        if self._plan is not None:
            self.duties = self._plan.shaken(self.world.elapsed, self.duties, self._reversible)
            self.autopilot.instead(self.duties)
        self._reckoned.append(self.autopilot.reckoned)

    def _distance(self, readings: Readings) -> float:
        """Return the newest range as its message carries it, NaN where there is none. [m]"""
        if not readings.ranges:
            return math.nan
        return carried.reach(carried.single(readings.ranges[-1][1]), *self._reach)

    def measured(self) -> Measured | None:
        """Return what the controller acts on; None while the estimator is learning."""
        return self.autopilot.measured

    def _navigate(self, stamp_ns: int, block: NDArray[np.uint16]) -> None:
        """Look at the light, and steer by it or by the scenario's course."""
        self._listener.want(self.beacon)
        hearing = self._listener.hear(block)
        peaks = hearing.peaks[0]
        threshold, prior = self.policy.demodulation.threshold, self.policy.prior
        found = self._finder.find(peaks, threshold, prior)
        where = None if found is None else lamp_estimate(found, prior)
        self.light = Light(hearing, bearing(peaks, self._ring, threshold), found, where)
        amplitudes = tuple(peaks.amplitude.astype(np.float32).tolist())
        lamp = None if where is None else carried_lamp(where)
        scale = self.world.diode_scale
        sight = sighted(lamp, self._axes, amplitudes, self._reckoned[0], self._block, scale)
        measured, energy = self.measured(), self.energy
        altitude = None if measured is None or energy is None else measured.altitude
        order = self._order(stamp_ns)
        if self._plan is not None:
            time = (stamp_ns - self._table.start_ns) * 1e-9
            self.asked = course_step(self._plan, time, sight.heading, altitude, order)
            return
        policy, route = self.policy, self.world.scenario.route_beacons
        self.asked, self.mission = mission_step(
            policy.mission, policy.strategy, self.mission, sight, altitude, order,
            max(len(route), 1), policy.reserve,
        )  # fmt: skip
        self.beacon = route[self.mission.asked][1] if route else NO_WISH

    def _order(self, stamp_ns: int) -> Order:
        """Return what the energy of the turn before allows, as the navigator takes it."""
        if self.energy is None:
            return Order.DOWN
        estimate = self.energy.estimate
        word = Word(stamp_ns, estimate.reserve, estimate.urgent)
        return order_of(self.policy.reserve, word, stamp_ns)

    def _where(self) -> Whereabouts | None:
        """Return distance from the start and speed as odom carries them; None while learning."""
        if self.measured() is None:
            return None
        reckoned = self._reckoned[-1]
        return Whereabouts(
            math.hypot(reckoned.x, reckoned.y), math.hypot(reckoned.forward, reckoned.left)
        )

    def _count(self, readings: Readings) -> None:
        """Keep the energy books of one turn of the meters."""
        nothing = math.nan, math.nan
        voltage, current = map(carried.single, readings.battery or nothing)
        panel_voltage, panel_current = map(carried.single, readings.panel or nothing)
        lux = readings.illuminance
        reading = Reading(
            stamp_ns=readings.stamp_ns,
            voltage=voltage,
            current=current,
            panel_voltage=panel_voltage,
            panel_current=panel_current,
            illuminance=math.nan if lux is None else lux,
            where=self._where(),
        )
        before = Known() if self.energy is None else self.energy.estimate
        self.energy = Energy(reading, update(self.policy.energy, self._aboard, before, reading))


def carried_lamp(lamp: LampEstimate) -> Lamp:
    """Return a lamp as its message carries it."""
    return Lamp(lamp.x, lamp.y, lamp.z, (lamp.xx, lamp.xy, lamp.yy))


def carried_axes(ring: Ring) -> tuple[tuple[float, float], ...]:
    """Return the axes of diodes as their message carries them."""
    rows = np.array([ring.cosines, ring.sines], dtype=np.float32).T
    return tuple((x, y) for x, y in rows.tolist())

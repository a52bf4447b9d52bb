"""
The world around the drone, one control period at a time, without ROS.

A `World` knows the truth, hands out what the sensors make of it, and takes duties. The simulator
node and every loop in one process run this same class. Time is integer nanoseconds on the grid of
the topic table; each sensor has its own stream of chance, so that one more sensor leaves the
others' noise as it was.
"""

from collections.abc import Sequence
import math
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.topics import TopicTable
from lta_energy import battery, loads, panel
from lta_sim import kernel
from lta_sim.effects import initial_memory
from lta_sim.light_field import illuminance, mean_illuminance, mean_irradiance
from lta_sim.readings import Outcome, Readings
from lta_sim.rigid_body import rotation
from lta_sim.scenario import Scenario
from lta_sim.sensors import imu, power, pressure, range
from lta_sim.sensors.light_block import AmplifierState, synthesise
from lta_sim.state import pack, POSITION, QUATERNION, RATES, VELOCITY
from lta_sim.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEP_NS = 2_500_000  # integration step; the shortest time constant of a shipped vehicle is 72 ms
STREAMS = ('start', 'imu', 'range', 'pressure', 'photodiodes', 'battery', 'panel')


@final
class World:
    """
    One drone in one scene.

    Parameters
    ----------
    vehicle : Vehicle
        The drone, in the scenario's air.
    scenario : Scenario
        The scene.
    table : TopicTable
        When each sensor is due.
    seed : int
        Of all chance.

    """

    def __init__(self, vehicle: Vehicle, scenario: Scenario, table: TopicTable, seed: int) -> None:
        self.vehicle = vehicle
        self.scenario = scenario
        self._table = table
        self._chance = {
            name: np.random.default_rng(np.random.SeedSequence([seed, index]))
            for index, name in enumerate(STREAMS)
        }
        self._draw_errors()
        self._model = vehicle.model()
        self._light = scenario.light_field
        self._wind = scenario.air.wind.vector
        self.state = self._at_start()
        self.duties: Array = np.zeros(len(vehicle.rotor_names))
        self.charge = scenario.start.charge.si
        self._electrics = (battery.open_circuit_voltage(self.charge), 0.0)
        self._harvested = 0.0
        self.steps = 0
        self.outcome = Outcome.FLYING  # how the flight stands; once decided, it stays
        self._ranges: list[tuple[int, float]] = []
        self._amplifier: AmplifierState | None = None
        self._poses = [self._pose()]
        self.wrenches()  # loads the compiled kernel now, not in the middle of the first step

    def _draw_errors(self) -> None:
        """Draw what stays the same during the flight."""
        air = self.scenario.air
        self.imu_errors = imu.draw(imu.ImuSettings(), self._chance['imu'])
        self.range_settings = range.RangeSettings()
        self._range = range.draw(self.range_settings, self._chance['range'])
        self.pressure_settings = pressure.PressureSettings(floor=air.pressure.si)
        self._pressure = pressure.draw(self.pressure_settings, self._chance['pressure'])
        self._meter = power.PowerMeterSettings()
        self._meters = {
            name: power.draw(self._meter, self._chance[name]) for name in ('battery', 'panel')
        }

    def _at_start(self) -> Array:
        """Return the state on the floor, with the heading that the seed draws."""
        start = self.scenario.start
        x, y = start.position.vector
        spread = start.heading_spread.si
        heading = start.heading.si + float(self._chance['start'].uniform(-spread, spread))
        height = self.vehicle.standing_height
        return pack((x, y, height), heading, memory=initial_memory())

    @property
    def stamp_ns(self) -> int:
        """Stamp of the present control step. [ns]."""
        return self._table.start_ns + self.steps * self._table.control_ns

    @property
    def elapsed(self) -> float:
        """Time since the start. [s]."""
        return self.steps * self._table.control_ns * 1e-9

    @property
    def distance(self) -> float:
        """Horizontal distance from the hull centre to the lamp. [m]."""
        x, y, _ = self.scenario.lamp.position.vector
        return math.hypot(x - self.state[0], y - self.state[1])

    def _judge(self) -> Outcome:
        """Return how the present state stands to the scenario's goal."""
        length, width, height = self.scenario.room.size.vector
        x, y, z = self.state[POSITION]
        if self.distance <= self.scenario.goal.radius.si:
            return Outcome.REACHED
        if not (abs(x) <= length / 2 and abs(y) <= width / 2 and z <= height):
            return Outcome.ESCAPED
        if self.elapsed >= self.scenario.goal.time_limit.si:
            return Outcome.TIMEOUT
        return Outcome.FLYING

    def wrenches(self) -> dict[str, Array]:
        """Return the present wrench of each effect, body frame. [N, N m]."""
        return dict(kernel.wrenches(self.state, self._model, self.duties, self._wind))

    def _pose(self) -> tuple[Array, Array]:
        x, y, z, w = self.state[QUATERNION]
        matrix = np.array(rotation((x, y, z, w))).reshape(3, 3)
        return self.state[POSITION].copy(), matrix

    def _due(self, name: str) -> bool:
        """Tell whether a topic on the control grid has a message at this step."""
        topic = self._table[name]
        since = self.stamp_ns - self._table.start_ns - topic.latency_ns
        return since >= 0 and since % topic.period_ns == 0

    def sense(self) -> Readings:
        """Return what the sensors say at the present control step; call it once a step."""
        readings = self.sense_motion()
        self.sense_rest(readings)
        return readings

    def sense_motion(self) -> Readings:
        """Return what the estimator waits for: IMU, range and pressure."""
        readings = Readings(self.stamp_ns)
        self._sense_motion(readings)
        if self.steps == 0:
            self._sense_range(self.stamp_ns)
        readings.ranges, self._ranges = self._ranges, []
        if self._due('pressure'):
            readings.pressure = pressure.measure(
                self.pressure_settings,
                self._pressure,
                float(self.state[2]) + self.vehicle.file.sensors.imu_position.vector[2],
                self.elapsed,
                self._chance['pressure'],
            )
        return readings

    def sense_rest(self, readings: Readings) -> None:
        """Add light, energy and truth, which nobody answers within the step."""
        if self._due('photodiodes'):
            readings.block = self._light_block()
        if self._due('battery'):
            self._sense_energy(readings)
        readings.truth = self._due('ground_truth/odom')

    def _sense_motion(self, readings: Readings) -> None:
        rate = kernel.derivative(self.state, self._model, self.duties, self._wind)
        x, y, z, w = self.state[QUATERNION].tolist()
        up = rotation((x, y, z, w))[6:]
        position = self.vehicle.file.sensors.imu_position.vector
        vx, vy, vz = self.state[VELOCITY].tolist()
        wx, wy, wz = self.state[RATES].tolist()
        ax, ay, az = rate[VELOCITY].tolist()
        bx, by, bz = rate[RATES].tolist()
        force = imu.specific_force(
            (vx, vy, vz),
            (wx, wy, wz),
            (ax, ay, az),
            (bx, by, bz),
            (up[0], up[1], up[2]),
            (position[0], position[1], position[2]),
            STANDARD_GRAVITY,
        )
        readings.force, readings.rates = imu.measure(
            self.imu_errors, force, (wx, wy, wz), self._chance['imu']
        )

    def _sense_range(self, stamp_ns: int) -> None:
        _, turn = self._pose()
        place = turn @ np.array(self.vehicle.file.sensors.range_position.vector)
        height = float(self.state[2] + place[2])
        reading = range.measure(
            self.range_settings, self._range, height, float(turn[2, 2]), self._chance['range']
        )
        self._ranges.append((stamp_ns, reading))

    def _light_block(self) -> tuple[int, NDArray[np.uint16]]:
        """Return the block that ends now, from the poses at its control steps."""
        light = self._table.light
        start = self.stamp_ns - self._table['photodiodes'].latency_ns
        positions, turns = (np.array(part) for part in zip(*self._poses, strict=True))
        points, axes = self.vehicle.diodes.place(positions, turns)
        block, self._amplifier = synthesise(
            self.vehicle.diodes,
            self._light,
            illuminance(self._light, points, axes),
            start,
            light.sample_rate.si,
            light.samples,
            self._chance['photodiodes'],
            self._amplifier,
        )
        self._poses = [self._poses[-1]]
        return start, block

    def _panel_plane(self) -> tuple[Array, Array]:
        """Return the panel's place and normal, each of shape (1, 3). [m, map]"""
        position, turn = self._pose()
        place = position + turn @ np.array(self.vehicle.file.sensors.panel_position.vector)
        return place[None, :], turn[:, 2][None, :]

    def _sense_energy(self, readings: Readings) -> None:
        readings.illuminance = float(mean_illuminance(self._light, *self._panel_plane())[0])
        readings.battery = power.measure(
            self._meter, self._meters['battery'], *self._electrics, self._chance['battery']
        )
        voltage = self.vehicle.panel.voltage
        current = self._harvest() / voltage
        readings.panel = power.measure(
            self._meter, self._meters['panel'], voltage, current, self._chance['panel']
        )

    def _harvest(self) -> float:
        """Return what the panel gives now. [W]"""
        cells = self.vehicle.panel
        irradiance = float(mean_irradiance(self._light, *self._panel_plane())[0])
        return panel.power(irradiance, cells.area, cells.efficiency)

    def advance(self, duties: Sequence[float]) -> None:
        """
        Fly one control period.

        Parameters
        ----------
        duties : sequence of float
            Duty by rotor, clipped to what each rotor can do.

        Raises
        ------
        ValueError
            If there is not one finite duty for each rotor; the state stays as it was.

        """
        asked = np.asarray(duties, dtype=np.float64)
        if asked.shape != self.duties.shape or not np.isfinite(asked).all():
            raise ValueError(f'The duties are {asked}; give {len(self.duties)} finite numbers.')
        low = np.where(self.vehicle.reversible, -1.0, 0.0)
        self.duties = np.clip(asked, low, 1.0)
        now, end = self.stamp_ns, self.stamp_ns + self._table.control_ns
        period = self._table['range'].period_ns
        while now < end:
            turn = (now - self._table.start_ns) // period + 1
            until = min(end, self._table.start_ns + turn * period)
            self._integrate(until - now)
            now = until
            if (now - self._table.start_ns) % period == 0:
                self._sense_range(now)
        self._drain(self._table.control_ns * 1e-9)
        self.steps += 1
        if self.outcome is Outcome.FLYING:
            self.outcome = self._judge()
        self._poses.append(self._pose())

    def _integrate(self, span_ns: int) -> None:
        steps = -(-span_ns // STEP_NS)
        dt = span_ns * 1e-9 / steps
        self.state = kernel.advance(self.state, self._model, self.duties, self._wind, dt, steps)

    def _drain(self, dt: float) -> None:
        """Let the cell feed the drone for a while, less what the panel brings."""
        look = kernel.look(self.state, self._model, self.duties, self._wind)
        thrusts = look.thrusts[: len(self.duties)].tolist()
        asked = loads.demand(self.vehicle.loads, thrusts, transmitting=True)
        if self._due('illuminance'):
            self._harvested = self._harvest()
        cell = self.vehicle.battery
        self.charge, voltage, current = battery.advance(
            self.charge, self._harvested - asked, cell.capacity, cell.resistance, dt
        )
        self._electrics = (voltage, current)

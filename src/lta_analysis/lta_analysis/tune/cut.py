"""
A closed loop cut open where the controller's demand goes to the rotors, and linearised there.

One control period is one map of numbers to numbers: sensors without noise, the estimator, the cascade,
the allocation, the motors and the vehicle, by the very functions that fly. Its derivatives, by central
differences about a steady flight, hold everything that delays a loop: sampling, motor lag, filters.

    x' = A x + B u,    y = C x

x is the state of vehicle, estimator and controller, u the force and moment that the rotors are asked for
(surge, heave, yaw), y what the cascade would ask for; in flight u = y. Range and pressure, which come in
some periods only, are taken in every one, with their variance raised by the same factor. What is
symmetric but has a kink, as one forward rotor for each sense of turning, is met by the differences half
way: exact for the loop it serves.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.topics import topic_table
from lta_control.allocation import allocate, duties, new_scratch
from lta_control.attitude import up_in_body
from lta_control.autopilot import Autopilot, drone_of, MEMORY
from lta_control.carried import measured as measured_of
from lta_control.carried import velocity
from lta_control.cascade import cascade_step, CascadeGains, Demand, Setpoint
from lta_control.control import ControlMemory
from lta_control.estimator import estimator_step, EstimatorSettings, Inputs
from lta_control.onboard import Drone, Onboard
from lta_control.per_rotor import SLOTS, slots
from lta_sim import kernel
from lta_sim.effects import initial_memory
from lta_sim.model import Model
from lta_sim.sensors import imu, range
from lta_sim.sensors.pressure import air_pressure, PressureSettings
from lta_sim.state import pack
from lta_sim.vehicle import Vehicle
from lta_sim.world import STEP_NS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
DIFFERENCE = 1e-6
SETTLING = 80.0  # s from the take-off to the steady flight
REST = 0.5  # s to learn the biases, of which there are none
NEUTRAL = 1e-5  # what memory of place and bias may be off from 1 by rounding, as an eigenvalue


@final
class Cut:
    """
    One control period of a drone, whole or cut open.

    Parameters
    ----------
    true, known : Vehicle
        What flies, and what the drone takes it for.
    gains : CascadeGains
        Of the controller.

    """

    def __init__(self, true: Vehicle, known: Vehicle, gains: CascadeGains) -> None:
        table = topic_table()
        self.period = table.control_ns * 1e-9
        self._steps = -(-table.control_ns // STEP_NS)
        self._true, self._model = true, true.model()
        self._floor = PressureSettings().floor
        own = EstimatorSettings()
        less = own.altitude.model_copy(
            update={
                name: getattr(own.altitude, name)
                * math.sqrt(table[topic].period_ns / table.control_ns)
                for name, topic in (('range_noise', 'range'), ('pressure_noise', 'pressure'))
            }
        )
        settings = own.model_copy(update={'rest_time': REST, 'altitude': less})
        self._still = _held_upright(true)
        self.drone: Drone = drone_of(known, settings, gains, self.period)
        delay = self._model.given.get('command_delay', {}).get('delay', 0.0) / self.period
        self._whole = int(delay + 1e-9)
        self._part = delay - self._whole if delay - self._whole > 1e-9 else 0.0
        self.ages = self._whole + 2  # commands that this period and the next need

    def sensed(self, state: Array, past: Array, model: Model | None = None) -> Inputs:
        """
        Return what the sensors would say without noise.

        Parameters
        ----------
        state : ndarray
            Of the vehicle.
        past : ndarray, shape (n, SLOTS)
            The commands before this period, the newest first.
        model : Model or None
            What flies; the vehicle itself if left out.

        """
        sensors = self._true.file.sensors
        numbers = state.tolist()
        orders = self._orders(past[self._whole])
        rate = kernel.derivative(state, model or self._model, orders).tolist()
        ix, iy, iz = sensors.imu_position.vector
        force = imu.felt(numbers, rate, (ix, iy, iz), STANDARD_GRAVITY)
        rx, ry, rz = sensors.range_position.vector
        height, up = range.outlook(numbers, (rx, ry, rz))
        return Inputs(
            (numbers[10], numbers[11], numbers[12]),
            force,
            height / up,
            air_pressure(self._floor, numbers[2] + iz),
            slots(past[0].tolist()),
        )

    def flown(self, state: Array, past: Array, model: Model | None = None) -> Array:
        """Return the state of the vehicle one period later; `past` begins with this period's."""
        for share, age in ((self._part, self._whole + 1), (1.0 - self._part, self._whole)):
            if share > 0.0:
                step = share * self.period / self._steps
                orders = self._orders(past[age])
                state = kernel.advance(
                    state, model or self._model, orders, (0.0, 0.0, 0.0), step, self._steps
                )
        return state

    def _orders(self, command: Array) -> Array:
        return self._true.command(command[: len(self._true.rotors)].tolist())

    def decided(
        self, state: Array, memory: Onboard, past: Array, asked: Demand | None
    ) -> tuple[Onboard, Demand]:
        """
        Return the memory of the drone after one step, and what its cascade asks for.

        The rotors do `asked` where it is given, and else what the cascade asks for.
        """
        drone = self.drone
        heard = self.sensed(state, past)
        estimate = estimator_step(drone.estimator, drone.body, memory.estimate, heard, drone.dt)
        height, speed = estimate.altitude.height, velocity(estimate)
        measured = measured_of(estimate.attitude, height, speed, estimate.rates[2])
        demand, cascade = cascade_step(
            drone.gains,
            drone.surge_drag,
            drone.rotors.lowest_heave,
            memory.control.cascade,
            measured,
            memory.setpoint,
            memory.control.shortfall,
            drone.dt,
        )
        given = asked or demand
        thrusts, done = allocate(
            drone.rotors,
            (given.surge, 0.0, given.heave, 0.0, 0.0, given.yaw),
            memory.control.thrusts,
            new_scratch(),
        )
        missing = Demand(done[0] - given.surge, done[2] - given.heave, done[5] - given.yaw)
        after = memory._replace(
            estimate=estimate,
            measured=measured,
            control=ControlMemory(cascade, thrusts, missing),
            duties=duties(drone.rotors, thrusts),
        )
        return after, demand

    def steady(self, setpoint: Setpoint) -> tuple[Array, Onboard]:
        """
        Return vehicle and drone after a while of flight towards a setpoint, without noise.

        On the way the hull is kept from swinging and commands are not delayed, which changes
        nothing where nothing moves: a steady flight is found whether or not it is stable.
        """
        autopilot = Autopilot(self.drone)
        state = pack((0.0, 0.0, self._true.standing_height), memory=initial_memory())
        past = np.zeros((self.ages, SLOTS))
        for tick in np.arange(round((REST + SETTLING) / self.period)):
            if tick * self.period > REST:
                autopilot.guide(setpoint)
            heard = self.sensed(state, past, self._still)
            given = autopilot.step(heard.rates, heard.force, heard.range, heard.pressure)
            past[:, : len(given)] = given
            state = self.flown(state, past, self._still)
        return state, autopilot.memory


def _held_upright(vehicle: Vehicle) -> Model:
    """Return a vehicle whose roll and pitch are critically damped by the air."""
    given = vehicle.effects()
    own = dict(given.get('rotational_drag', {}))
    stiffness = abs(vehicle.mass * STANDARD_GRAVITY * float(vehicle.cg[2]))
    for axis, name in enumerate(('roll', 'pitch')):
        inertia = float(vehicle.inertia[axis, axis]) + vehicle.added_mass[3 + axis]
        inertia += vehicle.mass * float(vehicle.cg[2]) ** 2
        own[name] = own.get(name, 0.0) + 2.0 * math.sqrt(stiffness * inertia)
    return Model.build(
        {**given, 'rotational_drag': own},
        mass=vehicle.mass,
        cg=vehicle.cg,
        inertia=vehicle.inertia,
        displaced=vehicle.displaced,
        rotors=[(rotor.place, rotor.axis) for rotor in vehicle.rotors],
    )


@final
@dataclass(frozen=True, slots=True)
class Linear:
    """
    A cut loop about one steady flight.

    Attributes
    ----------
    a, b, c : ndarray
        Of x' = A x + B u, y = C x; only what matters to y is kept.
    period : float
        Of control. [s]
    radius, swing : float
        Largest size of an eigenvalue of the closed loop, and its angular frequency. [1, rad/s]
    tilt : float
        Of the steady flight. [rad]
    thrusts : tuple of float
        Of the steady flight. [N]

    """

    a: Array
    b: Array
    c: Array
    period: float
    radius: float
    swing: float
    tilt: float
    thrusts: tuple[float, ...]

    @property
    def stable(self) -> bool:
        """Whether small disturbances die out."""
        return self.radius < 1.0 + NEUTRAL

    @property
    def growth(self) -> float:
        """Rate at which the least damped disturbance grows; negative: it dies out. [1/s]"""
        return math.log(self.radius) / self.period


def linearised(cut: Cut, setpoint: Setpoint) -> Linear:
    """Return a loop about the steady flight that a setpoint leads to."""
    state, memory = cut.steady(setpoint)
    first, second = len(state), len(state) + MEMORY.size
    past = np.tile(np.array(memory.duties), (cut.ages, 1))
    _, trim = cut.decided(state, memory, past, None)

    def mapped(x: Array, u: Array) -> tuple[Array, Array]:
        own, known, before = x[:first], MEMORY.read(x[first:second]), x[second:].reshape(-1, SLOTS)
        after, asked = cut.decided(own, known, before, Demand(*u.tolist()))
        commands = np.vstack([np.array(after.duties), before[:-1]])
        flown = cut.flown(own, commands)
        return np.concatenate([flown, MEMORY.write(after), commands.ravel()]), np.array(asked)

    numbers, u = np.concatenate([state, MEMORY.write(memory), past.ravel()]), np.array(trim)
    turned = [first + place for place in _continuous(memory)]
    everything = [*np.arange(first).tolist(), *turned, *np.arange(second, len(numbers)).tolist()]
    a, c = _slopes(lambda x: mapped(x, u), numbers, everything)
    b, _ = _slopes(lambda v: mapped(numbers, v), u, [0, 1, 2])
    keep = _joined(a, b, c)
    a, b, c = a[np.ix_(keep, keep)], b[keep], c[:, keep]
    modes = np.linalg.eigvals(a + b @ c)
    worst = modes[np.abs(modes).argmax()]
    radius, swing = float(np.abs(worst)), float(abs(np.angle(worst))) / cut.period
    up = up_in_body(memory.estimate.attitude)[2]
    tilt = math.acos(min(1.0, up))
    return Linear(a, b, c, cut.period, radius, swing, tilt, memory.control.thrusts)


def _continuous(memory: Onboard) -> list[int]:
    """Return the places of the numbers in a memory that are no flags and no counts."""
    kinds: list[bool] = []

    def walk(value: object) -> None:
        if isinstance(value, tuple):
            for item in value:
                walk(item)
        else:
            kinds.append(isinstance(value, float))

    walk(memory)
    return [place for place, real in enumerate(kinds) if real]


def _slopes(function, at: Array, turned: list[int]):  # type: ignore[no-untyped-def] # noqa: ANN001, ANN202
    """Return the derivatives of both outputs of a function by its argument."""
    rows = [function(at)[k] for k in (0, 1)]
    tables = [np.zeros((len(row), len(at))) for row in rows]
    for place in turned:
        step = np.zeros(len(at))
        step[place] = DIFFERENCE * max(1.0, abs(at[place]))
        for table, high, low in zip(tables, function(at + step), function(at - step), strict=True):
            table[:, place] = (high - low) / (2.0 * step[place])
    return tables


def _joined(a: Array, b: Array, c: Array) -> NDArray[np.intp]:
    """Return the states that some input reaches and some output sees."""
    links = (np.abs(a) > 0.0) & ~np.isnan(a)
    reached, seen = np.abs(b).max(axis=1) > 0.0, np.abs(c).max(axis=0) > 0.0
    for _ in np.arange(len(a)):
        reached |= links[:, reached].any(axis=1)
        seen |= links[seen].any(axis=0)
    return np.flatnonzero(reached & seen)

"""
Estimator and control law of one drone, compiled, for loops in one process.

`lta_control.autopilot` is the same for the cascade alone, in one function. A law that flies by a
tracker gets its pose and velocity from there, in a frame that begins where the tracker first saw
the vehicle, and its rates from the drone's own gyroscope.
"""

from collections.abc import Callable
import math
import struct
from typing import Any, final, NamedTuple

from lta_config.compilation.flat import Array, compiled, Layout
from lta_control.allocation import SCRATCH, Scratch
from lta_control.attitude import heading, Quaternion, up_in_body, Vector
from lta_control.autopilot import ESTIMATE
from lta_control.carried import measured as measured_of
from lta_control.carried import velocity
from lta_control.cascade import Measured, Setpoint
from lta_control.control import landed, TILT_LIMIT
from lta_control.estimator import Body, Estimate, estimator_step, EstimatorSettings, Inputs
from lta_control.laws.frames import turned
from lta_control.laws.protocol import Command, Feedback, Heard, Law, Motion
from lta_control.per_rotor import NONE, slots
from lta_control.sighting import Reckoned
from lta_control.vehicle_side import body_of
from lta_model.vehicle import Vehicle
import numpy as np

INPUTS = Layout(Inputs((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0, NONE))
HEARD = Layout(Heard())
COMMAND = Layout(Command())
READY, RATES = ESTIMATE.place('ready').start, ESTIMATE.place('rates')
TRUTH = 13  # position, quaternion, velocity, rates


class Watch(NamedTuple):
    """What the estimator knows that stays the same: filters, vehicle and period [s]."""

    estimator: EstimatorSettings
    body: Body
    dt: float


def watch_step(known: Watch, memory: Estimate, heard: Inputs, scratch: Scratch) -> Estimate:
    """Return the estimate one step later; the same where something is no number."""
    p, q, r = heard.rates
    x, y, z = heard.force
    if math.isfinite(p + q + r) and math.isfinite(x + y + z):
        return estimator_step(known.estimator, known.body, memory, heard, known.dt)
    return memory


def seen(estimate: Estimate) -> Motion:
    """Return an estimate as laws see it."""
    x, y = estimate.position
    return Motion(
        (x, y, estimate.altitude.height), estimate.attitude, velocity(estimate), estimate.rates
    )


def tracked(truth: tuple[float, ...], start: tuple[float, ...], rates: Vector) -> Motion:
    """
    Return what a tracker says as laws see it.

    Parameters
    ----------
    truth, start : tuple of 13 floats
        Position, quaternion, velocity and rates, now and when it was first seen; map.
    rates : tuple
        By the drone's own gyroscope. [rad/s]

    """
    yaw = heading(_quaternion(start))
    x, y = turned(-yaw, truth[0] - start[0], truth[1] - start[1])
    a, b, c, d = truth[3:7]
    sin, cos = math.sin(-0.5 * yaw), math.cos(0.5 * yaw)
    attitude = (cos * a - sin * b, cos * b + sin * a, cos * c + sin * d, cos * d - sin * c)
    return Motion((x, y, truth[2]), attitude, (truth[7], truth[8], truth[9]), rates)


def _quaternion(motion: tuple[float, ...]) -> Quaternion:
    x, y, z, w = motion[3:7]
    return x, y, z, w


@final
class Pilot:
    """
    Estimate and control by any law, step by step; in its use as `Autopilot`.

    Parameters
    ----------
    law : Law
        The control law.
    gains : Settings
        Its gains.
    vehicle : Vehicle
        The drone.
    estimator : EstimatorSettings
        Of the filters.
    dt : float
        Control period. [s]
    tilt_limit : float
        Tilt beyond which the motors stop. [rad]

    Attributes
    ----------
    command : Command
        The newest.
    stopped : bool
        For good: it has turned over, or something is no number.

    """

    def __init__(
        self,
        law: Law,
        gains: object,
        vehicle: Vehicle,
        estimator: EstimatorSettings,
        dt: float,
        tilt_limit: float = TILT_LIMIT,
    ) -> None:
        self.law, self._dt = law, dt
        self._upright, self._count = math.cos(tilt_limit), len(vehicle.allocation)
        self._rest = Command(NONE, _rest_place(vehicle))
        self._standing = vehicle.standing_height
        self._watch, self._watch_step = _made(
            watch_step, Watch(estimator, body_of(vehicle), dt), ESTIMATE, INPUTS
        )
        self._memory_layout = Layout(law.start)
        self._known, self._law_step = _made(
            law.step, law.known(gains, vehicle), self._memory_layout, HEARD
        )
        self._commanded = self._memory_layout.place('command')
        self._estimate = ESTIMATE.write(Estimate())
        self._fresh = self._memory_layout.write(law.start)
        self._memory = self._fresh.copy()
        self._scratch = np.zeros(SCRATCH)
        self._inputs, self._heard = np.empty(INPUTS.size), np.empty(HEARD.size)
        self._pack_inputs = struct.Struct(f'{INPUTS.size}d').pack_into
        self._pack_heard = struct.Struct(f'{HEARD.size}d').pack_into
        self._setpoint: Setpoint | None = None
        self._truth: tuple[float, ...] = ()
        self._start: tuple[float, ...] = ()
        self.command, self.stopped = self._rest, False

    def see(self, truth: tuple[float, ...]) -> None:
        """Take what a tracker says, position to rates, which the next step flies by."""
        self._truth = truth[:TRUTH]
        self._start = self._start or self._truth

    def guide(self, setpoint: Setpoint) -> None:
        """Take a setpoint, which the next step follows."""
        self._setpoint = setpoint

    def step(
        self, rates: Vector, force: Vector, distance: float = math.nan, pressure: float = math.nan
    ) -> tuple[float, ...]:
        """Return the duties after one more period, by rotor; arguments as of `Autopilot`."""
        duties = self.command.duties
        self._pack_inputs(self._inputs.data, 0, *rates, *force, distance, pressure, *duties)
        self._watch_step(self._watch, self._estimate, self._inputs, self._scratch)
        self.command = self._decided()
        return self.duties

    def instead(self, duties: tuple[float, ...]) -> None:
        """Know what the rotors were told in place of the newest duties."""
        self.command = self.command._replace(duties=slots(duties))

    def _decided(self) -> Command:
        """Return the newest command; none before there is a setpoint and a motion."""
        motion = self.motion
        if motion is None or self._setpoint is None:
            return self._rest
        setpoint = self._setpoint
        numbers = (*motion.position, *motion.attitude, *motion.velocity, *motion.rates, *setpoint)
        upright = up_in_body(motion.attitude)[2]
        if not math.isfinite(sum(numbers)) or upright < self._upright:
            self.stopped = True
        if self.stopped or landed(_measured(motion), setpoint, self._standing):
            self._memory = self._fresh.copy()
            return self._rest
        self._pack_heard(self._heard.data, 0, *numbers, self._dt)
        self._law_step(self._known, self._memory, self._heard, self._scratch)
        return COMMAND.read(self._memory[self._commanded])

    @property
    def motion(self) -> Motion | None:
        """Where the drone is, as its law sees it; None while that is not known."""
        if not self._estimate[READY]:
            return None
        if self.law.feedback is Feedback.ESTIMATOR:
            return seen(self.estimate)
        p, q, r = self._estimate[RATES].tolist()
        return tracked(self._truth, self._start, (p, q, r)) if self._truth else None

    @property
    def duties(self) -> tuple[float, ...]:
        """Duties by rotor."""
        return self.command.duties[: self._count]

    @property
    def measured(self) -> Measured | None:
        """Where the drone is in the words of the cascade; None while that is not known."""
        motion = self.motion
        return None if motion is None else _measured(motion)

    @property
    def heading(self) -> float:
        """Yaw by the estimate. [rad]."""
        return heading(self.estimate.attitude)

    @property
    def reckoned(self) -> Reckoned:
        """Heading, dead-reckoned position and airspeed, as of `Autopilot`."""
        own = self.estimate
        surge, sway, _ = velocity(own)
        return Reckoned(heading(own.attitude), *own.position, surge, sway)

    @property
    def estimate(self) -> Estimate:
        """All that the estimator remembers."""
        return ESTIMATE.read(self._estimate)

    def believed(self) -> Array:
        """Return the numbers of the estimate, in the order of `ESTIMATE`; the caller's own."""
        return self._estimate.copy()


def _measured(motion: Motion) -> Measured:
    return measured_of(motion.attitude, motion.position[2], motion.velocity, motion.rates)


def _rest_place(vehicle: Vehicle) -> Vector:
    moving = vehicle.file.moving_mass
    if moving is None:
        return 0.0, 0.0, 0.0
    x, y, z = moving.position.vector
    return x, y, z


def _made(
    core: Callable[..., Any], known: tuple[Any, ...], memory: Layout[Any], heard: Layout[Any]
) -> tuple[Array, Callable[[Array, Array, Array, Array], None]]:
    """Return what stays the same as numbers, and the compiled core."""
    layout = Layout(known)
    return layout.write(known), compiled(core, layout, memory, heard)

"""Simulate vehicles that are commanded by a wrench: the actuators, and a pilot in a lab."""

from collections.abc import Sequence
import math
from typing import Final, final

from lta_challenge.other.body import GRAVITY, rotation_matrix, State
from lta_challenge.other.truth import Six, VehicleTruth
import numpy as np

Draw = np.random.Generator

HEIGHTS: Final = (1.1, 2.0)  # m; range of height setpoints
REACH: Final = 1.5  # m; range of the place setpoints
HOLD: Final = (4.0, 9.0)  # s; length of a setpoint
DITHER: Final = (0.4, 1.2)  # s; length of a value of the dither
SPEED: Final = 0.35  # m/s; towards a setpoint
# Largest force ahead and up [N], and yaw moment [N m]: about those of two rotors of 25 mN.
MOST: Final = (0.05, 0.06, 0.006)
SHAKE: Final = 0.35  # of the largest command; size of the dither


@final
class WrenchActuators:
    """
    Actuators that apply a share of a commanded wrench, without lag.

    Parameters
    ----------
    truth : VehicleTruth
        Its `wrench_gains` are the shares.
    duties : sequence of six float
        Commanded wrench before the start.

    """

    def __init__(self, truth: VehicleTruth, duties: Sequence[float]) -> None:
        self._gains = truth.wrench_gains
        self._wrench = list(duties)

    def set_duties(self, duties: Sequence[float]) -> None:
        """Set the commanded wrench from now on."""
        self._wrench = list(duties)

    def advance(self, seconds: float) -> None:
        """Do nothing: the wrench is held."""

    def thrusts_after_command(self, seconds: float) -> list[float]:
        """Return the wrench that acts on each axis. [N], [N m]"""
        return [gain * each for gain, each in zip(self._gains, self._wrench, strict=True)]

    def total_wrench(self, thrusts: Sequence[float]) -> Six:
        """Return the wrench."""
        a, b, c, d, e, f = thrusts
        return a, b, c, d, e, f


@final
class WrenchPilot:
    """
    Pilot that flies to random places and dithers each axis, as an operator in a lab does.

    The operator sees the vehicle move and knows what moves it, so what he commands suits the
    true gains; the record has the command.

    Parameters
    ----------
    nominal : VehicleTruth
        Parameters of the vehicle file.
    gains : six float
        The true gains.
    draw : Generator
        Random generator.
    steps : bool
        Whether he flies single steps without dither, with rest between them.

    """

    def __init__(self, nominal: VehicleTruth, gains: Six, draw: Draw, steps: bool = False) -> None:
        self._draw, self._gains, self._steps = draw, gains, steps
        self._weight = (nominal.mass - nominal.displaced) * GRAVITY
        self._sum, self._until = 0.0, 0.0
        self._aim = [0.0, 0.0, float(draw.uniform(*HEIGHTS))]
        self._shake, self._ends = [0.0] * 3, [0.0] * 3

    def initial_duties(self) -> list[float]:
        """Return the command that carries the weight of the vehicle file."""
        return [0.0, 0.0, self._weight / self._gains[2], 0.0, 0.0, 0.0]

    def _draw_setpoint(self, time: float) -> None:
        """Draw the next place if the present one ends."""
        if time >= self._until:
            x, y = self._draw.uniform(-REACH, REACH, 2)
            self._aim = [float(x), float(y), float(self._draw.uniform(*HEIGHTS))]
            self._until = time + float(self._draw.uniform(*HOLD))

    def _draw_dither(self, time: float) -> list[float]:
        """Return the dither of surge, heave and yaw in shares of the largest command."""
        for k, end in enumerate(self._ends):
            if time >= end:
                size = 0.0 if self._steps else SHAKE
                self._shake[k] = size * float(self._draw.choice([-1.0, 0.0, 1.0]))
                self._ends[k] = time + float(self._draw.uniform(*DITHER))
        return self._shake

    def compute_duties(self, time: float, state: State) -> list[float]:
        """Return the commanded wrench at a time and true state."""
        self._draw_setpoint(time)
        r = rotation_matrix(*state[6:10])
        ahead, aside, off = (aim - now for aim, now in zip(self._aim, state[:3], strict=True))
        far = math.hypot(ahead, aside)
        turn = math.remainder(math.atan2(aside, ahead) - math.atan2(r[3], r[0]), 2.0 * math.pi)
        # Speed ahead: towards the place, slower the further the nose points elsewhere
        speed = r[0] * state[3] + r[3] * state[4]
        wanted = min(SPEED, 0.5 * far) * max(math.cos(turn), 0.0)
        steer = 0.004 * turn - 0.012 * state[12] if far > 0.3 else -0.012 * state[12]
        # Small steps, so that the integral does not wind up
        self._sum = min(max(self._sum + 6e-5 * off, -0.06), 0.06)
        lift = self._sum + 0.05 * off - 0.12 * state[5]
        shares = (0.25 * (wanted - speed) / MOST[0], lift / MOST[1], steer / MOST[2])
        dither = self._draw_dither(time)
        surge, heave, yaw = (
            most * min(max(share + more, -1.0), 1.0)
            for most, share, more in zip(MOST, shares, dither, strict=True)
        )
        wrench = (surge, 0.0, self._weight + heave, 0.0, 0.0, yaw)
        return [each / gain for each, gain in zip(wrench, self._gains, strict=True)]

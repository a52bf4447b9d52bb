"""
How good an examination was: each step by itself, and all in one cost.

The cost of a step of size h that lasts T is

    (1 / (h T)) integral |r - y| dt  +  OVERSHOOT o / h  +  steady error / h

with the setpoint r, the true value y and the overshoot o; to their mean over the steps comes what
the altitude lost while something else was stepped, the swing of the hull at the end, a swing that
would grow in a longer cruise, the time of a mission with `ASTRAY` for one that misses its goal,
and the work of the rotors. An examination in which the altitude is lost costs `LOST` more: no sum
of the rest comes near it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final

from lta_studies.tune.step_response import Array, SetpointStep, StepResponse, STEPS
import numpy as np

BAND: Final = 0.1  # of a step: within it, the step has settled
TAIL: Final = 0.25  # last part of a step, over which the steady error is taken
OVERSHOOT: Final = 0.5
GROWTH: Final = 10.0  # s; a swing that grows by 1 % a second costs 0.1
SEARCH: Final = 0.5
ASTRAY: Final = 2.0  # cost of a mission that misses its goal
EFFORT: Final = 0.1  # s; cost of one full duty a second, by rotor
ALTITUDE_SCALE: Final = 0.4  # m
SWING_SCALE: Final = 0.2  # rad
SWINGING: Final = 6.0  # s before the end over which the swing is taken
ADRIFT: Final = 0.3  # m; altitude that far off at the end is lost
LOST: Final = 10.0


@final
@dataclass(frozen=True, slots=True)
class StepMetrics:
    """
    How one step went.

    Attributes
    ----------
    settle : float
        Until within 10 % of the step for good; infinite if never. [s]
    overshoot, steady, error : float
        Beyond the setpoint, rms over the last quarter, and mean of the size; of the step. [1]

    """

    settle: float
    overshoot: float
    steady: float
    error: float

    @property
    def cost(self) -> float:
        """What it costs. [1]"""
        return self.error + OVERSHOOT * self.overshoot + self.steady


@final
@dataclass(frozen=True, slots=True)
class ResponseMetrics:
    """
    How one examination went.

    Attributes
    ----------
    marks : tuple of Mark
        By step.
    altitude : float
        rms error of the altitude while something else was stepped. [m]
    swing : float
        Standard deviation of the tilt over the last seconds. [rad]
    effort : float
        Mean change of a rotor's duty per second. [1/s]
    lost : bool
        Whether the altitude was lost or the motors stopped.
    adrift : float
        How far the altitude is off at the end of each altitude step and of the flight, the most.
        [m]
    growth : float
        Rate at which the least damped swing grows in cruise, by the linear loop; 0 where that was
        not asked for. [1/s]
    reached : bool
        Whether the mission ended at its goal.
    search : float
        How long the mission took, of the time allowed. [1]

    """

    marks: tuple[StepMetrics, ...]
    altitude: float
    swing: float
    effort: float
    lost: bool
    adrift: float
    growth: float = 0.0
    reached: bool = True
    search: float = 0.0

    @property
    def cost(self) -> float:
        """All in one number, the less the better. [1]"""
        mean = sum(mark.cost for mark in self.marks) / len(self.marks)
        missing = LOST + min(self.adrift, LOST) if self.lost else 0.0
        rest = self.altitude / ALTITUDE_SCALE + self.swing / SWING_SCALE + EFFORT * self.effort
        rest += GROWTH * max(0.0, self.growth)
        rest += SEARCH * self.search + (0.0 if self.reached else ASTRAY)
        return mean + rest + missing


def compute_step_metrics(time: Array, value: Array, step: SetpointStep) -> StepMetrics:
    """
    Return how a step went.

    Parameters
    ----------
    time, value : ndarray, shape (n,)
        What was stepped, over the time of the step. [s]
    step : Step
        The step.

    """
    size = abs(step.after - step.before)
    off = (value - step.after) / (step.after - step.before)  # negative on the way, 0 there
    outside = np.flatnonzero(np.abs(off) > BAND)
    settle = 0.0
    if len(outside):
        last = int(outside[-1])
        settle = math.inf if last == len(time) - 1 else float(time[last + 1] - step.start)
    tail = off[-max(1, int(TAIL * len(off))) :]
    assert size > 0.0
    return StepMetrics(
        settle,
        max(0.0, float(off.max())),
        float(np.sqrt(np.mean(tail**2))),
        float(np.mean(np.abs(off))),
    )


def compute_response_metrics(
    trace: StepResponse, steps: Sequence[SetpointStep] = STEPS
) -> ResponseMetrics:
    """Return how an examination went."""
    marks, others, ends = [], [], []
    altitude = steps[0].before
    for step in steps:
        during = (trace.time >= step.start) & (trace.time < step.end)
        marks.append(
            compute_step_metrics(
                trace.time[during], trace.select_channel(step.channel)[during], step
            )
        )
        if step.channel == 'altitude':
            altitude = step.after
        else:
            others.append(trace.altitude[during] - altitude)
        last = trace.altitude[during & (trace.time >= step.end - 2.0)]
        ends.append(abs(float(last.mean()) - altitude))
    held = math.sqrt(float(np.mean(np.concatenate(others) ** 2))) if others else 0.0
    flying = trace.time >= steps[0].start
    adrift = max(ends)
    swing = float(trace.tilt[trace.time >= steps[-1].end - SWINGING].std())
    lost = trace.stopped or not adrift <= ADRIFT
    return ResponseMetrics(
        tuple(marks), held, swing, float(trace.work[flying].mean()), lost, adrift
    )

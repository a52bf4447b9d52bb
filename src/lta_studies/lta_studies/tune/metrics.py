"""
Rate a test flight: metrics of each step, and one total cost.

The cost of a step of size h that lasts T is

    (1 / (h T)) integral |r - y| dt  +  OVERSHOOT o / h  +  steady error / h

with the setpoint r, the true value y and the overshoot o. The total is the mean over the steps
plus terms for the altitude error during the other steps, the swing of the hull at the end, an
unstable swing in cruise, the duration of the mission (plus `ASTRAY` if it misses its goal), and
the activity of the rotors. A flight that loses its altitude costs `LOST` more, which outweighs all
other terms.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final

from lta_studies.tune.step_response import Array, SetpointStep, StepResponse, STEPS
import numpy as np

BAND: Final = 0.1  # share of a step within which it counts as settled
TAIL: Final = 0.25  # last share of a step, over which the steady error is taken
OVERSHOOT: Final = 0.5  # weight in the cost of a step
GROWTH: Final = 10.0  # s; a swing that grows by 1 % per second costs 0.1
SEARCH: Final = 0.5  # cost of a mission that uses the whole time limit
ASTRAY: Final = 2.0  # cost of a mission that misses its goal
EFFORT: Final = 0.1  # s; cost of a mean duty change of 1 per second and rotor
ALTITUDE_SCALE: Final = 0.4  # m of rms altitude error that cost 1
SWING_SCALE: Final = 0.2  # rad of swing that cost 1
SWINGING: Final = 6.0  # s at the end of the flight over which the swing is taken
ADRIFT: Final = 0.3  # m; a larger altitude error at the end counts as lost
LOST: Final = 10.0


@final
@dataclass(frozen=True, slots=True)
class StepMetrics:
    """Metrics of one step."""

    settle: float  # settling time to within 10 % of the step; infinite if it never settles [s]
    # Overshoot, rms error over the last quarter, and mean absolute error, relative to the step [1]
    overshoot: float
    steady: float
    error: float

    @property
    def cost(self) -> float:
        """Cost of the step."""
        return self.error + OVERSHOOT * self.overshoot + self.steady


@final
@dataclass(frozen=True, slots=True)
class ResponseMetrics:
    """Metrics of one test flight."""

    marks: tuple[StepMetrics, ...]  # metrics of each step
    altitude: float  # rms altitude error during the other steps [m]
    swing: float  # standard deviation of the tilt over the last seconds [rad]
    effort: float  # mean change of a rotor's duty per second [1/s]
    lost: bool  # whether the altitude was lost or the motors stopped
    adrift: float  # largest altitude error at the end of a step [m]
    # Growth rate of the least damped mode in cruise, from the linear loop; 0 if not computed [1/s]
    growth: float = 0.0
    reached: bool = True  # whether the mission reached its goal
    search: float = 0.0  # duration of the mission as a share of its time limit [1]

    @property
    def cost(self) -> float:
        """Total cost of the flight; lower is better."""
        mean = sum(mark.cost for mark in self.marks) / len(self.marks)
        # The altitude error, capped, ranks lost flights, so that a search can improve on them.
        missing = LOST + min(self.adrift, LOST) if self.lost else 0.0
        rest = self.altitude / ALTITUDE_SCALE + self.swing / SWING_SCALE + EFFORT * self.effort
        rest += GROWTH * max(0.0, self.growth)
        rest += SEARCH * self.search + (0.0 if self.reached else ASTRAY)
        return mean + rest + missing


def compute_step_metrics(time: Array, value: Array, step: SetpointStep) -> StepMetrics:
    """Compute the metrics of a step from the true values of its channel over time [s]."""
    size = abs(step.after - step.before)
    off = (value - step.after) / (step.after - step.before)  # negative on the way, 0 there
    outside = np.flatnonzero(np.abs(off) > BAND)
    settle = 0.0
    if len(outside):
        last = int(outside[-1])
        # Outside the band at the last sample: the step never settled.
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
    """Compute the metrics of a test flight."""
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
        # The mean over 2 s averages out a swing around the setpoint.
        last = trace.altitude[during & (trace.time >= step.end - 2.0)]
        ends.append(abs(float(last.mean()) - altitude))
    # Rms altitude error while another channel steps
    held = math.sqrt(float(np.mean(np.concatenate(others) ** 2))) if others else 0.0
    flying = trace.time >= steps[0].start
    adrift = max(ends)
    # The standard deviation ignores a constant lean.
    swing = float(trace.tilt[trace.time >= steps[-1].end - SWINGING].std())
    lost = trace.stopped or not adrift <= ADRIFT  # NaN counts as lost
    return ResponseMetrics(
        tuple(marks), held, swing, float(trace.work[flying].mean()), lost, adrift
    )

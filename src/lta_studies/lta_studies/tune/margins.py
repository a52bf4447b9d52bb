# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the stability margins of all loops, each from its frequency response.

L(jw) is the open-loop response, with the sign that makes the closed loop 1 / (1 + L). The phase
margin is the phase above -180 degrees where |L| = 1. The gain margin is 1 / |L| where the phase is
-180 degrees modulo 360 (Astrom and Murray, Feedback Systems, 2008, section 9.3). Of several
crossings the closest to instability counts. A loop with integrators may also cross -180 degrees
below its crossover: it then oscillates with less gain, which gives a lower gain margin. The delay
margin is the phase margin over its frequency.

Every loop is opened at its own demand with the others closed: altitude and climb at the vertical
force, heading and yaw rate at the yaw moment, speed at the surge force. With P(z) the response of
all demands to each other, and q the other loops,

    L_i = -(P_ii + P_iq (1 - P_qq)^-1 P_qi)

on z = exp(j w T). A loop whose rotor is at a limit in the steady flight has no linear response,
for example the vertical loop of a vehicle that is not heavier than air. It is left out, with a
reason.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final, Literal

from lta_control.laws.cascade import CascadeGains
from lta_control.motion import Setpoint
from lta_studies.tune.loop_cut import linearize_loop, LinearLoop, LoopCut
from lta_studies.tune.step_response import TuningScene
import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]
Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class StabilityMargins:
    """Stability margins of a loop; None where a margin is unlimited."""

    gain: float | None  # factor by which the gain may rise [1]
    gain_down: float | None  # factor below 1 to which the gain may fall [1]
    phase: float | None  # phase margin [rad]
    delay: float | None  # delay margin [s]
    crossover: float | None  # highest frequency with |L| = 1 [rad/s]
    oscillation: float | None  # frequency of oscillation at the gain limit [rad/s]
    peak: float  # peak sensitivity, the maximum of |1 / (1 + L)| [1]


def compute_margins(frequency: Array, response: Complex) -> StabilityMargins:
    """
    Compute the margins of a loop that is stable when closed.

    `frequency`, shape (n,): increasing, dense enough to unwrap the phase [rad/s]. `response`,
    shape (n,): L(jw).
    """
    size, phase = np.log(np.abs(response)), np.unwrap(np.angle(response))
    log_w = np.log(frequency)
    # Logarithms interpolate |L| well, as it follows powers of the frequency
    gains = [
        (math.exp(-_interpolate(size, *at)), math.exp(_interpolate(log_w, *at)))
        for at in _find_phase_crossings(phase)
    ]
    # Above 1: the gain may rise by it. Below 1: it may fall to it. The closest to 1 counts.
    up = min((each for each in gains if each[0] > 1.0), default=None)
    phases = [
        ((_interpolate(phase, *at) + math.pi) % math.tau, math.exp(_interpolate(log_w, *at)))
        for at in _find_gain_crossings(size)
    ]
    # Instability can also be reached from the other side, by phase lead
    least = min(((min(above, math.tau - above), w) for above, w in phases), default=None)
    return StabilityMargins(
        # `and` passes None on for a margin that does not exist
        gain=up and up[0],
        gain_down=max((factor for factor, _ in gains if factor < 1.0), default=None),
        phase=least and least[0],
        delay=least and least[0] / least[1],
        crossover=phases[-1][1] if phases else None,
        oscillation=up and up[1],
        # Peak of the sensitivity: inverse of the smallest distance to the point -1
        peak=float(1.0 / np.abs(1.0 + response).min()),
    )


def _find_phase_crossings(phase: Array) -> list[tuple[int, float]]:
    """Return the index and fraction of each crossing of -180 degrees modulo 360."""
    # Whole numbers where the phase is -180 degrees modulo 360
    turns = (phase + math.pi) / math.tau
    whole = np.floor(turns)
    return [
        # The whole number between two values is the larger one of theirs
        (int(k), float((whole[k : k + 2].max() - turns[k]) / (turns[k + 1] - turns[k])))
        for k in np.flatnonzero(np.diff(whole))
    ]


def _find_gain_crossings(size: Array) -> list[tuple[int, float]]:
    """Return the index and fraction of each zero crossing of log |L|."""
    # |L| crosses 1 where log |L| changes its sign.
    changes = np.flatnonzero((size[:-1] > 0.0) != (size[1:] > 0.0))
    return [(int(k), float(size[k] / (size[k] - size[k + 1]))) for k in changes]


def _interpolate(values: Array, place: int, share: float) -> float:
    return float(values[place] + share * (values[place + 1] - values[place]))


def to_decibels(factor: float) -> float:
    """Convert an amplitude factor to decibels."""
    return 20.0 * math.log10(factor)


Loop = Literal['altitude', 'heading', 'speed']
DEMAND_INDEX: Final[dict[Loop, int]] = {'speed': 0, 'altitude': 1, 'heading': 2}  # in a demand
STEADY_ALTITUDE = 1.0  # m, of the steady flights
TUNING_CRUISE_SPEED = 0.4  # m/s, the speed of the speed step
FREQUENCY_COUNT = 1200  # frequencies, logarithmically spaced
LOWEST_FREQUENCY = 0.02  # rad/s
STOPPED_THRUST = 1e-6  # N; a rotor with less thrust counts as stopped


@final
@dataclass(frozen=True, slots=True)
class LoopMargins:
    """One loop in one steady flight."""

    loop: Loop
    # Airspeed and lift lost [m/s, kg]
    speed: float
    loss: float
    stable: bool  # whether the whole drone is stable
    # Growth rate and angular frequency of the least damped mode [1/s, rad/s]
    growth: float
    swing: float
    margins: StabilityMargins | None  # None if there are no margins
    why: str = ''  # why there are no margins


def frequency_response(linear: LinearLoop, loop: Loop, frequency: Array) -> Complex:
    """Return L(jw) of one loop with the others closed."""
    z = np.exp(1j * frequency * linear.period)
    own = DEMAND_INDEX[loop]
    others = [place for place in DEMAND_INDEX.values() if place != own]
    # Close the other loops first: A + B_q C_q.
    a = linear.a + linear.b[:, others] @ linear.c[others]
    b, c = linear.b[:, [own]], linear.c[[own]]
    values, left = np.linalg.eig(a)
    # Partial fractions are fast, but need a well-conditioned eigenbasis.
    if np.linalg.cond(left) < 1e10:
        inner = (c @ left) * np.linalg.solve(left, b).T  # residues
        plain = (inner / (z[:, None] - values[None, :])).sum(axis=1)
    else:
        # One linear solve per frequency: slow, but safe with nearly parallel eigenvectors
        eye = np.eye(len(a))
        plain = np.array([(c @ np.linalg.solve(each * eye - a, b))[0, 0] for each in z])
    # The response has the sign u -> y; L is defined for negative feedback.
    return np.asarray(-plain)


def compute_loop_margins(
    scene: TuningScene, gains: CascadeGains, losses: Sequence[float], speeds: Sequence[float]
) -> list[LoopMargins]:
    """Compute the margins of every loop at each loss of lift [kg] and airspeed [m/s]."""
    loop_margins = []
    for loss in losses:
        cut = LoopCut(scene.build_true_vehicle(loss), scene.nominal_vehicle, gains)
        for speed in speeds:
            linear = linearize_loop(cut, Setpoint(STEADY_ALTITUDE, 0.0, speed))
            loop_margins += [
                compute_margins_or_reason(linear, loop, loss, speed) for loop in DEMAND_INDEX
            ]
    return loop_margins


def compute_margins_or_reason(
    linear: LinearLoop, loop: Loop, loss: float, speed: float
) -> LoopMargins:
    """Compute the margins of one loop, or the reason why it has none."""
    why = ''
    # Rotors 0 and 1 are the vertical ones.
    idle = max(linear.thrusts[:2]) < STOPPED_THRUST
    if loop == 'speed' and speed == 0.0:
        why = 'the forward rotors are stopped'
    elif loop == 'altitude' and idle:
        why = 'the vertical rotors are stopped'
    margins = None
    if not why:
        # Just below the Nyquist frequency, where z = -1 can be a pole [rad/s]
        w = np.geomspace(LOWEST_FREQUENCY, 0.999 * math.pi / linear.period, FREQUENCY_COUNT)
        margins = compute_margins(w, frequency_response(linear, loop, w))
    return LoopMargins(
        loop, speed, loss, linear.is_stable, linear.growth_rate, linear.swing, margins, why
    )

"""
Compute the margins of each loop of a vehicle, in hover and cruise, for each loss of lift.

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

from lta_control.cascade import CascadeGains, Setpoint
from lta_studies.tune.linearization import linearize_loop, LinearLoop
from lta_studies.tune.loop_cut import LoopCut
from lta_studies.tune.margins import Array, Complex, compute_margins, StabilityMargins
from lta_studies.tune.step_response import TuningScene
import numpy as np

Loop = Literal['altitude', 'heading', 'speed']
PLACES: Final[dict[Loop, int]] = {'speed': 0, 'altitude': 1, 'heading': 2}  # in a demand
ALTITUDE = 1.0  # m, of the steady flights
CRUISE = 0.4  # m/s, the speed of the speed step
POINTS = 1200  # frequencies, logarithmically spaced
LOWEST = 0.02  # rad/s
IDLE = 1e-6  # N; a rotor with less thrust counts as stopped


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
    own = PLACES[loop]
    others = [place for place in PLACES.values() if place != own]
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
            linear = linearize_loop(cut, Setpoint(ALTITUDE, 0.0, speed))
            loop_margins += [
                compute_margins_or_reason(linear, loop, loss, speed) for loop in PLACES
            ]
    return loop_margins


def compute_margins_or_reason(
    linear: LinearLoop, loop: Loop, loss: float, speed: float
) -> LoopMargins:
    """Compute the margins of one loop, or the reason why it has none."""
    why = ''
    # Rotors 0 and 1 are the vertical ones.
    idle = max(linear.thrusts[:2]) < IDLE
    if loop == 'speed' and speed == 0.0:
        why = 'the forward rotors are stopped'
    elif loop == 'altitude' and idle:
        why = 'the vertical rotors are stopped'
    margins = None
    if not why:
        # Just below the Nyquist frequency, where z = -1 can be a pole [rad/s]
        w = np.geomspace(LOWEST, 0.999 * math.pi / linear.period, POINTS)
        margins = compute_margins(w, frequency_response(linear, loop, w))
    return LoopMargins(
        loop, speed, loss, linear.is_stable, linear.growth_rate, linear.swing, margins, why
    )

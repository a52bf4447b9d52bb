"""
Compute how the thrust of a Crazyflie propeller depends on the speed of flight.

Blade elements in annular momentum theory with Prandtl's tip loss (Leishman, Principles of
Helicopter Aerodynamics, 2006, section 3.3). The blade and its thrust and power at rest are those
that the University of Illinois measured on a Crazyflie's propeller of 45 mm at 19 860 rpm
(UIUC Propeller Data Site, volume 2, cfnq_45p1; Deters, Ananda and Selig, AIAA 2014-2151). It was
measured at rest only. Zero-lift angle and drag of the sections are fitted to these two figures,
for several lift slopes, since none is known at Reynolds numbers of 10 000 to 20 000.

Prints the thrust of GT-MAB's rotors of 47 mm as a share of that at rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
import sys
from typing import Final

from lta_config.constants import AIR_DENSITY
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, least_squares

Array = NDArray[np.float64]
BLADES: Final = 2
# Radius and chord over the tip radius, and blade angle [deg]
BLADE: Final = np.array([
    (0.15, 0.245, 29.2), (0.20, 0.263, 26.8), (0.25, 0.281, 24.6), (0.30, 0.297, 22.9),
    (0.35, 0.316, 21.5), (0.40, 0.333, 20.2), (0.45, 0.349, 19.0), (0.50, 0.363, 18.1),
    (0.55, 0.372, 17.5), (0.60, 0.379, 17.1), (0.65, 0.381, 16.8), (0.70, 0.382, 16.5),
    (0.75, 0.379, 16.1), (0.80, 0.372, 15.7), (0.85, 0.351, 15.6), (0.90, 0.311, 15.9),
    (0.95, 0.228, 15.5), (1.00, 0.046, 11.5),
])  # fmt: skip
AT_REST: Final = (0.1645, 0.1041)  # thrust and power coefficient
LIFT_SLOPES: Final = (3.5, 4.5, 5.5, math.tau)  # [1/rad]; the last is that of a thin plate
DIAMETER: Final = 0.047  # of GT-MAB's rotors [m]
# Thrust at rest [N] and speed along the axis [m/s]: full duty, and what cruise takes
CASES: Final = ((0.159, 0.5), (0.159, 0.76), (0.03, 0.5), (0.02, 0.5), (0.01, 0.5))

RADII: Final = np.linspace(0.15, 0.995, 120)
CHORDS: Final = np.interp(RADII, BLADE[:, 0], BLADE[:, 1])
ANGLES: Final = np.radians(np.interp(RADII, BLADE[:, 0], BLADE[:, 2]))


@dataclass(frozen=True, slots=True)
class Section:
    """Lift and drag of the blade's sections."""

    lift_slope: float  # [1/rad]
    zero_lift: float  # angle of attack without lift [rad]
    drag: float  # coefficient


def compute_coefficients(section: Section, advance: float) -> tuple[float, float]:
    """
    Return the coefficients of thrust and power at an advance ratio V / (n D).

    Computed with a tip radius, an angular velocity and an air density of 1.
    """
    speed = advance / math.pi

    def blade_loads(induced: Array) -> tuple[Array, Array, Array]:
        """Return thrust and torque by radius, and the thrust by the momentum of the air."""
        axial = speed + induced
        inflow = np.arctan2(axial, RADII)
        pressure = 0.5 * (axial**2 + RADII**2) * BLADES * CHORDS
        lift = section.lift_slope * (ANGLES - inflow - section.zero_lift)
        thrust = pressure * (lift * np.cos(inflow) - section.drag * np.sin(inflow))
        torque = pressure * (lift * np.sin(inflow) + section.drag * np.cos(inflow)) * RADII
        edge = 0.5 * BLADES * (1.0 - RADII) / (RADII * np.sin(inflow) + 1e-9)
        tip_loss = 2.0 / math.pi * np.arccos(np.exp(-edge))
        return thrust, torque, 4.0 * math.pi * RADII * axial * induced * tip_loss

    # Blade and air agree on the thrust of each annulus; bisection, as the difference is monotonic
    low, high = np.zeros_like(RADII), np.ones_like(RADII)
    for _ in range(60):
        middle = 0.5 * (low + high)
        thrust, _, momentum = blade_loads(middle)
        more = thrust > momentum
        low, high = np.where(more, middle, low), np.where(more, high, middle)
    thrust, torque, _ = blade_loads(low)
    step, rate, diameter = RADII[1] - RADII[0], 1.0 / math.tau, 2.0
    force, moment = float(thrust.sum() * step), float(torque.sum() * step)
    return force / (rate**2 * diameter**4), moment / (rate**2 * diameter**5) * math.tau


def fit_section(lift_slope: float) -> Section:
    """Return the section with which the rotor has the measured thrust and power at rest."""

    def miss(values: Array) -> Array:
        return np.subtract(compute_coefficients(Section(lift_slope, *values), 0.0), AT_REST)

    return Section(lift_slope, *least_squares(miss, [0.0, 0.05]).x)


def thrust_shares(section: Section, thrust: float, speed: float) -> tuple[float, float, float]:
    """
    Return the advance ratio, and the share of the thrust at rest that is left in flight.

    The first share is that of a rotor that keeps its rotation rate, the second that of one that
    keeps its power.
    """
    per_rate = AT_REST[0] * AIR_DENSITY * DIAMETER**4
    rate = math.sqrt(thrust / per_rate)
    advance = speed / (rate * DIAMETER)
    by_rate = compute_coefficients(section, advance)[0] / AT_REST[0]

    def excess_power(factor: float) -> float:
        return compute_coefficients(section, advance / factor)[1] * factor**3 - AT_REST[1]

    factor = float(brentq(excess_power, 0.8, 1.5))
    by_power = compute_coefficients(section, advance / factor)[0] * factor**2 / AT_REST[0]
    return advance, by_rate, by_power


def describe_share(shares: Sequence[float]) -> str:
    """Return the range of a share over the lift slopes."""
    return f'{min(shares):.3f} to {max(shares):.3f}'


def main() -> None:
    """Print the table."""
    sections = [fit_section(slope) for slope in LIFT_SLOPES]
    for thrust, speed in CASES:
        rows = [thrust_shares(section, thrust, speed) for section in sections]
        advance, by_rate, by_power = zip(*rows, strict=True)
        sys.stdout.write(
            f'{1e3 * thrust:.0f} mN at rest, {speed:.2f} m/s, advance ratio {advance[0]:.3f}: '
            f'{describe_share(by_rate)} of it at the same rate, '
            f'{describe_share(by_power)} at the same power\n'
        )


if __name__ == '__main__':
    main()

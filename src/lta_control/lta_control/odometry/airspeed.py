"""
Estimate the planar airspeed from acceleration and the drag model.

Integrated acceleration alone drifts. If it is damped towards zero, the estimate decays in steady
flight and a speed loop closed on it runs away. The filter therefore damps towards the speed that
the drag model predicts for the commanded thrust. In wind this is the speed through the air:
ground speed is not observable with these sensors.
"""

from typing import NamedTuple


class HullDragModel(NamedTuple):
    """Drag and inertia of the vehicle along body x and y, about the hull centre."""

    mass: tuple[float, float]  # mass including the added mass [kg]
    # Drag coefficients [N s/m], [N s2/m2]
    linear: tuple[float, float]
    quadratic: tuple[float, float]


class AirspeedEstimate(NamedTuple):
    """Estimated and modelled velocity along body x and y. [m/s]."""

    surge: float = 0.0
    sway: float = 0.0
    model_surge: float = 0.0
    model_sway: float = 0.0


def _axis_drag(hull: HullDragModel, axis: int, speed: float) -> float:
    return (hull.linear[axis] + hull.quadratic[axis] * abs(speed)) * speed


def airspeed_step(
    hull: HullDragModel,
    state: AirspeedEstimate,
    force: tuple[float, float],
    acceleration: tuple[float, float],
    yaw_rate: float,
    trust: float,
    dt: float,
) -> AirspeedEstimate:
    """
    Return the airspeed one step later.

    `force` is the rotor force from the commanded duties [N] and `acceleration` the measured
    acceleration without gravity [m/s2], both along body x and y. `trust` is the time constant
    with which the estimate returns to the model [s].
    """
    surge, sway, model_surge, model_sway = state
    mx, my = hull.mass
    # Coriolis terms: the body frame turns under the velocity.
    model_x = (force[0] - _axis_drag(hull, 0, model_surge) + my * yaw_rate * model_sway) / mx
    model_y = (force[1] - _axis_drag(hull, 1, model_sway) - mx * yaw_rate * model_surge) / my
    # Measured acceleration plus a pull towards the model
    rate_x = acceleration[0] + yaw_rate * sway + (model_surge - surge) / trust
    rate_y = acceleration[1] - yaw_rate * surge + (model_sway - sway) / trust
    return AirspeedEstimate(
        surge + dt * rate_x,
        sway + dt * rate_y,
        model_surge + dt * model_x,
        model_sway + dt * model_y,
    )

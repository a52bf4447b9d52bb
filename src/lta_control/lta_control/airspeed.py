"""
Planar velocity through the air, from acceleration and the drag model.

Integrated acceleration alone drifts; damped, it decays to zero at a steady speed, and a loop
closed on it runs away to full speed. So the damping pulls towards the speed that the drag model
gives for the commanded thrust. In wind this is the speed through the air: ground speed is not
observable with these sensors.
"""

from typing import NamedTuple


class HullDragModel(NamedTuple):
    """
    What the drag model knows of the vehicle, about the hull centre.

    Attributes
    ----------
    mass : tuple of float
        Inertia along body x and y with the added mass. [kg]
    linear, quadratic : tuple of float
        Drag along body x and y. [N s/m], [N s2/m2]

    """

    mass: tuple[float, float]
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
    Return the velocity one step later.

    Parameters
    ----------
    hull : Hull
        The drag model.
    state : Airspeed
        Before the step.
    force : tuple
        Rotor force along body x and y, from the commanded duties. [N]
    acceleration : tuple
        Measured acceleration along body x and y, gravity removed. [m/s2]
    yaw_rate : float
        Turns the body under the velocity. [rad/s]
    trust : float
        Time over which the accelerometer is believed before the model wins. [s]
    dt : float
        Time step. [s]

    """
    surge, sway, model_surge, model_sway = state
    mx, my = hull.mass
    model_x = (force[0] - _axis_drag(hull, 0, model_surge) + my * yaw_rate * model_sway) / mx
    model_y = (force[1] - _axis_drag(hull, 1, model_sway) - mx * yaw_rate * model_surge) / my
    rate_x = acceleration[0] + yaw_rate * sway + (model_surge - surge) / trust
    rate_y = acceleration[1] - yaw_rate * surge + (model_sway - sway) / trust
    return AirspeedEstimate(
        surge + dt * rate_x,
        sway + dt * rate_y,
        model_surge + dt * model_x,
        model_sway + dt * model_y,
    )

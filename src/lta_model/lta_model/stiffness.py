"""
Check that the time step is short enough for the explicit integrator.

Linear damping makes the velocity decay at the eigenvalues of M^-1 D, with M the mass matrix and D
the damping about the hull centre. RK4 is unstable where one of them times the step exceeds its
limit. Contact springs are far softer than that within their bounds. Damping that grows with the
speed is not checked here: the world watches for divergence during the flight.
"""

from collections.abc import Sequence

from lta_config.errors import BadInput
from lta_model.effects.protocol import AXES
from lta_model.model import VehicleModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEP_NS = 2_500_000  # integration step; the shortest time constant of a shipped vehicle is 72 ms
RK4_LIMIT = 2.7  # longest stable step of RK4 by a time constant: 2.785, less a margin
SPEED_LIMIT = 1000.0  # m/s and rad/s; only a diverged simulation gets there


def find_fastest_damping(model: VehicleModel) -> tuple[str, float]:
    """Return the effect with the fastest linear damping and its rate; '' and 0 if none. [1/s]"""
    inverse = model.inverse.reshape(6, 6)
    rates = {
        name: float(np.linalg.eigvals(inverse @ damping).real.max())
        for name, damping in compute_linear_damping(model).items()
    }
    return max(rates.items(), key=lambda item: item[1], default=('', 0.0))


def compute_linear_damping(model: VehicleModel) -> dict[str, Array]:
    """Return the damping of each effect that is linear in the velocity. [N s/m, N m s]"""
    damping_by_effect = {}
    values = model.effect_parameters
    for name, axes in (('linear_drag', slice(0, 3)), ('rotational_drag', slice(3, 6))):
        if name in values:
            damping = np.zeros(6)
            # Only the linear coefficients: quadratic damping depends on the speed
            damping[axes] = [values[name][axis] for axis in AXES[axes]]
            damping_by_effect[name] = np.diag(damping)
    if 'floor_contact' in values:
        foot = values['floor_contact']
        # Jacobian of the foot's vertical velocity for an upright vehicle
        down = np.array([0.0, 0.0, 1.0, foot['y'], -foot['x'], 0.0])  # upright
        damping_by_effect['floor_contact'] = (
            foot['stiffness'] * foot['relaxation'] * np.outer(down, down)
        )
    if 'walls' in values:
        room = values['walls']
        push = room['stiffness'] * room['relaxation']
        damping_by_effect['walls'] = np.diag([push, push, push, 0.0, 0.0, 0.0])
    return damping_by_effect


def check_time_step(name: str, model: VehicleModel, step: float) -> None:
    """Raise `BadInput` for a time step [s] above 2.7 times the fastest damping time constant."""
    effect, rate = find_fastest_damping(model)
    if rate * step > RK4_LIMIT:
        raise BadInput(
            f'The effect {effect} of {name} damps motion within {1e3 / rate:.3g} ms, too '
            f'fast for the simulation time step of {1e3 * step:g} ms; make its damping '
            f'{rate * step / RK4_LIMIT:.2g} times weaker.'
        )


def has_diverged(state: Sequence[float]) -> bool:
    """Return whether a velocity or rate of a state is not finite or implausible."""
    # Velocity is state[7:10] and rates are state[10:13]; NaN compares false. Written out, because
    # compiled code has no generic tuples.
    return not (
        abs(state[7]) < SPEED_LIMIT and abs(state[8]) < SPEED_LIMIT
        and abs(state[9]) < SPEED_LIMIT and abs(state[10]) < SPEED_LIMIT
        and abs(state[11]) < SPEED_LIMIT and abs(state[12]) < SPEED_LIMIT
    )  # fmt: skip


def build_divergence_error(name: str, elapsed: float) -> BadInput:
    """Return the error for a diverged flight. [s after the start]"""
    return BadInput(
        f'The simulation of {name} diverged {elapsed:.2f} s after the start, probably because '
        'one of its effects is too strong for its mass or inertia; check the values under '
        'effects in the vehicle file.'
    )

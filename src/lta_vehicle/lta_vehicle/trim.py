# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate and report the heaviness of a vehicle from the rotor duties of a hover.

At constant height the rotors carry the weight that the gas does not. Over an interval of time T,
with z the map's vertical, R the attitude and w the climb rate,

    m_h g T = int (R B T(u))_z dt - int (R D(v))_z dt - (m + A_z) (w_end - w_begin)

where B T(u) is the rotor force at the duties u after the motor lag, D the drag along the body axes
in still air, and m + A_z the mass including the added mass. The estimate m_h is the mean over
intervals of two seconds without fast flight or climb. Its error follows from their scatter
(Student's t, 95 %; the intervals are taken as independent).

An error of the thrust curve cannot be separated: it enters m_h in full. For a vehicle that is
commanded by a wrench, the commanded force after `wrench_gain` takes the place of B T(u), and an
error of that gain enters.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_data.even_grid import check_time_span
from lta_model.effect_parameters import Effects, OTHER_CURVES
from lta_model.effects import EFFECTS
from lta_model.measurement_chain import apply_chain, build_chains
from lta_model.vehicle import Vehicle
from lta_vehicle.flight_record import Array, RotorCommands, VehiclePath, WrenchCommands
import numpy as np
from scipy.special import stdtrit

STRETCH: Final = 2.0  # s, length of an interval
CALM_CLIMB: Final = 0.05  # m/s, mean over a stretch
CALM_SPEED: Final = 0.4  # m/s over the ground; drag is subtracted, but uncertain
FEWEST_HOVERS: Final = 3  # intervals needed for an estimate of the scatter
SMOOTHING_TIME: Final = 0.3  # s; window of the fit that gives velocities
CONFIDENCE: Final = 0.95
# The Crazyflie constants a, b that the shipped files use, against Bitcraze's bench table.
CURVE_ERROR: Final = 0.0029  # N rms a rotor


@final
@dataclass(frozen=True, slots=True)
class HeavinessEstimate:
    """Heaviness of a vehicle as estimated from a flight."""

    heaviness: float  # mass less displaced air [kg]
    error: float  # half of the 95 % interval, from the scatter of the intervals [kg]
    curve_error: float  # uncertainty by the thrust curve (1 sigma) [kg]
    declared: float  # heaviness by the vehicle file [kg]
    duration: float  # total time of the intervals used [s]
    duty: float | None  # mean duty of the rotors that lift; None for a commanded wrench [1]
    force: float | None = None  # mean upward force of a commanded wrench; None for duties [N]

    @property
    def ballast_change(self) -> float:
        """Ballast to add to reach the declared heaviness; negative to remove [kg]."""
        return self.declared - self.heaviness


def estimate_heaviness(
    vehicle: Vehicle, path: VehiclePath, commands: RotorCommands | WrenchCommands
) -> HeavinessEstimate:
    """
    Estimate the heaviness of a vehicle in a flight.

    Mass, drag, thrust curve and declared heaviness are those of the vehicle file.

    Raise `BadInput` if the vehicle did not hover for long enough.
    """
    grid = _build_time_grid(path, commands)
    velocity = _estimate_velocity(path, grid)
    rotation = _rotation_matrices(path, grid)
    if isinstance(commands, WrenchCommands):
        up = _vertical_command(vehicle, commands, grid, rotation)
    else:
        up = _vertical_thrust(vehicle, commands, grid, rotation)
    driven = up.copy()
    up -= _vertical_drag(vehicle, velocity, rotation)
    flying = abs(_sample_commands(commands, grid)).max(axis=1) > 0.0
    # Vertical acceleration also moves the added mass of the air
    rising = vehicle.mass + vehicle.added_mass[2]
    # Samples per interval; the grid is even
    length = max(2, round(STRETCH / (grid[1] - grid[0])))
    samples = []
    stretches = []
    for first in range(0, len(grid) - length, length):
        part = slice(first, first + length + 1)
        # Skip intervals on the ground and in fast flight, where the drag is uncertain
        if not flying[part].all() or not _is_calm(velocity[part]):
            continue
        took = grid[first + length] - grid[first]
        # The change of vertical momentum is thrust that did not carry weight.
        gained = rising * (velocity[first + length, 2] - velocity[first, 2]) / took
        samples.append((float(up[part].mean()) - gained) / STANDARD_GRAVITY)
        stretches.append(part)
    if len(samples) < FEWEST_HOVERS:
        raise BadInput(
            f'The flight has only {STRETCH * len(samples):.0f} s of hover (climb rate '
            f'below {CALM_CLIMB:g} m/s, ground speed below {CALM_SPEED:g} m/s); let the '
            'vehicle hover in still air for at least 20 s.'
        )
    if isinstance(commands, WrenchCommands):
        force = float(np.concatenate([driven[part] for part in stretches]).mean())
        return _summarize_samples(vehicle, samples, 0.0, None, force)
    return _estimate_from_samples(vehicle, samples, commands, grid, stretches)


def _estimate_from_samples(
    vehicle: Vehicle,
    samples: Sequence[float],
    commands: RotorCommands,
    grid: Array,
    stretches: list[slice],
) -> HeavinessEstimate:
    lifts = [max(rotor.column[2], 0.0) for rotor in vehicle.rotors]
    # Rotors that push mostly upwards; all of them where none does.
    busy = [i for i, lift in enumerate(lifts) if lift > 0.5] or list(range(len(lifts)))
    duties = np.concatenate([_sample_commands(commands, grid)[part] for part in stretches])
    # Errors of the thrust curves are taken as independent between rotors.
    curve = CURVE_ERROR * math.sqrt(sum(lifts[i] ** 2 for i in busy)) / STANDARD_GRAVITY
    return _summarize_samples(vehicle, samples, curve, float(duties[:, busy].mean()), None)


def _summarize_samples(
    vehicle: Vehicle,
    samples: Sequence[float],
    curve_error: float,
    duty: float | None,
    force: float | None,
) -> HeavinessEstimate:
    values = np.array(samples)
    spread = float(values.std(ddof=1)) / math.sqrt(len(values))
    # Quantile of Student's t for a two-sided interval
    factor = float(stdtrit(len(values) - 1, 0.5 + 0.5 * CONFIDENCE))
    return HeavinessEstimate(
        heaviness=float(values.mean()),
        error=factor * spread,
        curve_error=curve_error,
        declared=vehicle.heaviness,
        duration=STRETCH * len(values),
        duty=duty,
        force=force,
    )


def _is_calm(velocity: Array) -> bool:
    mean = velocity.mean(axis=0)
    return abs(mean[2]) < CALM_CLIMB and math.hypot(mean[0], mean[1]) < CALM_SPEED


def _build_time_grid(path: VehiclePath, commands: RotorCommands | WrenchCommands) -> Array:
    """Return an even grid over the commands that lie within the path."""
    if len(path.time) > 1:
        step = float(np.median(np.diff(path.time)))
        check_time_span('of the poses', float(np.ptp(path.time)), step, len(path.time))
    inside = (commands.time >= path.time[0]) & (commands.time <= path.time[-1])
    grid = commands.time[inside]
    if len(grid) < FEWEST_HOVERS or len(path.time) < FEWEST_HOVERS:
        raise BadInput(
            'The recording has too few motor commands or poses; record the topics motors and '
            'odom for the whole flight.'
        )
    # Replace jittering stamps by an even grid of the same mean rate
    return np.linspace(grid[0], grid[-1], len(grid))


def _estimate_velocity(path: VehiclePath, grid: Array) -> Array:
    """Return the velocity at the grid times, by a line fit to the poses around each."""
    step = float(np.median(np.diff(path.time)))
    uniform = np.arange(path.time[0], path.time[-1], step)
    half = max(1, round(min(0.5 * SMOOTHING_TIME / step, len(uniform) / 2)))
    # Least-squares slope over an odd window, as a convolution.
    weights = np.arange(-half, half + 1) / (step * sum(k * k for k in range(-half, half + 1)))
    velocity = np.zeros((len(grid), 3))
    for axis in range(3):
        even = np.interp(uniform, path.time, path.place[:, axis])
        # Point reflection at both ends keeps the slope there.
        padded = np.concatenate(
            [2 * even[0] - even[half:0:-1], even, 2 * even[-1] - even[-2 : -half - 2 : -1]]
        )
        # `convolve` flips its kernel; flip it back
        slope = np.convolve(padded, weights[::-1], mode='valid')
        velocity[:, axis] = np.interp(grid, uniform, slope)
    return velocity


def _rotation_matrices(path: VehiclePath, grid: Array) -> Array:
    """Return the rotations from body to map at the grid times, shape (n, 3, 3)."""
    nearest = np.clip(np.searchsorted(path.time, grid), 0, len(path.time) - 1)
    # The next recorded attitude is close enough: in hover it hardly changes between poses
    x, y, z, w = path.attitude[nearest].T
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], axis=-1),
            np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], axis=-1),
            np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=-1),
        ],
        axis=1,
    )


def _sample_commands(commands: RotorCommands | WrenchCommands, grid: Array) -> Array:
    """Return the duties or forces at the grid times; each command holds until the next."""
    index = np.clip(np.searchsorted(commands.time, grid, side='right') - 1, 0, None)
    table = commands.force if isinstance(commands, WrenchCommands) else commands.duties
    return table[index]


def _vertical_command(
    vehicle: Vehicle, commands: WrenchCommands, grid: Array, rotation: Array
) -> Array:
    """Return the commanded force along the vertical of the map, after its gains [N]."""
    inputs = (*_sample_commands(commands, grid).T, *np.zeros((3, len(grid))))
    chain = build_chains(vehicle.collect_effects(), EFFECTS)['command_wrench']
    acting = apply_chain(chain, inputs, 0.0)[:3]
    return np.asarray(np.einsum('nj,jn->n', rotation[:, 2], np.stack(acting)))


def _vertical_thrust(
    vehicle: Vehicle, commands: RotorCommands, grid: Array, rotation: Array
) -> Array:
    """Return the rotor force along the vertical of the map [N]."""
    duties = _sample_commands(commands, grid)
    effects = vehicle.collect_effects()
    _refuse_other_curves(vehicle, effects)
    scale = effects.get('thrust_scale', {}).get('factor', 1.0)
    lag = effects.get('motor_lag', {})
    up, down = lag.get('up', 0.0), lag.get('down', 0.0)
    body = np.zeros((len(grid), 3))
    thrusts = []
    for rotor, duty in zip(vehicle.rotors, duties.T, strict=True):
        turning = _apply_motor_lag(duty, grid, up, down)
        # T = a u^2 + b |u|, with the sign of the duty
        thrust = scale * np.sign(turning) * (rotor.a * turning**2 + rotor.b * abs(turning))
        thrusts.append(thrust)
        forward, reverse = np.array(rotor.column[:3]), np.array(rotor.reverse[:3])
        body += np.where(
            thrust[:, None] >= 0.0, thrust[:, None] * forward, thrust[:, None] * reverse
        )
    coupling = vehicle.file.aero.coupling
    if coupling:
        # Colliding jets: the weaker rotor of the group limits the coupling force.
        sign = -1.0 if coupling.reversed else 1.0
        names = [rotor.name for rotor in vehicle.rotors]
        shares = [np.maximum(sign * thrusts[names.index(name)], 0.0) for name in coupling.rotors]
        body += np.min(shares, axis=0)[:, None] * np.array(coupling.force.vector)
    # The third row of R maps body axes to the map's vertical
    return np.asarray(np.einsum('nj,nj->n', rotation[:, 2], body))


def _refuse_other_curves(vehicle: Vehicle, effects: Effects) -> None:
    """Raise `BadInput` if the thrust depends on more than the duty."""
    if other := [name for name in OTHER_CURVES if name in effects]:
        raise BadInput(
            f'The thrust of {vehicle.file.name} is computed by the effect {other[0]}, '
            'which needs data that a recording does not contain; use a thrust_curve in '
            'the vehicle file instead.'
        )


def _apply_motor_lag(target: Array, grid: Array, up: float, down: float) -> Array:
    """Return the duty after a first-order motor lag; time constants up and down in s."""
    if up <= 0.0 and down <= 0.0:
        return target
    step = float(grid[1] - grid[0])
    # Exact discretisation of a first-order lag for a duty that holds during the step
    gain_up, gain_down = (1.0 - math.exp(-step / c) if c > 0.0 else 1.0 for c in (up, down))
    now, out = float(target[0]), np.empty_like(target)
    for k, aim in enumerate(target):
        out[k] = now
        now += (gain_up if abs(aim) > abs(now) else gain_down) * (float(aim) - now)
    return out


def _vertical_drag(vehicle: Vehicle, velocity: Array, rotation: Array) -> Array:
    """Return the drag in still air along the vertical of the map, positive downwards [N]."""
    effects = vehicle.collect_effects()
    axes = ('surge', 'sway', 'heave')
    linear = np.array([effects['linear_drag'][axis] for axis in axes])
    quadratic = np.array([effects['quadratic_drag'][axis] for axis in axes])
    # R transposed: map to body axes
    body = np.einsum('nij,ni->nj', rotation, velocity)
    force = (linear + quadratic * abs(body)) * body
    return np.asarray(np.einsum('nj,nj->n', rotation[:, 2], force))


GRAMS = 1e3
SMALLEST_BALLAST_CHANGE = 0.05  # g; smaller changes of ballast are not practical


def describe_heaviness(estimate: HeavinessEstimate, name: str, simulated: bool) -> str:
    """
    Describe the estimated heaviness and the ballast to add or remove.

    `simulated`: whether the flight was simulated with the same thrust curve, which then has no
    error.
    """
    grams, error = GRAMS * estimate.heaviness, GRAMS * estimate.error
    heavy = 'heavier' if grams >= 0.0 else 'lighter'
    lines = [
        f'{name} was {abs(grams):.2f} g {heavy} than air, '
        f'\N{PLUS-MINUS SIGN} {error:.2f} g (95 %), from {estimate.duration:.0f} s of hover '
        f'at {_describe_effort(estimate)}.',
        _suggest_ballast(GRAMS * estimate.ballast_change, GRAMS * estimate.declared, error),
    ]
    if estimate.force is not None:
        lines.append(
            'An error in the gain of the commanded force adds to that; lta calibrate '
            'estimates the gain.'
        )
    elif not simulated:
        lines.append(
            f'The thrust curve adds an error of about {GRAMS * estimate.curve_error:.1f} '
            'g, if it is as accurate as that of a Crazyflie motor (2.9 mN rms per rotor).'
        )
    return '\n'.join(lines)


def _describe_effort(estimate: HeavinessEstimate) -> str:
    """Return the mean effort of the hover in words."""
    if estimate.duty is not None:
        return f'a duty of {100.0 * estimate.duty:.1f} %'
    return f'a force of {GRAMS * (estimate.force or 0.0):.1f} mN'


def _suggest_ballast(add: float, declared: float, error: float) -> str:
    """Return advice on the ballast; masses in g."""
    target = f'to reach trim.heaviness of the vehicle file ({declared:.2f} g)'
    if abs(add) < SMALLEST_BALLAST_CHANGE:
        return (
            f'This matches trim.heaviness of the vehicle file ({declared:.2f} g): leave the '
            'ballast as it is.'
        )
    action = f'Add {add:.2f} g' if add > 0.0 else f'Remove {-add:.2f} g'
    doubt = ' This is less than the error of the estimate: let the vehicle hover longer.'
    return f'{action} of ballast {target}.{doubt if abs(add) < error else ""}'


def encode_heaviness(estimate: HeavinessEstimate) -> dict[str, float | str | None]:
    """Return the estimate for JSON, masses in kg."""
    # The error is a 95 % interval, about two sigma.
    total = math.hypot(estimate.error / 2.0, estimate.curve_error)
    return {
        'heaviness': estimate.heaviness,
        'error': estimate.error,
        'thrust_curve_error': estimate.curve_error,
        'total_sigma': total,
        'declared': estimate.declared,
        'add': estimate.ballast_change,
        'duration': estimate.duration,
        'duty': estimate.duty,
        **({} if estimate.force is None else {'force': estimate.force}),
        'unit': 'kg',
    }

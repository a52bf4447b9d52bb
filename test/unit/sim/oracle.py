"""
The model once more, slow and obvious: vectors, cross products and a linear solve.

It balances forces on the centre of gravity and moments about it (Newton and Euler), where the
kernel balances momentum about the hull centre; the two share no line.
"""

import numpy as np
from scipy.spatial.transform import Rotation

AXES = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')


def six(given, effect):
    return np.array([given.get(effect, {}).get(axis, 0.0) for axis in AXES])


def gravity(given, rotation, mass, cg, displaced):
    p = given.get('weight_and_buoyancy', {})
    down = rotation.T @ np.array([0.0, 0.0, -p.get('gravity', 0.0)])
    weight = mass * down
    return np.concatenate([weight - displaced * down, np.cross(cg, weight)])


def drag(given, airspeed, rates):
    p = given.get('rotational_drag', {})
    linear, quadratic = six(given, 'linear_drag'), six(given, 'quadratic_drag')
    linear[3:] = [p.get(axis, 0.0) for axis in AXES[3:]]
    quadratic[3:] = [p.get(f'{axis}_2', 0.0) for axis in AXES[3:]]
    speed = np.concatenate([airspeed, rates])
    return -linear * speed - quadratic * speed * abs(speed)


def thrust(given, duty):
    p, curve = given.get('rotor_thrust', {}), given.get('thrust_curve', {})
    total = np.zeros(6)
    for i in range(4):
        newtons = curve.get(f'a_{i + 1}', 0.0) * duty[i] ** 2 * np.sign(duty[i])
        newtons += curve.get(f'b_{i + 1}', 1.0) * duty[i]
        total += newtons * np.array([p.get(f'{axis}_{i + 1}', 0.0) for axis in AXES])
    return total


def floor(given, position, rotation, velocity, rates):
    p = given.get('floor_contact', {})
    foot = np.array([p.get('x', 0.0), p.get('y', 0.0), p.get('z', 0.0)])
    place = position + rotation @ foot
    speed = rotation @ (velocity + np.cross(rates, foot))
    if place[2] >= 0.0:
        return np.zeros(6)
    push = -place[2] - p.get('relaxation', 0.0) * speed[2]
    normal = p.get('stiffness', 0.0) * max(push, 0.0)
    slip = np.array([speed[0], speed[1], 0.0])
    friction = -p.get('friction', 0.0) * normal * slip / np.sqrt(slip @ slip + 0.05**2)
    force = rotation.T @ (friction + np.array([0.0, 0.0, normal]))
    return np.concatenate([force, np.cross(foot, force)])


def motors(given, memory, duty):
    p = given.get('motor_lag', {})
    if not p:
        return duty, np.zeros_like(duty)
    faster = (abs(duty) > abs(memory)) & (duty * memory >= 0.0)
    tau = np.where(faster, p['up'], p['down'])
    return memory, (duty - memory) / tau


def balance(acceleration, forces, body, motion, wind_body):
    """Return force and moment about the CG that are left over at a trial acceleration."""
    (mass, cg, inertia, added), (v, w) = body, motion
    v_dot, w_dot = acceleration[:3], acceleration[3:]
    v_r = v - wind_body
    v_r_dot = v_dot + np.cross(w, wind_body)
    air = added[:3] * v_r
    air_force = -(added[:3] * v_r_dot + np.cross(w, air))
    spin = added[3:] * w
    air_moment = -(added[3:] * w_dot + np.cross(w, spin) + np.cross(v_r, air))
    force = forces[:3] + air_force
    moment = forces[3:] + air_moment - np.cross(cg, force)
    a_cg = v_dot + np.cross(w, v) + np.cross(w_dot, cg) + np.cross(w, np.cross(w, cg))
    return np.concatenate(
        [
            force - mass * a_cg,
            moment - inertia @ w_dot - np.cross(w, inertia @ w),
        ]
    )


def derivative(state, given, mass, cg, inertia, displaced, duty, wind):
    """Return d/dt of a rigid state and four lagged duties, for parameters by effect and name."""
    position, q, v, w, memory = np.split(state, [3, 7, 10, 13])
    rotation = Rotation.from_quat(q).as_matrix()
    wind_body = rotation.T @ np.asarray(wind)
    turning, memory_rate = motors(given, memory, np.asarray(duty))
    forces = gravity(given, rotation, mass, np.asarray(cg), displaced)
    forces = forces + drag(given, v - wind_body, w) + thrust(given, turning)
    forces = forces + floor(given, position, rotation, v, w)
    added = six(given, 'added_mass') + six(given, 'added_inertia')
    body = (mass, np.asarray(cg), np.asarray(inertia), added)
    rest = balance(np.zeros(6), forces, body, (v, w), wind_body)
    columns = [balance(unit, forces, body, (v, w), wind_body) - rest for unit in np.eye(6)]
    acceleration = np.linalg.solve(np.transpose(columns), -rest)
    x, y, z, s = q
    vector = 0.5 * (s * w + np.cross([x, y, z], w))
    q_rate = [*vector, -0.5 * np.dot([x, y, z], w)]
    return np.concatenate([rotation @ v, q_rate, acceleration, memory_rate])


def advance(state, dt, steps, *vehicle):
    """Return the state after classical Runge-Kutta steps."""
    for _ in range(steps):
        a = derivative(state, *vehicle)
        b = derivative(state + 0.5 * dt * a, *vehicle)
        c = derivative(state + 0.5 * dt * b, *vehicle)
        d = derivative(state + dt * c, *vehicle)
        state = state + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        state[3:7] /= np.linalg.norm(state[3:7])
    return state

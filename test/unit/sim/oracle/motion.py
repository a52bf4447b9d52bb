# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
All effects together: Newton and Euler, forces about the centre of gravity.

The kernel balances momentum about the hull centre; this balances forces on the centre of gravity
and moments about it, and solves for the acceleration at which nothing is left over.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from .air import AIR
from .body import BODY, INERTIA
from .contacts import CONTACTS
from .hull import HULL
from .jets import JETS
from .lift import LIFT
from .parameters import Body, Given, Scene
from .rotors import ROTORS
from .wings import WINGS

WRENCHES = LIFT | HULL | WINGS | JETS | CONTACTS
KNOWN = AIR | ROTORS | WRENCHES | BODY | INERTIA


class Vehicle:
    """A vehicle: parameters by effect and name, and what they are added to."""

    def __init__(self, given, mass, cg, inertia, displaced, rotors=()):
        self.given = {name: Given(values) for name, values in given.items()}
        state = (mass, np.array(cg), np.array(inertia), displaced)
        for name, change in BODY.items():
            if name in given:
                state = change(self.given[name], *state)
        added = sum((INERTIA[name](self.given[name]) for name in INERTIA if name in given), 0.0)
        geometry = np.zeros((8, 2, 3))
        geometry[: len(rotors)] = rotors
        added = added + np.zeros(6)
        self.body = Body(*state, added, geometry[:, 0], geometry[:, 1])

    def on(self, known):
        """Return the effects of a kind that this vehicle has, in their order."""
        return [(name, known[name], self.given[name]) for name in known if name in self.given]


def balance(acceleration, forces, scene, flow):
    """
    Return force and moment about the CG that are left over at a trial acceleration.

    Air that accelerates by `flow` (in map) pushes as on the air in the hull's place, and the
    added mass goes with the acceleration relative to it.
    """
    body, v, w = scene.body, scene.velocity, scene.rates
    v_dot, w_dot = acceleration[:3], acceleration[3:]
    wind, push = scene.turn.T @ scene.wind, scene.turn.T @ flow
    v_r = v - wind
    v_r_dot = v_dot + np.cross(w, wind) - push
    a_1, a_2 = body.added[:3], body.added[3:]
    air_force = body.displaced * push - a_1 * v_r_dot - np.cross(w, a_1 * v_r)
    air_moment = -(a_2 * w_dot + np.cross(w, a_2 * w) + np.cross(v_r, a_1 * v_r))
    force = forces[:3] + air_force
    moment = forces[3:] + air_moment - np.cross(body.cg, force)
    swing = np.cross(w_dot, body.cg) + np.cross(w, np.cross(w, body.cg))
    a_cg = v_dot + np.cross(w, v) + swing
    return np.concatenate(
        [
            force - body.mass * a_cg,
            moment - body.inertia @ w_dot - np.cross(w, body.inertia @ w),
        ]
    )


def look(state, vehicle, places, command, around):
    """Return scene, flow, thrusts, wrench by effect, and rates of the memory in their places."""
    position, q, v, w, _ = np.split(state, [3, 7, 10, 13])
    turn = Rotation.from_quat(q).as_matrix()
    wind, noise, irradiance, voltage = around[:3], around[3:6], around[6], around[7]
    scene = Scene(
        position, turn, v, w, vehicle.body, command[:8], command[8:11], np.array(wind), noise,
        irradiance, voltage,
    )  # fmt: skip
    rates, flow = np.zeros(state.size), np.array(around[8:11])
    for name, effect, p in vehicle.on(AIR):
        blow, change, rate = effect(p, state[places[name]], scene)
        scene.wind, flow = scene.wind + blow, flow + change
        rates[places[name]] = rate
    thrusts = np.array(scene.duties)
    for name, effect, p in vehicle.on(ROTORS):
        kept = state[places[name]].reshape(8, -1)
        pairs = [effect(p, i + 1, kept[i], thrusts[i], scene) for i in range(8)]
        thrusts = np.array([value for value, _ in pairs])
        rates[places[name]] = np.concatenate([rate for _, rate in pairs])
    wrenches = {}
    for name, effect, p in vehicle.on(WRENCHES):
        wrenches[name], rates[places[name]] = effect(p, state[places[name]], scene, thrusts)
    return scene, flow, thrusts, wrenches, rates


def derivative(state, vehicle, places, command, around):
    """
    Return d/dt of a state.

    `state`: position, quaternion, velocity, rates, and then the memory of the effects. `places`:
    where in the state the memory of each effect is. `command`, `around`: duties and place of the
    moving mass; wind, noise, irradiance, voltage and the rate of that wind.
    """
    scene, flow, _, wrenches, rates = look(state, vehicle, places, command, around)
    forces = sum(wrenches.values(), np.zeros(6))
    rest = balance(np.zeros(6), forces, scene, flow)
    columns = [balance(unit, forces, scene, flow) - rest for unit in np.eye(6)]
    w, (x, y, z, s) = scene.rates, state[3:7]
    rates[:3] = scene.turn @ scene.velocity
    rates[3:6] = 0.5 * (s * w + np.cross([x, y, z], w))
    rates[6] = -0.5 * np.dot([x, y, z], w)
    rates[7:13] = np.linalg.solve(np.transpose(columns), -rest)
    return rates


def advance(state, dt, steps, *rest):
    """Return the state after classical Runge-Kutta steps."""
    for _ in range(steps):
        a = derivative(state, *rest)
        b = derivative(state + 0.5 * dt * a, *rest)
        c = derivative(state + 0.5 * dt * b, *rest)
        d = derivative(state + dt * c, *rest)
        state = state + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        state[3:7] /= np.linalg.norm(state[3:7])
    return state

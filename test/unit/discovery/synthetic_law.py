"""Make flights whose wrench is a known law plus noise, as a joint fit would hand them over."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

from lta_discovery.fit.evidence import FLOOR, per_flight_variance, PieceReducer, Prior
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.laws.law_data import FlightQuantities, LawData
from lta_discovery.laws.quantities import Quantities
from lta_discovery.replay.linearized_flight import (
    AXES,
    count_unknowns,
    hat_functions,
    LinearizationPoint,
    LinearizedFlight,
    SENSORS,
)
from lta_discovery.replay.variational_equation import WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

KNOTS, STEPS, PIECES = 13, 150, 6
NOISE = 0.3  # noise floors; of the wrench measured at each knot
Hidden = Callable[[Quantities], dict[int, Array]]  # wrench by body axis, from quantities


def make_law_data(wrench: Hidden, seed: int = 1) -> LawData:
    """Return a training and a confirming flight of 36 s with a wrench of (T,) on some axes."""
    rng = np.random.default_rng(seed)
    flights, reducers = [], []
    for _ in range(2):
        whole = _fly(rng)
        seen = wrench(whole)
        pieces = {name: values.reshape(PIECES, STEPS) for name, values in whole.items()}
        index = np.rint(np.linspace(0, STEPS - 1, KNOTS)).astype(int)
        turns = _turn_about_z(pieces['yaw'][:, index])
        flights.append(FlightQuantities(pieces, whole, STEPS * np.arange(PIECES), turns))
        reducers.append(_observe(seen, rng))
    at = np.zeros(len(SENSORS))
    prior = Prior(at, 1e-4 * np.eye(len(at)))
    group = LinearizedGroup(tuple(reducers), at, per_flight_variance([]))
    # The joint fit before any law: its deviations are as large as the law
    sizes = [
        np.sqrt(np.mean([np.mean(wrench(f.whole).get(axis, np.zeros(1)) ** 2) for f in flights]))
        for axis in range(AXES)
    ]
    deviations = np.maximum(np.array(sizes), 0.5 * FLOOR)
    joint = cast(
        'JointFit', SimpleNamespace(group=group, prior=prior, deviations=deviations, fitted=None)
    )
    return LawData(joint, flights, FLOOR, 1)


def _fly(rng: np.random.Generator) -> Quantities:
    """Return the quantities of smooth random motion, each of shape (T,)."""
    count = STEPS * PIECES

    def wander(size: float, mean: float = 0.0) -> Array:
        time = PERIOD * np.arange(count)
        waves = [
            np.sin(2.0 * np.pi * f * time + rng.uniform(0.0, 6.3)) for f in (0.05, 0.11, 0.23)
        ]
        return mean + size * np.sum(waves, axis=0) / np.sqrt(1.5)

    out = {name: wander(0.3) for name in ('u', 'v', 'w', 'p', 'q', 'r')}
    out |= {'x': wander(1.0), 'y': wander(1.0), 'height': wander(0.4, 1.5)}
    out |= {'roll': wander(0.05), 'pitch': wander(0.05), 'yaw': wander(2.0)}
    out |= {'thrust_surge': wander(0.02), 'thrust_heave': wander(0.04, 0.05)}
    out |= {'thrust_yaw': wander(0.003), 'voltage': wander(0.02, 3.9)}
    out['time'] = PERIOD * np.arange(count)
    out['speed'] = np.sqrt(out['u'] ** 2 + out['v'] ** 2 + out['w'] ** 2)
    out['rate'] = np.sqrt(out['p'] ** 2 + out['q'] ** 2 + out['r'] ** 2)
    return out


def _turn_about_z(yaw: Array) -> Array:
    """Return the rotations body to map of a level vehicle, shape (..., 3, 3)."""
    out = np.zeros((*yaw.shape, 3, 3))
    out[..., 0, 0] = out[..., 1, 1] = np.cos(yaw)
    out[..., 1, 0], out[..., 0, 1] = np.sin(yaw), -np.sin(yaw)
    out[..., 2, 2] = 1.0
    return out


def _observe(wrench: dict[int, Array], rng: np.random.Generator) -> PieceReducer:
    """Return a flight that measured the wrench at the knots with white noise."""
    nearest = np.linalg.pinv(hat_functions(STEPS, KNOTS))
    size = count_unknowns(KNOTS) + len(SENSORS) + 1
    rows = np.zeros((PIECES, AXES * KNOTS, size))
    for axis in range(AXES):
        noise = NOISE * FLOOR[axis]
        values = wrench.get(axis, np.zeros(PIECES * STEPS)).reshape(PIECES, STEPS)
        told = values @ nearest.T + noise * rng.standard_normal((PIECES, KNOTS))
        here = axis * KNOTS + np.arange(KNOTS)
        rows[:, here, WIDTH + here] = 1.0 / noise
        rows[:, here, -1] = told / noise
    grams = np.swapaxes(rows, 1, 2) @ rows
    zero = np.zeros((PIECES, count_unknowns(KNOTS)))
    point = LinearizationPoint(cast('Any', None), np.zeros(len(SENSORS)), zero)
    counts = np.full(PIECES, AXES * KNOTS)
    return PieceReducer(LinearizedFlight(SENSORS, grams, counts, point, np.zeros(0)))

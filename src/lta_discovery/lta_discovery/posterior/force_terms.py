"""
Define groups of generic terms that an unknown force may follow, without simulation.

A group is one hypothesis: a force field, air layers, a magnet, a one-way flap, rotor wash over a
fin, a swinging load. Each term is a wrench in every step of a flight, in units of usual sizes, so
that weights are comparable between flights.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_discovery.model.quaternions import rotation_matrix
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]

USUAL_SPEED: Final = np.array([0.3, 0.3, 0.3, 0.3, 0.3, 0.3])  # m/s, rad/s
USUAL_HEIGHT: Final = 0.5  # m
SIDE: Final = 5  # grid points per direction of place
LAYERS: Final = 10  # number of height bumps
OSCILLATION_LIMITS: Final = (0.2, 0.35, 0.5)  # Hz; faster oscillations are spectral lines
DAMPED: Final = 0.1  # damping ratio
CONSTANT: Final = 'constant'
MOTIONS: Final = (
    'surge speed', 'sway speed', 'heave speed', 'roll rate', 'pitch rate', 'yaw rate',
)  # fmt: skip


@final
class FlightBoundingBox(NamedTuple):
    """Box around all flights of a study: low and high corner, in the map. [m]"""

    low: Array
    high: Array

    @classmethod
    def from_positions(cls, places: Sequence[Array]) -> 'FlightBoundingBox':
        """Return the box around the middle 96 % of the positions of some flights, shape (n, 3)."""
        together = np.concatenate(places)
        low, high = np.percentile(together, [2.0, 98.0], axis=0)
        # At least 0.2 m wide, as a hover has no extent
        return cls(low, np.maximum(high, low + 0.2))


@final
@dataclass(frozen=True, slots=True)
class TermInputs:
    """Inputs of the terms in each step of the pieces."""

    time: Array  # shape (S, n) [s]
    states: Array  # as fitted, shape (S, n, 13)
    pushed: Array  # wrench of the rotors in the model, shape (S, n, 6) [N, N m]
    felt: Array  # specific force of the hull, body frame, shape (S, n, 3) [m/s2]


def position_terms(inputs: TermInputs, scene: FlightBoundingBox) -> tuple[list[str], Array]:
    """Return Gaussian bumps on a grid of positions, shape (S, n, SIDE^2)."""
    spots = [np.linspace(scene.low[k], scene.high[k], SIDE) for k in range(2)]
    # Standard deviation of a bump: one interval of the grid
    width = np.maximum(scene.high[:2] - scene.low[:2], 0.5) / (SIDE - 1)
    out = []
    for x in spots[0]:
        for y in spots[1]:
            away = ((inputs.states[..., 0] - x) / width[0]) ** 2
            away = away + ((inputs.states[..., 1] - y) / width[1]) ** 2
            out.append(np.exp(-0.5 * away))
    return ['place'] * len(out), np.stack(out, axis=-1)


def simulate_oscillator(inputs: TermInputs, shaking: Array, hertz: float) -> Array:
    """Return position and speed of an oscillator driven by an acceleration, shape (S, n, 2)."""
    omega, dt = 2.0 * math.pi * hertz, float(inputs.time[0, 1] - inputs.time[0, 0])
    # Semi-implicit Euler with damping, written as a second-order filter
    decay = math.exp(-DAMPED * omega * dt)
    back = [1.0, decay * (dt * omega) ** 2 - decay - 1.0, decay]
    # Pieces without a gap in between are one run
    gaps = np.flatnonzero(inputs.time[1:, 0] - inputs.time[:-1, -1] > 2.0 * dt) + 1
    out = np.zeros((*shaking.shape, 2))
    for run in np.split(np.arange(len(shaking)), gaps):  # at rest after each gap
        place = lfilter([-decay * dt**2], back, shaking[run].ravel())
        speed = np.diff(place, prepend=0.0) / dt
        both = np.column_stack([omega**2 * place, omega * speed])
        out[run] = both.reshape(len(run), -1, 2)
    return out


def list_axis_terms(
    inputs: TermInputs, scene: FlightBoundingBox
) -> Iterator[tuple[str, list[str], Array]]:
    """Yield groups for any single axis: name, terms, values of shape (S, n, J)."""
    motion = inputs.states[..., 7:13] / USUAL_SPEED
    height = (inputs.states[..., 2] - 0.5 * (scene.low[2] + scene.high[2])) / USUAL_HEIGHT
    rotation = rotation_matrix(inputs.states[..., 3:7])
    # Of the body x axis in the map
    heading = np.arctan2(rotation[..., 1, 0], rotation[..., 0, 0])
    spots = np.linspace(scene.low[2], scene.high[2], LAYERS)
    width = (scene.high[2] - scene.low[2]) / (LAYERS - 1)
    layers = [np.exp(-0.5 * ((inputs.states[..., 2] - spot) / width) ** 2) for spot in spots]
    moving = [height * motion[..., k] for k in (0, 2)]
    names = ['height'] * (LAYERS + 1) + [f'height x {MOTIONS[k]}' for k in (0, 2)]
    yield 'height', names, np.stack([height, *layers, *moving], axis=-1)
    # First and second harmonic of the heading
    turns = [f(m * heading) for m in (1, 2) for f in (np.cos, np.sin)]
    yield 'heading', ['heading'] * 2 + ['twice the heading'] * 2, np.stack(turns, axis=-1)
    names, values = [], []
    for k, name in enumerate(MOTIONS):
        for sign, way in ((1.0, 'forward'), (-1.0, 'backward')):
            # Half-wave: acts in one direction only
            one = np.maximum(sign * motion[..., k], 0.0)
            names += [f'{way} {name}', f'{way} {name} squared']
            values += [one, one**2]
    yield 'one-sided speed', names, np.stack(values, axis=-1)
    pairs = [(i, j) for i in range(6) for j in range(i + 1, 6)]
    yield (
        'speed x speed',
        [f'{MOTIONS[i]} x {MOTIONS[j]}' for i, j in pairs],
        np.stack([motion[..., i] * motion[..., j] for i, j in pairs], axis=-1),
    )


INPUTS: Final = {0: 'surge thrust', 2: 'heave thrust', 5: 'yaw thrust'}
USUAL_PUSH: Final = {0: 0.02, 2: 0.05, 5: 0.003}  # N, N m


def thrust_terms(inputs: TermInputs) -> tuple[list[str], Array]:
    """Return products of rotor wrench and hull motion."""
    names, values = [], []
    for axis, name in INPUTS.items():
        push = inputs.pushed[..., axis] / USUAL_PUSH[axis]
        for k in (0, 1, 2, 5):
            names.append(f'{name} x {MOTIONS[k]}')
            values.append(push * inputs.states[..., 7 + k] / USUAL_SPEED[k])
        names.append(f'{name} either way')
        values.append(np.abs(push))
    return names, np.stack(values, axis=-1)

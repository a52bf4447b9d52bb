"""
Describe the force that remains with all named effects: axis, size, and state terms it follows.

An axis counts if the deviation of its latent wrench exceeds the noise floor. That deviation is
the parameter of a random process with a fixed memory, so a force that changes more slowly is
larger, and a faster one smaller: the reported size is that of the force itself. The terms it
follows are learned on one side of the flights and have to hold on the other. A share of variance
that transfers is structure; without it the force is gusts or noise.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import FLOOR
from lta_discovery.fit.joint_fit import FlightFit
from lta_discovery.model.quaternions import rotation_matrix
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import AXES
from lta_discovery.replay.variational_equation import WIDTH
from lta_model.effects.protocol import AXES as NAMES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CLEAR: Final = 2.5  # noise floors; without missing effects no axis reaches 1.5
TERMS: Final = 3  # most terms that a force follows
CARRIED: Final = 0.15  # of the variance; gusts explain this much of another flight by chance
WORTH: Final = 0.05  # of the variance; smallest contribution of a further term


@final
class Remainder(NamedTuple):
    """Unexplained force on one axis."""

    axis: str  # 'surge' to 'yaw'
    # Standard deviation of the force [N] or moment [N m] over time: root mean square of flights
    size: float
    floors: float  # the same by the noise floor
    # Generic terms of the measured state, the strongest first; empty if none transfers
    follows: tuple[str, ...]
    carried: float  # share of the other side's variance that they explain
    # Whether what it follows is known: it is not where the fit predicts worse than its start
    is_traced: bool = True


def latent_at_knots(fit: FlightFit) -> Array:
    """Return the latent wrench at the K knots of each piece, shape (S * K, 6). [N, N m]"""
    random = fit.pieces.solve_unknowns(fit.deviations, np.zeros(len(fit.linear.names)))
    latent = random[:, WIDTH:-1].reshape(-1, AXES, fit.linear.knots)
    return np.swapaxes(latent, 1, 2).reshape(-1, AXES)


def measure_latent_spread(fit: FlightFit) -> Array:
    """Return the standard deviation of the latent wrench over a flight, shape (6,). [N, N m]"""
    count = fit.linear.knots
    knots = latent_at_knots(fit).reshape(-1, count, AXES)
    inverse = fit.pieces.solve_latent(fit.deviations).inverse.reshape(-1, AXES, count, AXES, count)
    # Covariance of the knots of each axis, shape (S, K, K, 6)
    unsure = np.einsum('saiaj->sija', inverse)
    k = np.arange(count)
    own, cross = unsure[:, k, k], unsure[:, k[:-1], k[1:]]
    a, b = knots[:, :-1], knots[:, 1:]
    # Between two knots the force goes from a to b on a straight line, with a mean square of
    # (a^2 + a b + b^2) / 3. A force that changes within a few knots is larger at the knots than
    # over time. The most probable force is smoother than the force: add its uncertainty.
    square = (a**2 + a * b + b**2 + own[:, :-1] + cross + own[:, 1:]) / 3.0
    # The mean over time does not count, as lift and trim errors absorb it
    mean = (0.5 * (a + b)).mean(axis=(0, 1))
    spread: Array = np.sqrt(square.mean(axis=(0, 1)) - mean**2)
    return spread


def states_at_knots(flight: FlightLinearizer, fit: FlightFit) -> Array:
    """Return the fitted states at the knots, shape (S * K, 13)."""
    states = flight.simulate_trajectory(fit.linear.point)
    index = np.rint(np.linspace(0, states.shape[1] - 1, fit.linear.knots)).astype(int)
    return states[:, index].reshape(-1, states.shape[-1])


def state_terms(states: Array) -> dict[str, Array]:
    """
    Return generic functions of the state that a force may follow, by name.

    Speeds and rates, their signed squares and magnitudes, products, position, heading.
    """
    u, v, w, p, q, r = states[:, 7:13].T
    rotation = rotation_matrix(states[:, 3:7])
    out = {
        'constant': np.ones(len(states)),
        'x': states[:, 0],
        'y': states[:, 1],
        'height': states[:, 2],
        'heading (cosine)': rotation[:, 0, 0],
        'heading (sine)': rotation[:, 1, 0],
    }
    motion = {
        'surge speed': u, 'sway speed': v, 'heave speed': w,
        'roll rate': p, 'pitch rate': q, 'yaw rate': r,
    }  # fmt: skip
    names = list(motion)
    for i, name in enumerate(names):
        value = motion[name]
        out[name] = value
        # Signed, like quadratic drag
        out[f'{name} squared'] = np.abs(value) * value
        out[f'{name} either way'] = np.abs(value)
        for other in names[i + 1 :]:
            out[f'{name} x {other}'] = value * motion[other]
    return out


def _explained_variance(rows: Array, target: Array, other: Array, other_target: Array) -> float:
    """Return the share of a second flight's variance explained by a fit to the first."""
    # Scaling makes one ridge fit terms of all units
    scale = np.sqrt(np.mean(rows**2, axis=0)) + 1e-12
    a = rows / scale
    # A small ridge keeps collinear terms solvable.
    ridge = 1e-3 * len(a) * np.eye(a.shape[1])
    weights = np.linalg.solve(a.T @ a + ridge, a.T @ target)
    off = other_target - (other / scale) @ weights
    return float(1.0 - np.sum(off**2) / np.sum(other_target**2))


def select_terms(
    states: Sequence[Array], forces: Sequence[Array]
) -> tuple[tuple[str, ...], float]:
    """
    Select the few terms that a force follows on both sides, and their explained share.

    Forward selection by cross-validated variance, in both directions; empty below chance level.
    """
    terms_by_flight = [state_terms(each) for each in states]
    chosen: tuple[str, ...] = ()
    share = 0.0

    def cross_validated_share(names: tuple[str, ...]) -> float:
        a, b = (np.column_stack([each[name] for name in names]) for each in terms_by_flight)
        there = _explained_variance(a, forces[0], b, forces[1])
        # The worse direction counts, so that chance on one side is not enough.
        return min(there, _explained_variance(b, forces[1], a, forces[0]))

    while len(chosen) < TERMS:
        gains = {
            name: cross_validated_share((*chosen, name))
            for name in terms_by_flight[0]
            if name not in chosen
        }
        best = max(gains, key=lambda name: gains[name])
        if gains[best] < share + WORTH:
            break
        chosen, share = (*chosen, best), gains[best]
    return (chosen, share) if share > CARRIED else ((), max(share, 0.0))


def find_unexplained_forces(
    flights: Sequence[Sequence[FlightLinearizer]],
    fits: Sequence[Sequence[FlightFit]],
    floor: Array = FLOOR,
    clear: float = CLEAR,
) -> list[Remainder]:
    """
    Return the unexplained forces of two sides, the largest first.

    `flights`, `fits`: training and confirming flights, with all named effects in the model.
    `clear`: noise floors above which an axis counts.
    """
    every = [each.deviations for side in fits for each in side]
    # Geometric mean of the flights
    together = np.exp(np.mean(np.log(every), axis=0))
    out: list[Remainder] = []
    if not np.any(together > clear * floor):
        return out  # only computed if some axis has a remainder
    states, knots = _collect_knots(flights, fits)
    spreads = [measure_latent_spread(each) for side in fits for each in side]
    sizes = np.sqrt(np.mean(np.square(spreads), axis=0))
    for k, axis in enumerate(NAMES):
        if together[k] > clear * floor[k]:
            follows, share = select_terms(states, [each[:, k] for each in knots])
            size = float(sizes[k])
            out.append(Remainder(axis, size, size / float(floor[k]), follows, share))
    return sorted(out, key=lambda one: -one.floors)


def _collect_knots(
    flights: Sequence[Sequence[FlightLinearizer]], fits: Sequence[Sequence[FlightFit]]
) -> tuple[list[Array], list[Array]]:
    """Return the states and the latent wrench at the knots of each side."""
    sides = [list(zip(*both, strict=True)) for both in zip(flights, fits, strict=True)]
    states = [np.concatenate([states_at_knots(*each) for each in side]) for side in sides]
    return states, [
        np.concatenate([latent_at_knots(fitted) for _, fitted in side]) for side in sides
    ]

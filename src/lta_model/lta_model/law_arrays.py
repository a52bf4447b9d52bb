"""
Evaluate a law over arrays: its factors, its fade and its terms, as the effect `law` does.

`columns` holds the quantities of a law by name in SI, all of one shape.
"""

from collections.abc import Iterable, Mapping
from typing import Final

from lta_config.schema.vehicle_law import AXES, HIDDEN, HIDDEN_RATE, Law, LawFactor, PERIOD
from lta_model.effects.law import LARGEST_EXPONENT
from lta_model.effects.protocol import AXES as BODY
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Columns = Mapping[str, Array]
HIDDEN_QUANTITIES: Final = (HIDDEN, HIDDEN_RATE)


def evaluate_factor(factor: LawFactor, x: Array) -> Array:
    """Return the form of a factor at values of its quantity, in their shape."""
    match factor.form:
        case 'modulus' | 'power':
            size: Array = np.abs(x) ** (factor.exponent or 1.0)
            return size if factor.form == 'modulus' else np.copysign(size, x)
        case 'positive':
            return np.maximum(x - (factor.threshold or 0.0), 0.0)
        case 'negative':
            return np.maximum((factor.threshold or 0.0) - x, 0.0)
        case 'above':
            return 0.5 * (1.0 + np.tanh((x - (factor.threshold or 0.0)) / (factor.scale or 1.0)))
        case 'sign':
            return np.tanh(x / (factor.scale or 1.0))
        case 'decay':
            return np.exp(np.minimum(-x / (factor.scale or 1.0), LARGEST_EXPONENT))
        case 'sin' | 'cos':
            angle = 2.0 * np.pi * x / (factor.scale or PERIOD) - (factor.phase or 0.0)
            return np.sin(angle) if factor.form == 'sin' else np.cos(angle)
    return x


def evaluate_product(factors: Iterable[LawFactor], columns: Columns) -> Array:
    """Return the product of factors, in the shape of the columns; 1 without any."""
    product = _create_ones(columns)
    for factor in factors:
        product = product * evaluate_factor(factor, columns[factor.quantity])
    return product


def evaluate_distance(law: Law, columns: Columns) -> dict[str, Array]:
    """
    Return how far each quantity is outside of its range, in the shape of the columns.

    It is in half widths of the range: 0 within, and 1 where the law has faded to zero.
    """
    distances = {}
    for name, (low, high) in law.region.items():
        off = columns[name] - 0.5 * (low + high)
        if name == 'yaw':
            off = off - 2.0 * np.pi * np.floor(off / (2.0 * np.pi) + 0.5)
        distances[name] = np.maximum(np.abs(off) / (0.5 * (high - low)) - 1.0, 0.0)
    return distances


def evaluate_fade(law: Law, columns: Columns) -> Array:
    """Return 1 within the region of a law, less outside, and 0 far outside."""
    fade = _create_ones(columns)
    for distance in evaluate_distance(law, columns).values():
        s = np.minimum(distance, 1.0)
        fade = fade * (1.0 - s * s * (3.0 - 2.0 * s))
    return fade


def _create_ones(columns: Columns) -> Array:
    """Return ones in the shape of the columns; a single one without columns."""
    return np.ones(np.shape(next(iter(columns.values()))) if columns else 1)


def evaluate_drive_fade(law: Law, columns: Columns) -> Array:
    """Return the fade of the hidden state's drive: its own range does not count."""
    ranges = {name: ends for name, ends in law.region.items() if name not in HIDDEN_QUANTITIES}
    return evaluate_fade(law.model_copy(update={'region': ranges}), columns)


def evaluate_law(law: Law, columns: Columns, rotation: Array) -> Array:
    """
    Return the force and moment of a law, faded outside of its region, shape (..., 6). [N, N m]

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (...)
        The quantities of the law, also its hidden state.
    rotation : ndarray, shape (..., 3, 3)
        Attitude, body to map; the result is in the body frame.

    """
    fade = evaluate_fade(law, columns)
    out = np.zeros((*fade.shape, len(BODY)))
    for term in law.terms:
        force: Array = fade * term.coefficient * evaluate_product(term.factors, columns)
        axis = list(AXES).index(term.axis)
        if axis < len(BODY):
            out[..., axis] += force
        else:
            out[..., :3] += force[..., None] * rotation[..., axis - len(BODY), :]
    return out

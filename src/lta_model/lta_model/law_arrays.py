"""
Evaluate a law over arrays: its factors, its fade and its hidden state, as the effect `law` does.

`columns` holds the quantities of a law by name in SI. They all have one shape: (T,) where a hidden
state is integrated, any elsewhere.
"""

from collections.abc import Iterable, Mapping
from typing import Final, Literal

from lta_config.schema.vehicle_law import HIDDEN, HIDDEN_RATE, HiddenState, Law, LawFactor, PERIOD
from lta_model.effects.law import LARGEST
import numpy as np
from numpy.typing import NDArray
from scipy.signal import cont2discrete, lfilter

Array = NDArray[np.float64]
Columns = Mapping[str, Array]
OWN: Final = (HIDDEN, HIDDEN_RATE)


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
            return np.exp(np.minimum(-x / (factor.scale or 1.0), LARGEST))
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
    ranges = {name: ends for name, ends in law.region.items() if name not in OWN}
    return evaluate_fade(law.model_copy(update={'region': ranges}), columns)


def integrate_hidden(hidden: HiddenState, drive: Array, period: float) -> tuple[Array, Array]:
    """
    Return the hidden state and its rate at each sample, shape (T,); 0 at the first.

    Exact for a drive, shape (T,), that is linear between its samples, `period` apart [s].
    """
    if hidden.time_constant is not None:
        value = _respond([1.0], [hidden.time_constant, 1.0], drive, period)
        return value, (drive - value) / hidden.time_constant
    w, damping = hidden.frequency or 0.0, hidden.damping or 0.0
    down = [1.0, 2.0 * damping * w, w * w]
    return _respond([w * w], down, drive, period), _respond([w * w, 0.0], down, drive, period)


def _respond(up: list[float], down: list[float], drive: Array, period: float) -> Array:
    """Return the response of a transfer function to a drive that begins with a step."""
    # A step at the start, and what rises from there: each exact by its own discretization
    first = np.full(len(drive), drive[0])
    rest = _filter(up, down, drive - first, period, 'foh')
    return _filter(up, down, first, period, 'zoh') + rest


def _filter(
    up: list[float], down: list[float], drive: Array, period: float, method: Literal['zoh', 'foh']
) -> Array:
    """Return the response of a transfer function, from rest."""
    # The stubs do not know a numerator and a denominator
    system = cont2discrete((up, down), period, method=method)  # type: ignore[arg-type]
    out: Array = lfilter(np.ravel(system[0]), np.ravel(system[1]), drive)
    return out


def evaluate_law(law: Law, columns: Columns, period: float) -> dict[str, Array]:
    """
    Return the force or moment of a law on each of its axes, shape (T,). [N, N m]

    The hidden state is integrated from the first sample on, unless `columns` has it; `period` is
    the time between samples. [s]
    """
    seen = dict(columns)
    if law.hidden and HIDDEN not in seen:
        drive = evaluate_drive_fade(law, seen) * evaluate_product(law.hidden.drive, seen)
        seen[HIDDEN], seen[HIDDEN_RATE] = integrate_hidden(law.hidden, drive, period)
    fade = evaluate_fade(law, seen)
    out: dict[str, Array] = {}
    for term in law.terms:
        value = fade * term.coefficient * evaluate_product(term.factors, seen)
        out[term.axis] = out.get(term.axis, 0.0) + value
    return out

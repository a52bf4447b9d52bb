"""Describe flight conditions over time, and find the condition with the largest disagreement."""

from collections.abc import Mapping
from typing import Final, final, NamedTuple

from lta_discovery.flights.measured_flight import MeasuredFlight, PERIOD
from lta_discovery.flights.zero_order_hold import average_held_values
from lta_discovery.model.quaternions import rotation_matrix
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMOOTH: Final = 13  # grid points over which positions are differentiated
SPLITS: Final = np.linspace(0.2, 0.8, 13)  # shares of the time on one side of a split
APART: Final = 1.6  # smallest ratio of the RMS on both sides of a reported split
DRAWS: Final = 199
CHANCE: Final = 0.01
SECTORS: Final = ('east', 'north', 'west', 'south')  # x of the map is east (REP-103)


@final
class FlightCondition(NamedTuple):
    """Condition under which a disagreement is largest."""

    name: str  # 'speed above 0.4 m/s'; 'always' where no condition stands out
    holds: NDArray[np.bool_]  # whether it holds, shape (n,)


def ground_speed(flight: MeasuredFlight) -> Array:
    """Return the ground speed from tracked positions, NaN in gaps. [m/s]"""
    half = SMOOTH // 2
    out = np.full(len(flight.time), np.nan)
    if len(out) > SMOOTH:
        apart = flight.position[2 * half :] - flight.position[: -2 * half]
        # Central difference over SMOOTH points; NaN at the ends and in gaps
        out[half:-half] = np.linalg.norm(apart, axis=1) / (2 * half * PERIOD)
    return out


def list_condition_quantities(
    flight: MeasuredFlight, light: Array | None = None
) -> dict[str, tuple[Array, str]]:
    """
    Return the quantities that may separate parts of a flight: values on the grid, and unit.

    Parameters
    ----------
    light : ndarray, shape (n,), optional
        Illuminance on the grid. [lx]

    Returns
    -------
    dict of str to (ndarray of shape (n,), str)
        Speed, height, mean duty (or force), and voltage, light and heading if known; NaN in gaps.

    """
    edges = np.append(flight.time, flight.time[-1] + PERIOD)
    out = {'speed': (ground_speed(flight), 'm/s'), 'height': (flight.position[:, 2], 'm')}
    if flight.wrench is not None:
        force = np.linalg.norm(average_held_values(flight.wrench, edges)[:, :3], axis=1)
        out['commanded force'] = force, 'N'
    if len(flight.commands.time) > 1:
        out['duty'] = np.abs(average_held_values(flight.commands, edges)).mean(axis=1), '1'
    if np.isfinite(flight.voltage).any():
        out['voltage'] = flight.voltage, 'V'
    if light is not None:
        out['light'] = light, 'lx'
    turned = rotation_matrix(flight.quaternion)
    out['heading'] = np.arctan2(turned[:, 1, 0], turned[:, 0, 0]), 'rad'
    return out


def heading_sector(heading: Array) -> NDArray[np.int64]:
    """Return the quadrant of a heading: 0 is about x of the map; -1 where unknown."""
    finite = np.where(np.isfinite(heading), heading, 0.0)
    # Sectors of 90 degrees, centred on the axes
    quarter = np.rint(finite / (0.5 * np.pi)).astype(np.int64) % 4
    return np.where(np.isfinite(heading), quarter, -1)


def list_quantity_conditions(name: str, values: Array, unit: str) -> list[FlightCondition]:
    """Return the conditions of one quantity."""
    if name == 'heading':
        quarter = heading_sector(values)
        return [FlightCondition(f'heading {word}', quarter == k) for k, word in enumerate(SECTORS)]
    finite = values[np.isfinite(values)]
    if len(finite) == 0 or float(np.ptp(finite)) <= 1e-9:
        return []
    out = []
    for at in np.unique(np.quantile(finite, SPLITS)):
        label = f'{at:.2g}' + ('' if unit == '1' else f' {unit}')
        with np.errstate(invalid='ignore'):
            out.append(FlightCondition(f'{name} above {label}', values > at))
            out.append(FlightCondition(f'{name} below {label}', values <= at))
    return out


def find_largest_condition(
    squares: Array, quantities: Mapping[str, tuple[Array, str]], block: int, seed: int
) -> FlightCondition:
    """
    Return the condition with the largest squared disagreement, if it is significant.

    Significance follows from a permutation test: the disagreement is shifted in time against the
    conditions.

    `squares`, shape (n,): of the disagreement, in the order of time. `block`: correlation length
    of the disagreement, in rows.
    """
    n = len(squares)
    always = FlightCondition('always', np.ones(n, dtype=np.bool_))
    candidates = [
        one
        for name, (values, unit) in quantities.items()
        for one in list_quantity_conditions(name, values, unit)
    ]
    # Both sides of a split need enough independent values.
    least = max(2 * block, n // 10)
    candidates = [one for one in candidates if least <= one.holds.sum() <= n - least]
    if not candidates or n < 6 * block:
        return always
    table = np.array([one.holds for one in candidates], dtype=np.float64)
    won = _split_gain(table, squares[:, None])[:, 0]
    best = int(np.argmax(won))
    # Shifts of at least a block destroy the relation but keep the correlation
    shifts = np.random.default_rng([seed, n]).integers(block, n - block, DRAWS)
    rolled = np.stack([np.roll(squares, shift) for shift in shifts], axis=1)
    by_chance = _split_gain(table, rolled).max(axis=0)
    # p-value of the permutation test, including the observed order.
    share = (1 + np.sum(by_chance >= won[best])) / (DRAWS + 1)
    inside = candidates[best].holds
    apart = np.sqrt(squares[inside].mean() / max(squares[~inside].mean(), 1e-300))
    return candidates[best] if share <= CHANCE and apart > APART else always


def _split_gain(table: Array, squares: Array) -> Array:
    """Return the log-likelihood gain of splitting by each row of a table; 0 for a lower side."""
    n, inside = squares.shape[0], table.sum(axis=1)[:, None]
    total = squares.sum(axis=0)
    within = table @ squares
    one, other = within / inside, (total - within) / (n - inside)
    whole = np.log(total / n + 1e-300)
    # Log likelihood ratio of two variances against a common one
    gain = n * whole - inside * np.log(one + 1e-300) - (n - inside) * np.log(other + 1e-300)
    # Only conditions with the larger error inside count
    return np.where(one > other, 0.5 * gain, 0.0)

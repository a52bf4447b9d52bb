"""
The most probable parameters of flights, and how much force they leave unexplained.

Gauss-Newton: linearise, find the deviations of the latent wrench that make the data most probable,
move knobs, states and knots to where they are most probable then, and again, until the evidence
rests. A large missing effect can hide behind large deviations; so they are looked for from where
they are and from small ones, and the better is taken.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_analysis.discovery.evidence import (
    Fitted,
    fitted,
    FLOOR,
    log_prior,
    Pieces,
    Prior,
    Reduced,
)
from lta_analysis.discovery.knobs import Knob
from lta_analysis.discovery.linear import Linear, Point
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.nominal import Nominal
from lta_config.errors import BadInput
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REST: Final = 0.7  # nats; below it the evidence has come to rest
ROUNDS: Final = 6
SMALL: Final = 2.5  # floors; the largest deviations of the second start
SWEEPS: Final = 4
STRIDE: Final = 0.5  # of the logarithm of a deviation
SHARES: Final = (1.0, 0.5, 0.2, 0.05)  # of a step of Gauss-Newton
LOWEST, HIGHEST = 0.05 * FLOOR, 1e3 * FLOOR


@final
@dataclass(frozen=True, slots=True)
class Fit:
    """
    One flight, fitted.

    Attributes
    ----------
    linear : Linear
        About the last point.
    pieces : Pieces
        Of it.
    reduced : Reduced
        Of them, with the deviations.
    deviations : ndarray, shape (6,)
        Of the latent force [N] and moment [N m].
    fitted : Fitted
        The knobs.
    evidence : float
        Log evidence with that of the deviations. [nats]
    rounds : int
        Linearisations.

    """

    linear: Linear
    pieces: Pieces
    reduced: Reduced
    deviations: Array
    fitted: Fitted
    evidence: float
    rounds: int


def turned(nominal: Nominal, knobs: Sequence[Knob], values: Array) -> tuple[Nominal, Array]:
    """Return the vehicle with its knobs at values, and those values within their bounds."""
    out = values.copy()
    for k, knob in enumerate(knobs):
        out[k] = min(max(values[k], knob.low), knob.high)
        if out[k] != 0.0:
            nominal = knob.turned(nominal, float(out[k]))
    return nominal, out


def best(value: Callable[[Array], float], start: Array) -> tuple[Array, float]:
    """
    Return the deviations of greatest value near a start, and the value.

    Newton steps on the logarithms, axis by axis at once, halved until they help.
    """
    at = np.log(np.clip(start, LOWEST, HIGHEST))
    now = value(np.exp(at))
    for _ in range(SWEEPS):
        step = np.zeros(len(at))
        for k in range(len(at)):
            aside = np.zeros(len(at))
            aside[k] = STRIDE
            up, down = value(np.exp(at + aside)), value(np.exp(at - aside))
            slope, bend = (up - down) / (2 * STRIDE), (up - 2 * now + down) / STRIDE**2
            step[k] = np.clip(-slope / bend, -2.0, 2.0) if bend < -1e-3 else 1.5 * np.sign(slope)
        before = now
        for _ in range(4):
            trial = np.clip(at + step, np.log(LOWEST), np.log(HIGHEST))
            there = value(np.exp(trial))
            if there > now:
                at, now = trial, there
                break
            step *= 0.5
        if now - before < 0.05:
            break
    return np.exp(at), now


def weighed(pieces: Pieces, prior: Prior, start: Array, caps: Sequence[float] = (SMALL,)) -> Array:
    """Return the most probable deviations of the latent wrench, from several starts."""

    def value(deviations: Array) -> float:
        reduced = pieces.reduced(deviations)
        at = pieces.linear.point.values
        return fitted(reduced, at, prior).log_evidence + log_prior(deviations)

    starts = [start, *(np.minimum(start, cap * FLOOR) for cap in caps)]
    distinct = [s for k, s in enumerate(starts) if k == 0 or not np.allclose(s, start)]
    return max((best(value, s) for s in distinct), key=lambda found: found[1])[0]


def settled(pieces: Pieces, prior: Prior, start: Array) -> tuple[Reduced, Array, Fitted, float]:
    """Return a flight reduced by the most probable deviations, and its knobs."""
    deviations = weighed(pieces, prior, start)
    reduced = pieces.reduced(deviations)
    found = fitted(reduced, pieces.linear.point.values, prior)
    return reduced, deviations, found, found.log_evidence + log_prior(deviations)


def fit(
    flight: Linearised,
    nominal: Nominal,
    prior: Prior,
    begin: Point,
    deviations: Array = FLOOR,
    rounds: int = ROUNDS,
) -> Fit:
    """
    Fit one flight.

    Parameters
    ----------
    flight : Linearised
        The flight.
    nominal : Nominal
        The vehicle as its file has it: where all knobs are at 0.
    prior : Prior
        Which knobs are free, and how far.
    begin : Point
        Where to begin.
    deviations : ndarray, shape (6,)
        Of the latent wrench, to begin with.
    rounds : int
        Linearisations at most.

    Returns
    -------
    Fit
        About the last point: what a linearisation promises counts only once it has been flown.

    """
    pieces = Pieces(flight.at(begin))
    last = _fit_of(pieces, prior, deviations, 1)
    for count in range(2, rounds + 1):
        pieces = _onward(flight, nominal, prior, last)
        now = _fit_of(pieces, prior, last.deviations, count)
        rests = abs(now.evidence - last.evidence) < REST
        last = now
        if rests:
            break
    return last


def _fit_of(pieces: Pieces, prior: Prior, deviations: Array, count: int) -> Fit:
    """Return a fit about a point."""
    reduced, found_deviations, found, evidence = settled(pieces, prior, deviations)
    return Fit(pieces.linear, pieces, reduced, found_deviations, found, evidence, count)


def _onward(flight: Linearised, nominal: Nominal, prior: Prior, last: Fit) -> Pieces:
    """Return the flight about the next point: the whole step, or a part that makes it better."""
    at, target = last.linear.point, last.fitted.mean
    before = last.pieces.misfit(last.deviations, prior)
    _, within = turned(nominal, flight.knobs, target)
    random = last.pieces.solved(last.deviations, within - at.values)
    for share in SHARES:
        values = at.values + share * (within - at.values)
        point = Point(
            turned(nominal, flight.knobs, values)[0],
            values,
            at.random + share * (random - at.random),
        )
        try:
            linear = flight.at(point)
        except BadInput:
            continue
        if np.isfinite(linear.grams).all():
            pieces = Pieces(linear)
            if pieces.misfit(last.deviations, prior) < before + 1.0:
                return pieces
    return last.pieces

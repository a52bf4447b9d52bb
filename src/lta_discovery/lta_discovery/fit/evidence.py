"""
Compute the evidence of parameters, marginal over states, latent forces and tolerances.

The model is linear and Gaussian about a point. The unknowns of each piece (initial state, knots of
the latent wrench, pressure) are eliminated first, then the nuisance parameters. The remainder of a
candidate's column is its `information`, that of its product with the residual its `pull`. For a
true model, pull / sqrt(information) has the distribution N(0, 1).
"""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import Final, final, NamedTuple

from lta_discovery.fit.triangular import invert_lower, solve_lower
from lta_discovery.flights.windows import LENGTH
from lta_discovery.model.candidates import vector_components
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.linearized_flight import AXES, LinearizationPoint, LinearizedFlight
from lta_discovery.replay.variational_equation import WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Deviations of an initial state from `fit_state_at`: m, rad, m/s, rad/s.
STATE: Final = np.array([0.02] * 3 + [0.035] * 3 + [0.08] * 3 + [0.08] * 3)
PIECE_PRESSURE: Final = 0.6  # Pa; 5 cm of air
OWN: Final = np.array(
    [2.4, 0.006, 0.006, 0.006]
)  # of SENSORS: Pa, the pressure of 20 cm of air; then relative
MEMORY: Final = 1.5  # s; correlation time of the latent force
# Noise floor: smallest relevant deviation of latent force [N] and moment [N m], for a blimp
# of this mass [kg] and inertia [kg m2]; it grows with them (`wrench_floor`).
FLOOR: Final = np.array([4e-4, 4e-4, 4e-4, 8e-5, 8e-5, 4e-5])
MASS: Final = 0.415  # kg; of the vehicle with that floor
INERTIA: Final = np.array([0.039, 0.039, 0.028])
Sizes = Mapping[str, float]
NO_SIZES: Final[Sizes] = {}
USUAL: Final = 1.3  # noise floors; median of the log-normal prior of a deviation
LOOSE: Final = 0.7  # standard deviation of its logarithm
# Tolerances are themselves estimates: as likely as not, that of a value is this much larger.
WIDER: Final = 1.5


def knot_precision(knots: int, length: float = LENGTH) -> Array:
    """
    Return the inverse covariance of the knots of one axis, for a standard deviation of 1.

    That of an evenly sampled Ornstein-Uhlenbeck process, which is tridiagonal.
    """
    # Correlation of neighbouring knots
    correlation = np.exp(-length / (knots - 1) / MEMORY)
    out = np.diag(np.full(knots, 1.0 + correlation**2))
    # The end knots have only one neighbour
    out[0, 0] = out[-1, -1] = 1.0
    step = np.arange(knots - 1)
    out[step, step + 1] = out[step + 1, step] = -correlation
    precision: Array = out / (1.0 - correlation**2)
    return precision


def wrench_floor(nominal: NominalVehicle) -> Array:
    """Return the noise floor of the latent wrench of a vehicle, shape (6,). [N, N m]"""
    inertia = np.diag(nominal.inertia) / INERTIA
    floor: Array = FLOOR * np.concatenate([np.full(3, nominal.mass / MASS), inertia])
    return floor


@final
class Prior(NamedTuple):
    """Prior of the parameters, followed by the sensor errors (SENSORS)."""

    mean: Array  # relative to the vehicle file, shape (G,)
    covariance: Array  # rows and columns of 0 fix a parameter, shape (G, G)

    @property
    def free(self) -> NDArray[np.bool_]:
        """Mask of the parameters that are not fixed."""
        return np.diag(self.covariance) > 0.0


def build_prior(
    knobs: Sequence[FreeParameter], named: Sequence[str] = (), sizes: Sizes = NO_SIZES
) -> Prior:
    """
    Return the prior in which the named candidates are present and the others are not.

    `named`: present candidates; any component of a vector stands for all. `sizes`: prior deviation
    of each component in typical sizes, 1 by default (`selection.candidate_scan.SIZES`); 0 for an
    absent component of a vector.
    """
    # A vector is named by one component, but the others become free too
    there = {one: sizes.get(one, 1.0) for name in named for one in vector_components(name)}
    variance = [
        knob.tolerance**2 + (there.get(knob.name, 0.0) * knob.typical) ** 2 for knob in knobs
    ]
    covariance = np.diag([*variance, *OWN**2])
    return Prior(np.zeros(len(covariance)), covariance)


def per_flight_variance(knobs: Sequence[FreeParameter]) -> Array:
    """Return the variance of parameters that differ between flights, 0 for shared ones."""
    trims = [knob.tolerance**2 if knob.per_flight else 0.0 for knob in knobs]
    return np.array([*trims, *OWN**2])


def build_shared_prior(
    knobs: Sequence[FreeParameter], named: Sequence[str] = (), sizes: Sizes = NO_SIZES
) -> Prior:
    """Return the prior of the shared parameters: `build_prior` without per-flight variance."""
    # Each flight draws its own part (`LinearizedGroup`), so it must not count twice
    both = build_prior(knobs, named, sizes)
    return Prior(both.mean, both.covariance - np.diag(per_flight_variance(knobs)))


def widen_tolerance(prior: Prior, indices: Sequence[int]) -> Prior:
    """Return a prior in which the tolerance of some parameters is larger."""
    scale = np.ones(len(prior.mean))
    scale[list(indices)] = WIDER
    return Prior(prior.mean, prior.covariance * np.outer(scale, scale))


def posterior_as_prior(before: 'ParameterPosterior', widened: float = 1.5) -> Prior:
    """Return the posterior of some flights, widened, as the prior of the next."""
    return Prior(before.mean, widened * before.covariance)


@final
@dataclass(frozen=True, slots=True)
class ReducedFlight:
    """A flight with the unknowns of its pieces eliminated."""

    # Of parameter columns and residual, in the remaining inverse covariance, shape (G + 1, G + 1)
    products: Array
    # Of the log evidence: unknowns of the pieces and readings, less the noise levels
    constant: float


@final
class LatentSolution(NamedTuple):
    """Latent wrench of a flight's pieces for some deviations."""

    reduced: ReducedFlight  # the flight without the unknowns of its pieces
    inverse: Array  # covariance of the wrench at the knots, for fixed parameters, shape (S, L, L)
    # Sensitivity of the wrench to the parameters; the last column is its change for fixed ones,
    # shape (S, L, G + 1)
    answer: Array


@final
class PieceReducer:
    """Eliminate the unknowns of a flight's pieces, for any deviations of the latent wrench."""

    def __init__(self, linear: LinearizedFlight) -> None:
        self.linear = linear
        latent, random = slice(WIDTH, WIDTH + AXES * linear.knots), linear.unknown_count
        # Column order of the products: state, latent knots, pressure, parameters, residual
        keep = np.r_[latent, random : linear.grams.shape[1]]
        out = np.r_[0:WIDTH, random - 1]
        precision = np.concatenate([STATE**-2.0, [PIECE_PRESSURE**-2.0]])
        # Columns are changes from the point; the prior mean of 0 is at minus the point
        mean = -linear.point.random[:, out]
        # Initial states and pressure do not depend on the deviations: eliminate them once.
        self._grams, self._constant = eliminate_columns(
            linear.grams, keep, out, np.diag(precision), mean
        )
        self._knots = knot_precision(linear.knots)
        self._mean = -linear.point.random[:, latent]

    def select(self, columns: NDArray[np.int64]) -> 'PieceReducer':
        """Return the flight with some columns only; enough to eliminate and solve for unknowns."""
        # A shallow copy: the eliminated products are replaced, not changed
        out, point = copy(self), self.linear.point
        names = tuple(self.linear.names[k] for k in columns)
        out.linear = replace(
            self.linear, names=names, point=replace(point, values=point.values[columns])
        )
        count = AXES * self.linear.knots
        index = np.concatenate([np.arange(count), count + columns, [self._grams.shape[1] - 1]])
        out._grams = self._grams[:, index[:, None], index]
        return out

    def eliminate_unknowns(self, deviations: Array) -> ReducedFlight:
        """
        Return the flight without the unknowns of its pieces.

        `deviations`, shape (6,): of the latent force [N] and moment [N m].
        """
        precision, count = self._latent_precision(deviations), AXES * self.linear.knots
        keep = np.arange(count, self._grams.shape[1])
        products, constant = eliminate_columns(
            self._grams, keep, np.arange(count), precision, self._mean
        )
        return self._sum_pieces(products, constant)

    @property
    def latent_wrench(self) -> Array:
        """Latent wrench at the knots at the linearization point, shape (S, L)."""
        return -self._mean

    def solve_latent(self, deviations: Array) -> LatentSolution:
        """Reduce the flight as `eliminate_unknowns` does, and return the latent wrench too."""
        precision, count = self._latent_precision(deviations), AXES * self.linear.knots
        inner = self._grams[:, :count, :count] + precision
        cross = self._grams[:, :count, count:].copy()
        # The prior enters as pseudo-observations: `precision` in products, `pull` in the residual
        pull = self._mean @ precision
        cross[:, :, -1] += pull
        root = np.linalg.cholesky(inner)
        back = invert_lower(root)
        inverse: Array = np.swapaxes(back, 1, 2) @ back
        answer = inverse @ cross
        # Schur complement: parameters and residual, with the wrench marginalized
        left = self._grams[:, count:, count:] - np.swapaxes(cross, 1, 2) @ answer
        left[:, -1, -1] += np.sum(pull * self._mean, axis=1)
        logs = np.linalg.slogdet(precision)[1]
        # Log determinants of prior and posterior: the Occam factor of the evidence
        logs = logs - 2.0 * np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1)
        return LatentSolution(self._sum_pieces(left, 0.5 * logs), inverse, answer)

    def _latent_precision(self, deviations: Array) -> Array:
        """Return the inverse covariance of the latent wrench of a piece."""
        return _expand_precision(deviations, self._knots)

    def _sum_pieces(self, products: Array, constant: Array) -> ReducedFlight:
        # Normalization of the Gaussian readings, already in units of the noise
        rows = -0.5 * np.log(2.0 * np.pi) * self.linear.rows.sum()
        return ReducedFlight(products.sum(axis=0), self._constant.sum() + constant.sum() + rows)

    def solve_unknowns(self, deviations: Array, change: Array) -> Array:
        """
        Return the most probable unknowns of each piece, shape (S, R).

        The values are absolute; `change` is the change of the parameters from the point.
        """
        precision = unknown_precision(deviations, self.linear.knots)
        grams, before, random = (
            self.linear.grams,
            self.linear.point.random,
            self.linear.unknown_count,
        )
        right = grams[:, :random, -1] - grams[:, :random, random:-1] @ change
        # The prior pulls the absolute values to 0, not the changes
        right = right - before @ precision
        moved = np.linalg.solve(grams[:, :random, :random] + precision, right[..., None])
        return before + moved[..., 0]


def unknown_precision(deviations: Array, knots: int) -> Array:
    """Return the inverse covariance of a piece's unknowns, shape (R, R)."""
    out = np.diag(np.concatenate([STATE**-2.0, np.zeros(AXES * knots), [PIECE_PRESSURE**-2.0]]))
    latent = slice(WIDTH, WIDTH + AXES * knots)
    out[latent, latent] = _expand_precision(deviations, knot_precision(knots))
    return out


def _expand_precision(deviations: Array, knots: Array) -> Array:
    """Return the inverse covariance of the knots of all axes, from that of one unit axis."""
    return np.asarray(np.kron(np.diag(deviations**-2.0), knots), dtype=np.float64)


def eliminate_columns(
    grams: Array, keep: NDArray[np.int64], out: NDArray[np.int64], precision: Array, mean: Array
) -> tuple[Array, Array]:
    """Marginalize columns with a Gaussian prior; return the products and the evidence constant."""
    inner = grams[:, out[:, None], out] + precision
    cross = grams[:, out[:, None], keep].copy()
    pull = mean @ precision
    cross[:, :, -1] += pull
    root = np.linalg.cholesky(inner)
    half = solve_lower(root, cross)
    left = grams[:, keep[:, None], keep] - np.swapaxes(half, 1, 2) @ half
    left[:, -1, -1] += np.sum(pull * mean, axis=1)
    own = np.linalg.slogdet(precision)[1]
    logs = np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1)
    return left, 0.5 * own - logs


class ParameterPosterior(NamedTuple):
    """Posterior of the parameters: log evidence, mean relative to the vehicle file, covariance."""

    log_evidence: float
    mean: Array
    covariance: Array


def compute_posterior(reduced: ReducedFlight, at: Array, prior: Prior) -> ParameterPosterior:
    """
    Return the posterior of the parameters, and the log evidence.

    `prior`: parameters that it fixes stay at the point.
    """
    free = prior.free
    # Fixed parameters have no inverse variance: restrict all matrices to the free ones
    wide = prior.covariance[np.ix_(free, free)]
    precision = np.linalg.inv(wide)
    mean = (prior.mean - at)[free]
    index = np.append(np.flatnonzero(free), len(free))
    products = reduced.products[index[:, None], index]
    root = np.linalg.cholesky(products[:-1, :-1] + precision)
    half = np.linalg.solve(root, products[:-1, -1] + precision @ mean)
    # Squared residual and prior, less what the fitted parameters explain
    square = products[-1, -1] + mean @ precision @ mean - half @ half
    logs = -0.5 * np.linalg.slogdet(wide)[1] - np.log(np.diag(root)).sum()
    after, covariance = at.copy(), np.zeros((len(free), len(free)))
    after[free] += np.linalg.solve(root.T, half)
    inverse = np.linalg.inv(root)
    covariance[np.ix_(free, free)] = inverse.T @ inverse
    return ParameterPosterior(float(reduced.constant + logs - 0.5 * square), after, covariance)


def unknowns_penalty(point: LinearizationPoint, deviations: Array) -> float:
    """Return -2 times the log density of the unknowns of a flight's pieces, up to a constant."""
    inverse, random = knot_precision(point.knots), point.random
    knots = random[:, WIDTH:-1].reshape(-1, AXES, point.knots)
    along = np.einsum('saj,jk,sak->a', knots, inverse, knots) / deviations**2
    states = np.sum((random[:, :WIDTH] / STATE) ** 2)
    return float(along.sum() + states + np.sum((random[:, -1] / PIECE_PRESSURE) ** 2))


def log_prior(deviations: Array, floor: Array = FLOOR) -> float:
    """Return the log density of the deviations' logarithms, up to a constant."""
    return float(-0.5 * np.sum((np.log(deviations / (USUAL * floor)) / LOOSE) ** 2))


def log_prior_slope(deviations: Array, floor: Array = FLOOR) -> tuple[Array, Array]:
    """Return the gradient of `log_prior` in the logarithms, and minus its Hessian."""
    slope: Array = -np.log(deviations / (USUAL * floor)) / LOOSE**2
    return slope, np.eye(len(floor)) / LOOSE**2

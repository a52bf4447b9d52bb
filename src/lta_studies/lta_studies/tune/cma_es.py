"""
CMA-ES: minimise a function with few evaluations and without gradients.

Implements the covariance matrix adaptation evolution strategy with the default parameters of
Hansen's tutorial (2016, arXiv:1604.00772, table 1 and equations 42 to 47, positive weights only).
Call `ask` for a generation, evaluate it, and pass the costs to `tell`. Only the ranking of the
costs matters, so the cost function may be discontinuous. A search is reproducible from its seed.
"""

from collections.abc import Sequence
import math
from typing import final

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@final
class CmaEsSearch:
    """
    A CMA-ES search with an ask/tell interface.

    Parameters
    ----------
    start : array_like, shape (n,)
        Initial mean.
    step : float
        Standard deviation of the first generation.
    seed : int
        Random seed.

    Attributes
    ----------
    size : int
        Number of candidates per generation.
    mean : ndarray, shape (n,)
        Current mean.
    step : float
        Current overall standard deviation.

    """

    def __init__(self, start: Sequence[float], step: float, seed: int) -> None:
        self.mean = np.array(start, dtype=np.float64)
        self.step = step
        n = self._n = len(self.mean)
        # Below, with Hansen's symbols: `mass` is mu_eff, `_keep_path` c_c, `_keep_step` c_sigma,
        # `_one` c_1, `_many` c_mu, `_damping` d_sigma, and `_length` the expected norm of N(0, I).
        # Population size lambda and logarithmic weights of the better half.
        self.size = 4 + int(3.0 * math.log(n))
        half = self.size // 2
        raw = math.log(half + 0.5) - np.log(np.arange(1, half + 1))
        self._weights = w = raw / raw.sum()
        mass = self._mass = float(1.0 / (w**2).sum())
        self._keep_path = (4.0 + mass / n) / (n + 4.0 + 2.0 * mass / n)
        self._keep_step = (mass + 2.0) / (n + mass + 5.0)
        self._one = 2.0 / ((n + 1.3) ** 2 + mass)
        many = 2.0 * (mass - 2.0 + 1.0 / mass) / ((n + 2.0) ** 2 + mass)
        # The learning rates must not add to more than 1, or old covariance would count negatively.
        self._many = min(1.0 - self._one, many)
        self._damping = (
            1.0 + 2.0 * max(0.0, math.sqrt((mass - 1.0) / (n + 1.0)) - 1.0) + self._keep_step
        )
        self._length = math.sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n))
        self._covariance = np.eye(n)
        self._path, self._step_path = np.zeros(n), np.zeros(n)
        self._generation = 0
        self._chance = np.random.default_rng(seed)

    def ask(self) -> list[Vector]:
        """Draw the candidates of the next generation."""
        values, self._axes = np.linalg.eigh(self._covariance)
        # Rounding can make a tiny eigenvalue negative.
        self._lengths = np.sqrt(np.maximum(values, 1e-20))
        draws = self._chance.standard_normal((self.size, self._n))
        return [self.mean + self.step * (self._axes @ (self._lengths * z)) for z in draws]

    def tell(self, candidates: Sequence[Vector], costs: Sequence[float]) -> None:
        """Update mean, step size and covariance from the costs of a generation."""
        # A stable sort keeps equal costs in the order drawn, so runs are reproducible.
        order = np.argsort(np.array(costs), kind='stable')[: len(self._weights)]
        best = np.array([candidates[k] for k in order])
        moves = (best - self.mean) / self.step
        move = self._weights @ moves
        self.mean = self.mean + self.step * move
        self._generation += 1
        self._update_paths(move)
        # Rank-one update from the evolution path, rank-mu update from the best candidates.
        outer = np.outer(self._path, self._path)
        several = (self._weights[:, None] * moves).T @ moves
        retained = 1.0 - self._one - self._many
        self._covariance = retained * self._covariance + self._one * outer + self._many * several
        # A path longer than that of a random walk means consistent moves, so the step grows.
        growth = float(np.linalg.norm(self._step_path)) / self._length - 1.0
        self.step *= math.exp(self._keep_step / self._damping * growth)

    def _update_paths(self, move: Vector) -> None:
        """Update the evolution paths."""
        c, mass = self._keep_step, self._mass
        # C^(-1/2) times the mean's move: whitened, its norm is that of N(0, I) without selection.
        white = self._axes @ ((self._axes.T @ move) / self._lengths)
        self._step_path = (1.0 - c) * self._step_path + math.sqrt(c * (2.0 - c) * mass) * white
        # The path starts at zero; the root corrects its expected norm in the first generations.
        expected = math.sqrt(1.0 - (1.0 - c) ** (2 * self._generation)) * self._length
        # Hansen's h_sigma: pause the rank-one path while the step size grows fast.
        calm = float(np.linalg.norm(self._step_path)) < (1.4 + 2.0 / (self._n + 1.0)) * expected
        c = self._keep_path
        push = math.sqrt(c * (2.0 - c) * mass) if calm else 0.0
        self._path = (1.0 - c) * self._path + push * move

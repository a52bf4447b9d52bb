"""
How far ahead a model sees, and how that answers to its knobs: errors at a few horizons.

Each piece begins where the poses around its beginning say, and nothing helps the model on its way:
no latent force, no freed state. That is what a forecast is worth, and what a few knobs can be
fitted to where the model's own error, not the tracker's noise, is what counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_discovery.flights.measured import PERIOD
from lta_discovery.model.rotations import logarithm, product, reverse
from lta_discovery.replay.linear import AXES, Point, still
from lta_discovery.replay.linearise import begun_by, Linearised, POSE
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import in_map, told, tracker_frame
from lta_discovery.replay.tangent import WIDTH
from lta_discovery.replay.turns import Met, met
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HORIZONS: Final = (1.0, 2.0, 3.0, 4.0, 5.0)  # s
CHUNK: Final = 32  # pieces at a time, which bounds the memory


@final
@dataclass(frozen=True, slots=True)
class Ahead:
    """
    Errors of one flight about one set of parameters.

    Attributes
    ----------
    left : ndarray, shape (S, H, 6)
        Measured less predicted at each horizon: place, then rotation vector. NaN where the
        flight does not say. [m, rad]
    columns : ndarray, shape (S, H, 6, K)
        How the prediction answers to each knob asked for; K is 0 where none was.

    """

    left: Array
    columns: Array


def ahead(
    flight: Linearised,
    point: Point,
    which: Sequence[int] = (),
    horizons: Sequence[float] = HORIZONS,
) -> Ahead:
    """
    Return how far a model is off ahead of each piece's beginning, and how it answers.

    Parameters
    ----------
    flight : Linearised
        The flight, in pieces longer than the last horizon.
    point : Point
        The parameters; its states and latent forces of the pieces are not used.
    which : sequence of int
        Of the flight's knobs.
    horizons : sequence of float
        [s]

    """
    wanted = np.isin(np.arange(len(flight.knobs)), which)
    about = met(flight.replay, flight.knobs, point, wanted)
    begun = Point(point.nominal, point.values, still(flight.replay.cut))
    index = np.rint(np.asarray(horizons) / PERIOD).astype(np.int64)
    parts = []
    for begin in range(0, len(flight.replay.first), CHUNK):
        some = slice(begin, begin + CHUNK)
        parts.append(_of_some(flight, begun, about, which, index, some))
    left, columns = (np.concatenate(each) for each in zip(*parts, strict=True))
    return Ahead(left, columns)


def _of_some(
    flight: Linearised,
    begun: Point,
    about: Met,
    which: Sequence[int],
    index: NDArray[np.int64],
    some: slice,
) -> tuple[Array, Array]:
    """Return errors and columns of some pieces."""
    replay, time, acting = flight.replay, flight.time[some], about.rows.acting
    start = in_map(replay.cut.start[some], acting)
    latent = np.zeros((len(time), replay.span, AXES))
    states = replay.fly(about.rows, about.ready, start, latent, some)
    grid = states[:, ::STEPS]
    base = told(grid, time, acting, flight.places)
    at = flight.index[some][:, index]
    turn = logarithm(product(reverse(base.quaternion[:, index]), replay.flight.quaternion[at]))
    left = np.concatenate([replay.flight.position[at] - base.position[:, index], turn], axis=-1)
    left[~replay.cut.inside[some][:, index]] = np.nan
    columns = np.zeros((*left.shape, len(which)))
    if not len(which):
        return left, columns
    answers = flight.changes(begun, about, states, some)[:, index, :POSE]
    order = list(which)
    for j, k in enumerate(about.moving):
        columns[..., order.index(k)] = answers[..., flight.motion + j]
    for turned, k in zip(about.turned, about.reading, strict=True):
        # Where the tracker's frame turns, so does the state in which a piece begins.
        begins = begun_by(replay.cut.start[some], turned)
        columns[..., order.index(k)] = np.einsum('shpb,sb->shp', answers[..., :WIDTH], begins)
    columns[..., :3, :] = tracker_frame(acting)[0] @ columns[..., :3, :]
    for turned, k in zip(about.turned, about.reading, strict=True):
        a, b = (told(grid, time, rows.acting, flight.places) for rows in turned[:2])
        turns = logarithm(product(reverse(a.quaternion), b.quaternion))
        said = np.concatenate([b.position - a.position, turns], axis=-1)
        columns[..., order.index(k)] += said[:, index] / turned.step
    return left, columns

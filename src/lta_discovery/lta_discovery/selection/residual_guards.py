"""
What a name has to show beside something that remains and has none.

A latent wrench stands for what has no name. A candidate may explain a little of it by chance or
likeness; or it may be of another place: on axes that are calm, about a sensor, or a second cause
on an axis, which both sides of the flights find by themselves.
"""

from collections.abc import Sequence
from typing import Final

from lta_discovery.fit.evidence import knot_precision
from lta_discovery.model.parameters import PARTS
from lta_discovery.replay.linearized_flight import AXES, LinearizedFlight
from lta_discovery.replay.variational_equation import WIDTH
from lta_discovery.selection.acceptance import LARGER, PART
from lta_discovery.unmodeled.remainders import CLEAR
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Effects whose force follows the motion, as much of what is outside the library does.
MOTION: Final = (*PARTS, 'munk_moment', 'cross_flow')
# And those whose force follows place or time.
SCENERY: Final = ('steady_wind', 'wind_gradient', 'helium_leak')
LOUD: Final = 4.0  # floors; of what remains, to put in question what was named
SOUND: Final = 40.0  # nats; of a name beside something larger on its axes
AGAIN: Final = 0.2  # of its value; by which the sides may differ about such a name
MOST: Final = 0.4  # of a deviation; what may remain where a candidate was most of it
LESSER: Final = 0.5  # of the largest that remains; what a coefficient of motion has to explain
TOUCHED: Final = 0.15  # of a deviation; a candidate that changes more has to do with it
FREE: Final = 1e3  # floors; a latent force that can be anything
ALIKE: Final = 0.5  # of a column; what a latent force has to explain of it
NEARLY: Final = 0.85  # of what the axis explains that explains most


def follows_motion(name: str) -> bool:
    """Tell whether a knob is a word for whatever follows the motion."""
    return name.partition('.')[0] in MOTION


def is_vague(name: str) -> bool:
    """Tell whether a knob is a word for whatever follows motion, place or time."""
    return follows_motion(name) or name.partition('.')[0] in SCENERY


def find_acting_axes(linear: LinearizedFlight, name: str, floor: Array) -> NDArray[np.bool_]:
    """
    Return the axes on which a knob acts: those whose latent force alone could do what it does.

    None for a knob that no force looks like, as those of sensors.
    """
    count = linear.knots
    column, inverse = linear.unknown_count + linear.names.index(name), knot_precision(count)
    shares = np.zeros(AXES)
    for axis in range(AXES):
        at = slice(WIDTH + axis * count, WIDTH + (axis + 1) * count)
        inner = linear.grams[:, at, at] + inverse / (FREE * floor[axis]) ** 2
        cross = linear.grams[:, at, column, None]
        shares[axis] = np.sum(cross * np.linalg.solve(inner, cross))
    shares /= max(float(linear.grams[:, column, column].sum()), 1e-300)
    acts: NDArray[np.bool_] = (shares > ALIKE) & (shares > NEARLY * shares.max())
    return acts


def is_partial(acts: NDArray[np.bool_], before: Array, final: Array) -> bool:
    """
    Tell whether a candidate has at most explained a part of something larger.

    Parameters
    ----------
    acts : ndarray of bool, shape (6,)
        The axes on which it acts.
    before, final : ndarray, shape (6,)
        Deviations of the latent wrench without the candidate, and at the end. [floors]

    """
    return bool(acts.any() and np.all((final > np.maximum(LOUD, MOST * before))[acts]))


def is_lesser(name: str, acts: NDArray[np.bool_], before: Array, final: Array) -> bool:
    """
    Tell whether a name is a coefficient of motion for little beside what has no name.

    What has none pushes on several axes at once, and drag or added mass are the words for whatever
    follows the motion: a little of it on an axis is no proof of either. Parameters are as for
    `is_partial`, and the candidate's name.
    """
    explained = np.sqrt(np.maximum(before**2 - final**2, 0.0))
    return follows_motion(name) and bool(
        acts.any() and explained[acts].max() < LESSER * final.max()
    )


def is_minor(name: str, acts: NDArray[np.bool_], before: Array, final: Array) -> bool:
    """
    Tell whether a coefficient of motion leaves more than it explained, where it explained most.

    Parameters are as for `is_lesser`.
    """
    if not follows_motion(name) or not acts.any():
        return False
    explained = np.sqrt(np.maximum(before**2 - final**2, 0.0))
    k = int(np.argmax(np.where(acts, explained, -1.0)))
    return bool(final[k] > max(CLEAR, explained[k]))


def is_calm(acts: NDArray[np.bool_], floors: Array) -> bool:
    """Tell whether nothing remains on the axes on which a candidate acts, if there are any."""
    return not bool(np.any(floors[acts] > CLEAR))


def is_unaffected(before: Array, after: Array) -> bool:
    """Tell whether a candidate leaves all that remains as it was."""
    remains = after > CLEAR
    return bool(np.all(np.abs(after - before)[remains] < TOUCHED * before[remains]))


def is_sound(name: str, gains: Sequence[float], part: float) -> bool:
    """
    Tell whether a name may stand beside something larger on its axes.

    Each side found it by itself, and as large as the other: two causes that push on one axis. What
    is larger may follow the motion, so a name that does has to come out the same to a tenth. It
    has to leave what remains as it was (`is_unaffected`) as well: the weight of a rope on the
    floor is no ballast.

    Parameters
    ----------
    name : str
        Of the candidate.
    gains : pair of float
        Log evidence that it has won on each side. [nats]
    part : float
        Difference of the values of the sides, as a part of the larger one.

    """
    again = part < (PART if follows_motion(name) else AGAIN)
    return again and min(gains) > LARGER and sum(gains) > SOUND

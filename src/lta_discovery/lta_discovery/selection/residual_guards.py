"""
Guard names against a large unexplained remainder.

The latent wrench absorbs effects outside the library. A candidate may explain a small part of it
by similarity. It is credible if it acts elsewhere: on axes without a remainder, on a sensor, or as
a second cause that both sides support alone.
"""

from collections.abc import Sequence
from typing import Final

from lta_discovery.fit.evidence import knot_precision
from lta_discovery.model.parameters import PARTS
from lta_discovery.replay.linearized_flight import AXES, LinearizedFlight
from lta_discovery.replay.variational_equation import WIDTH
from lta_discovery.selection.candidate_acceptance import LARGER, PART
from lta_discovery.unmodeled.unexplained_force import CLEAR
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Effects whose force follows the motion, like most effects outside the library.
MOTION: Final = (*PARTS, 'munk_moment', 'cross_flow')
# Effects whose force follows place or time.
SCENERY: Final = ('steady_wind', 'wind_gradient', 'helium_leak')
LOUD: Final = 4.0  # noise floors; a larger remainder puts names in question
SOUND: Final = 40.0  # nats; required of a name if a larger remainder is on its axes
AGAIN: Final = 0.2  # of its value; largest difference of the sides for such a name
MOST: Final = 0.4  # of a deviation; largest remainder if a candidate explains most of it
LESSER: Final = 0.5  # of the largest remainder; smallest explained part for a motion effect
TOUCHED: Final = 0.15  # of a deviation; a candidate that changes more is related to it
FREE: Final = 1e3  # noise floors; a practically unconstrained latent force
ALIKE: Final = 0.5  # of a column; part that the latent force of an acting axis explains
NEARLY: Final = 0.85  # of the largest such part of any axis


def is_motion_coefficient(name: str) -> bool:
    """Return whether an effect is a generic coefficient of the motion."""
    return name.partition('.')[0] in MOTION


def is_generic_effect(name: str) -> bool:
    """Return whether an effect is a generic function of motion, place or time."""
    return is_motion_coefficient(name) or name.partition('.')[0] in SCENERY


def find_acting_axes(linear: LinearizedFlight, name: str, floor: Array) -> NDArray[np.bool_]:
    """
    Return the axes on which an effect acts: those whose latent force alone can replace it.

    None for effects that resemble no force, such as those of sensors.
    """
    count = linear.knots
    column, inverse = linear.unknown_count + linear.names.index(name), knot_precision(count)
    shares = np.zeros(AXES)
    for axis in range(AXES):
        at = slice(WIDTH + axis * count, WIDTH + (axis + 1) * count)
        # A practically free latent force on this axis alone
        inner = linear.grams[:, at, at] + inverse / (FREE * floor[axis]) ** 2
        cross = linear.grams[:, at, column, None]
        shares[axis] = np.sum(cross * np.linalg.solve(inner, cross))
    # Share of the squared column; the bound avoids 0 / 0 for unobservable effects
    shares /= max(float(linear.grams[:, column, column].sum()), 1e-300)
    acts: NDArray[np.bool_] = (shares > ALIKE) & (shares > NEARLY * shares.max())
    return acts


def is_partial_explanation(acts: NDArray[np.bool_], before: Array, final: Array) -> bool:
    """
    Return whether a candidate at most explained a part of a larger remainder.

    `acts`, shape (6,): the axes on which it acts. `before`, `final`, shape (6,): deviations of the
    latent wrench without the candidate, and at the end [noise floors].
    """
    return bool(acts.any() and np.all((final > np.maximum(LOUD, MOST * before))[acts]))


def is_small_motion_effect(
    name: str, acts: NDArray[np.bool_], before: Array, final: Array
) -> bool:
    """
    Return whether a motion effect is small compared with the remainder.

    An effect outside the library acts on several axes. Drag and added mass fit anything that
    follows the motion, so a small part on one axis is no evidence for them. Parameters are as for
    `is_partial_explanation`.
    """
    explained = np.sqrt(np.maximum(before**2 - final**2, 0.0))
    return is_motion_coefficient(name) and bool(
        acts.any() and explained[acts].max() < LESSER * final.max()
    )


def leaves_larger_remainder(
    name: str, acts: NDArray[np.bool_], before: Array, final: Array
) -> bool:
    """
    Return whether a motion effect leaves more than it explains on its main axis.

    Parameters are as for `is_small_motion_effect`.
    """
    if not is_motion_coefficient(name) or not acts.any():
        return False
    explained = np.sqrt(np.maximum(before**2 - final**2, 0.0))
    k = int(np.argmax(np.where(acts, explained, -1.0)))
    return bool(final[k] > max(CLEAR, explained[k]))


def has_no_remainder(acts: NDArray[np.bool_], floors: Array) -> bool:
    """Return whether the axes of a candidate have no remainder."""
    return not bool(np.any(floors[acts] > CLEAR))


def leaves_remainder_unchanged(before: Array, after: Array) -> bool:
    """Return whether a candidate leaves the remainder unchanged."""
    remains = after > CLEAR
    return bool(np.all(np.abs(after - before)[remains] < TOUCHED * before[remains]))


def is_credible(name: str, gains: Sequence[float], part: float) -> bool:
    """
    Return whether a name is credible despite a larger remainder on its axes.

    Both sides have to support it alone, with the same value: two causes then act on one axis. A
    motion effect has to agree to a tenth, because the remainder may follow the motion too. The
    remainder also has to stay unchanged (`leaves_remainder_unchanged`): the weight of a
    rope on the floor is     not ballast.

    `gains`: log evidence of each side [nats]. `part`: difference of the values of the sides,
    relative to the larger one.
    """
    again = part < (PART if is_motion_coefficient(name) else AGAIN)
    return again and min(gains) > LARGER and sum(gains) > SOUND

"""
Decide the verdict of conclusive flights, and describe unexplained forces in sentences.

A force is unexplained if an axis of the latent wrench exceeds the noise floor, a generic rival is
confirmed, the wrench oscillates, or the residuals have a spectral line.
"""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_discovery.finding import Verdict
from lta_discovery.fit.evidence import FLOOR
from lta_discovery.unmodeled.draught import LEVEL
from lta_discovery.unmodeled.generic_terms import CONSTANT
from lta_discovery.unmodeled.oscillation import dominant_oscillations, LatentOscillation
from lta_discovery.unmodeled.rivals import GenericRival
from lta_discovery.unmodeled.spectral_line import SpectralLine
from lta_discovery.unmodeled.unexplained_force import CARRIED, Remainder
from lta_model.effects.protocol import AXES as NAMES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WORTH: Final = 12.0  # nats; required of a rival on both sides
EACH: Final = 3.0  # nats; required of a rival on each side
ALONE: Final = 20.0  # nats; or required on one side, if the other does not contradict it
AGAINST: Final = 3.0  # nats; a rival with a larger loss is contradicted
QUIET: Final = 0.5  # of the smaller of surge and sway; limit of the other axes in gusts
LINES: Final = 3  # most reported lines; an oscillation shows in many channels
SAID: Final = {
    'x': 'the position along x', 'y': 'the position along y', 'z': 'the height',
    'turn_x': 'the roll angle', 'turn_y': 'the pitch angle', 'turn_z': 'the yaw angle',
    'p': 'the roll rate', 'q': 'the pitch rate', 'r': 'the yaw rate',
    'fx': 'the specific force ahead', 'fy': 'the specific force to the left',
    'fz': 'the specific force upwards',
}  # fmt: skip


def select_confirmed_rivals(rivals: Sequence[GenericRival]) -> list[GenericRival]:
    """Return the rivals that both sides confirm."""
    return [
        one for one in rivals if one.total_evidence > WORTH and min(one.gain, one.carried) > EACH
    ]


def select_evident_rivals(rivals: Sequence[GenericRival]) -> list[GenericRival]:
    """
    Return the rivals that show an unexplained force, even on one side only.

    Rare conditions (a one-way flap, a place) may occur on one side only. Such a rival is evidence
    of a force, but does not displace a named effect.
    """
    return [
        one
        for one in rivals
        if one in select_confirmed_rivals([one])
        or (one.gain > ALONE and one.carried > -AGAINST)
        or (max(one.confirmed, one.carried) > ALONE and one.gain > -AGAINST)
    ]


def is_gusty(remains: Sequence[Remainder]) -> bool:
    """Return whether the remainder looks like gusts: surge and sway, without structure."""
    size = {one.axis: one.floors for one in remains}
    if not all(axis in size for axis in LEVEL):
        return False
    if any(one.carried > CARRIED for one in remains if one.axis in LEVEL):
        return False
    # Gusts push horizontally: other axes must be clearly weaker
    least = min(size[axis] for axis in LEVEL)
    return all(floors < QUIET * least for axis, floors in size.items() if axis not in LEVEL)


def decide_verdict(
    named: Sequence[str],
    remains: Sequence[Remainder],
    rivals: Sequence[GenericRival] = (),
    lines: Sequence[SpectralLine | LatentOscillation] = (),
) -> Verdict:
    """
    Decide the verdict of conclusive flights (`decide_study_verdict` tests whether they are).

    Parameters
    ----------
    remains : sequence of Remainder
        Axes above the noise floor, with these effects in the model.
    rivals : sequence of GenericRival
        With these effects in the model.
    lines : sequence of SpectralLine or LatentOscillation
        Of residuals and latent wrench.

    Returns
    -------
    str
        'none', 'named', 'unexplained' or 'named+unexplained'.

    """
    more = bool(lines) or bool(select_evident_rivals(rivals)) or bool(remains)
    if named:
        return 'named+unexplained' if more else 'named'
    return 'unexplained' if more else 'none'


def add_rival_terms(
    remains: Sequence[Remainder], rivals: Sequence[GenericRival], floor: Array = FLOOR
) -> list[Remainder]:
    """
    Add the terms of the best rival to the remainder of each axis.

    Rivals were computed with all nuisances, so their terms take precedence. Axes below the noise
    floor are added if a rival is evident there.
    """
    out = {one.axis: one for one in remains}
    done_axes: set[str] = set()
    for one in select_evident_rivals(rivals):
        for axis in set(one.axes) - done_axes:
            before = out.get(axis)
            floors = one.size / float(floor[NAMES.index(axis)])
            if before is not None:
                share = max(one.share, before.carried) if axis == one.axis else before.carried
                out[axis] = before._replace(follows=(one.term,), carried=share)
            # An axis without a remainder of its own, but with an evident rival
            elif before is None and axis == one.axis and floors > 1.0:
                out[axis] = Remainder(axis, one.size, floors, (one.term,), one.share)
        # Rivals come best first: later ones must not overwrite
        done_axes |= set(one.axes)
    return sorted(out.values(), key=lambda one: -one.floors)


def _format_size(axis: str, size: float) -> tuple[str, str]:
    """Return 'pitch moment' and its size."""
    kind, unit = ('force', 'mN') if NAMES.index(axis) < 3 else ('moment', 'mN m')
    return f'{axis} {kind}', f'{1e3 * size:.2g} {unit}'


def format_remainder(one: Remainder) -> str:
    """Describe the remainder of an axis in words."""
    what, size = _format_size(one.axis, one.size)
    if not one.is_traced:
        return f'a {what} of {size}, of unknown cause'
    terms = [term for term in one.follows if term != CONSTANT]
    if terms:
        listed = ' and '.join(filter(None, [', '.join(terms[:-1]), terms[-1]]))
        return f'a {what} that varies with {listed}, {size}'
    if one.follows:
        return f'a constant {what}, {size}'
    return f'a {what} that is unrelated to all measured quantities, {size}'


def add_oscillations(
    remains: Sequence[Remainder], oscillations: Mapping[str, LatentOscillation]
) -> list[Remainder]:
    """Add the dominant oscillation of each axis to its remainder."""
    return [
        one._replace(
            follows=(f'an oscillation at {oscillations[one.axis].hertz:.2f} Hz',),
            carried=max(oscillations[one.axis].share, one.carried),
        )
        if one.axis in oscillations
        else one
        for one in remains
    ]


def describe_unexplained_forces(
    remains: Sequence[Remainder],
    lines: Sequence[SpectralLine] = (),
    oscillations: Sequence[LatentOscillation] = (),
) -> tuple[str, ...]:
    """
    Describe all unexplained forces in words.

    For example 'a pitch moment that varies with surge speed x yaw rate, 1.2 mN m'. An axis that an
    oscillation dominates has no further sentence.
    """
    dominant = dominant_oscillations(oscillations)
    out, rest = [], [one for one in remains if one.axis not in dominant]
    if is_gusty(rest):
        sizes = ' and '.join(
            _format_size(one.axis, one.size)[1] for one in rest if one.axis in LEVEL
        )
        out.append(f'gusts: random surge and sway forces, {sizes}')
        rest = [one for one in rest if one.axis not in LEVEL]
    out += [format_remainder(one) for one in rest]
    out += [one.sentence for one in oscillations[:LINES]]
    for line in lines[:LINES]:
        size = f'{line.amplitude:.2g} {line.unit}'
        out.append(f'an oscillation of {SAID[line.channel]} at {line.hertz:.1f} Hz, {size}')
    return tuple(out)

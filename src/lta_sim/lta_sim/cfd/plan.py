"""Which flows make a sweep, by fidelity, and how each is read when it is solved."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, final, Literal

from lta_sim.cfd.columns import REVERSED
from lta_sim.cfd.model import Model
from lta_sim.cfd.openfoam.case import Case
from lta_sim.cfd.still import AXES as SPINS
from lta_sim.cfd.still import blowing, RATES, spinning
from lta_sim.cfd.tunnel import (
    COARSE,
    fineness,
    PREVIEW,
    SPEEDS,
    steady_wind,
    transient_wind,
    TURNS,
)
import numpy as np
from numpy.typing import NDArray

Kind = Literal['wind', 'coarse', 'transient', 'spin', 'blow']
Air = tuple[float, float]  # density [kg/m3], kinematic viscosity [m2/s]
WINDS: Final = tuple(TURNS)
MIDDLE: Final = 1.0  # m/s
SLOW: Final = 0.2  # m/s, at which the steady model is right for a sphere
LENGTHS: Final = 26.0  # of flow in a transient, all but the first of which are averaged


@final
@dataclass(frozen=True, slots=True)
class Flow:
    """
    One flow of a sweep.

    Parameters
    ----------
    kind : str
        'wind', 'coarse' (a wind on a coarser mesh), 'transient', 'spin' or 'blow'.
    about : str
        Axis, or pattern.
    case : Case
        What is solved.
    speeds : sequence of float
        That it gives, m/s or rad/s.
    shares : mapping of str to float
        Rotors that are on.

    """

    kind: Kind
    about: str
    case: Case
    speeds: Sequence[float] = ()
    shares: Mapping[str, float] | None = None


def patterns(model: Model) -> dict[str, Mapping[str, float]]:
    """
    Return what blows: each rotor forward and reversed, and the patterns of the tunnel file.

    A rotor that symmetry brings to the place of one before it is left out: so is its column.
    """
    singles: dict[str, Mapping[str, float]] = {}
    changes = model.symmetries()
    for name in model.rotors:
        if not _is_like(model, name, singles, changes):
            singles[name] = {name: 1.0}
    back = {f'{name}{REVERSED}': {name: -1.0} for name in singles}
    return {**model.patterns, **singles, **back}


def _is_like(
    model: Model, name: str, before: Iterable[str], changes: Sequence[NDArray[np.float64]]
) -> bool:
    """Tell whether a symmetry of the bodies brings an earlier rotor to where this one is."""
    one = model.rotors[name]
    return any(
        np.allclose(change @ model.rotors[other].place, one.place, atol=1e-6)
        and np.allclose(change @ model.rotors[other].axis, one.axis, atol=1e-6)
        for other in before
        for change in changes
    )


def flows(model: Model, fidelity: str, air: Air, only: Sequence[str] = ()) -> list[Flow]:
    """
    Return the flows of a sweep, those that tell most first.

    Sway and pitch are left out where a quarter turn makes them of surge and roll.

    Parameters
    ----------
    model : Model
        The vehicle.
    fidelity : str
        'preview' or 'reference'.
    air : (float, float)
        Density [kg/m3] and kinematic viscosity [m2/s].
    only : sequence of str
        Axes and patterns, all by default.

    """
    found = [*_winds(model, fidelity, air[1]), *_spins(model, air[1]), *_blows(model, air)]
    if fidelity == 'preview':
        found += _coarse(model, air[1])
    return [flow for flow in found if not only or flow.about in only]


def _directions(model: Model) -> Sequence[str]:
    return ('heave', 'surge') if model.square else ('heave', 'surge', 'sway')


def _winds(model: Model, fidelity: str, viscosity: float) -> Iterator[Flow]:
    for axis in _directions(model):
        if fidelity == 'preview':
            case = steady_wind(model, axis, viscosity, PREVIEW)
            yield Flow('wind', axis, case, SPEEDS)
            continue
        fine = fineness(model, viscosity, MIDDLE)
        eddies = transient_wind(model, axis, viscosity, fine, MIDDLE, LENGTHS)
        yield Flow('transient', axis, eddies, (MIDDLE,))
        slow = steady_wind(model, axis, viscosity, PREVIEW, (SLOW,))
        yield Flow('wind', axis, replace(slow, name=f'{axis}, slow'), (SLOW,))


def _coarse(model: Model, viscosity: float) -> Iterator[Flow]:
    """Yield the middle speed of each wind on a coarser mesh."""
    for axis in _directions(model):
        case = steady_wind(model, axis, viscosity, COARSE, (MIDDLE,))
        yield Flow('coarse', axis, replace(case, name=f'{axis} on a coarser mesh'), (MIDDLE,))


def _spins(model: Model, viscosity: float) -> Iterator[Flow]:
    for about in SPINS:
        if about == 'pitch' and model.square:
            continue
        yield Flow('spin', about, spinning(model, about, viscosity), RATES)


def _blows(model: Model, air: Air) -> Iterator[Flow]:
    if not model.rotors:
        return
    for name, shares in patterns(model).items():
        yield Flow('blow', name, blowing(model, name, shares, air), shares=shares)

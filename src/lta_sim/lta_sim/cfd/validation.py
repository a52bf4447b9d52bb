"""The sphere in the tunnel, beside what was measured of real ones."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
import math
from typing import Final, final

from lta_sim.cfd.crew import Crew, points_or_why
from lta_sim.cfd.model import HULL, Model
from lta_sim.cfd.plan import Air, Flow, LENGTHS, MIDDLE
from lta_sim.cfd.shape import ellipse, revolved
from lta_sim.cfd.sphere import morrison, off
from lta_sim.cfd.sweep_table import Blow, Point
from lta_sim.cfd.tunnel import (
    COARSE,
    fineness,
    PREVIEW,
    ROUGH,
    SPEEDS,
    steady_wind,
    transient_wind,
)

SETTINGS: Final = {'wind': 'steady, {} cells', 'transient': 'transient, {} cells'}
# Speed [m/s] and diameters of flow: the wake of the fast one swings more.
TRANSIENTS: Final = ((2.0, 41.0), (MIDDLE, LENGTHS))


@final
@dataclass(frozen=True, slots=True)
class Judged:
    """A drag coefficient of the tunnel, beside what was measured. [1]."""

    setting: str
    cells: int
    speed: float
    reynolds: float
    coefficient: float
    error: float  # standard, or the spread of a steady flow
    measured: float  # Morrison's
    off: float  # 0 within the scatter
    seconds: float


def sphere() -> Model:
    """Return a sphere of 1 m."""
    return Model('sphere', {HULL: revolved(ellipse(), 0.5, 1.0)}, {}, {})


def flows(model: Model, fidelity: str, air: Air) -> list[Flow]:
    """Return the flows of a validation: steady on two meshes, or transient."""
    viscosity = air[1]
    if fidelity == 'preview':
        return [
            Flow('wind', 'surge', steady_wind(model, 'surge', viscosity, PREVIEW), SPEEDS),
            Flow('wind', 'surge', steady_wind(model, 'surge', viscosity, COARSE), SPEEDS),
        ]
    wanted = [(speed, fineness(model, viscosity, speed), long) for speed, long in TRANSIENTS]
    found = []
    for speed, fine, lengths in (*wanted, (MIDDLE, ROUGH, LENGTHS)):
        case = transient_wind(model, 'surge', viscosity, fine, speed, lengths)
        named = replace(case, name=f'{case.name}, hull at level {fine.hull}')
        found.append(Flow('transient', 'surge', named, (speed,)))
    return found


def judge(
    crew: Crew, model: Model, wanted: Sequence[Flow], air: Air, said: Callable[[str], None]
) -> list[Judged]:
    """Return all points of some flows beside what was measured, and say what came to nothing."""
    found = []
    with closing(crew.solved(model, wanted, air[0])) as coming:
        for flow, came in coming:
            assert not isinstance(came, Blow)
            points, reasons = points_or_why(flow, came)
            for name, reason in reasons.items():
                said(f'{name}: {reason}')
            for point in points:
                setting = SETTINGS[flow.kind].format(point.evidence.cells)
                found.append(judged(setting, point, air))
    return found


def judged(setting: str, point: Point, air: Air) -> Judged:
    """Return a point of the sphere beside what was measured."""
    density, viscosity = air
    reynolds = point.speed / viscosity
    area = 0.25 * math.pi
    coefficient = -point.force[0] / (0.5 * density * point.speed**2 * area)
    return Judged(
        setting, point.evidence.cells, point.speed, reynolds, coefficient, point.evidence.spread,
        morrison(reynolds), off(coefficient, reynolds), point.evidence.seconds,
    )  # fmt: skip

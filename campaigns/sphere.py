# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compare the drag of a sphere in the wind tunnel with measurements.

Morrison 2013, An Introduction to Fluid Mechanics, fits all Reynolds numbers up to 1e6 in one
formula; Achenbach 1972 (J. Fluid Mech. 54:565) measured 0.45 to 0.50 between 5e4 and 1.2e5, where
Morrison's formula gives 0.41. A real sphere lies within that scatter.

Needs OpenFOAM. A kind is a fidelity of `lta cfd run`. The steady flows of `preview`, on two
meshes, take minutes, the transient ones of `reference` about an hour. Solved flows are cached.
"""

from argparse import Namespace
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
import math
from typing import Final, final

from lta_config.machine import count_cores
from lta_windtunnel.flow_plan import Air, MIDDLE_SPEED, TRANSIENT_LENGTHS, TUNNEL_AIR, TunnelFlow
from lta_windtunnel.openfoam.case import cache_folder, require_openfoam
from lta_windtunnel.shape import ellipse_profile, revolve_profile
from lta_windtunnel.solve import split_failed_points, ThreadedFlowSolver
from lta_windtunnel.sweep_table import Blow, SweepPoint
from lta_windtunnel.tunnel import (
    build_steady_wind_case,
    build_transient_wind_case,
    choose_mesh_fineness,
    COARSE_MESH,
    PREVIEW,
    ROUGH_MESH,
    SPEEDS,
)
from lta_windtunnel.tunnel_model import HULL_PATCH, TunnelModel

from campaigns.harness import Campaign, Case, Row, Rows

RUN_TITLES: Final = {'wind': 'steady, {} cells', 'transient': 'transient, {} cells'}
# Speed [m/s] and diameters of flow: the wake of the fast one swings more.
TRANSIENTS: Final = ((2.0, 41.0), (MIDDLE_SPEED, TRANSIENT_LENGTHS))
SCATTER: Final = (0.45, 0.50)  # measured drag coefficients between these Reynolds numbers
# Slightly beyond the measured range: the drag stays level up to about 2e5.
SCATTER_RANGE: Final = (5e4, 1.4e5)


def morrison_drag_coefficient(reynolds: float) -> float:
    """Return the drag coefficient of a smooth sphere on its frontal area. [1]."""
    fifth, crisis = reynolds / 5.0, reynolds / 2.63e5
    coefficient: float = (
        24.0 / reynolds
        + 2.6 * fifth / (1.0 + fifth**1.52)
        + 0.411 * crisis**-7.94 / (1.0 + crisis**-8.0)
        + 0.25 * (reynolds / 1e6) / (1.0 + reynolds / 1e6)
    )
    return coefficient


def relative_deviation(coefficient: float, reynolds: float) -> float:
    """
    Return the relative deviation of a coefficient from measurements, 0 within their scatter [1].

    The scatter spans from Morrison's formula to the highest measured value.
    """
    low = high = morrison_drag_coefficient(reynolds)
    if SCATTER_RANGE[0] <= reynolds <= SCATTER_RANGE[1]:
        low, high = min(low, SCATTER[0]), max(high, SCATTER[1])
    if coefficient < low:
        return coefficient / low - 1.0
    return max(coefficient / high - 1.0, 0.0)


@final
@dataclass(frozen=True, slots=True)
class SphereComparison:
    """A drag coefficient from the tunnel and the measured one [1]."""

    setting: str
    cells: int
    speed: float
    reynolds: float
    coefficient: float
    error: float  # standard, or the spread of a steady flow
    measured: float  # Morrison's
    off: float  # 0 within the scatter
    seconds: float


def build_sphere_model() -> TunnelModel:
    """Return a sphere of 1 m diameter."""
    return TunnelModel(
        'sphere', {HULL_PATCH: revolve_profile(ellipse_profile(), 0.5, 1.0)}, {}, {}
    )


def plan_validation_flows(model: TunnelModel, fidelity: str, air: Air) -> list[TunnelFlow]:
    """Return the flows of a validation: steady on two meshes, or transient."""
    viscosity = air[1]
    if fidelity == 'preview':
        return [
            TunnelFlow(
                'wind', 'surge', build_steady_wind_case(model, 'surge', viscosity, PREVIEW), SPEEDS
            ),
            TunnelFlow(
                'wind',
                'surge',
                build_steady_wind_case(model, 'surge', viscosity, COARSE_MESH),
                SPEEDS,
            ),
        ]
    cases = [
        (speed, choose_mesh_fineness(model, viscosity, speed), long) for speed, long in TRANSIENTS
    ]
    flows = []
    for speed, fine, lengths in (*cases, (MIDDLE_SPEED, ROUGH_MESH, TRANSIENT_LENGTHS)):
        case = build_transient_wind_case(model, 'surge', viscosity, fine, speed, lengths)
        named = replace(case, name=f'{case.name}, hull at level {fine.hull}')
        flows.append(TunnelFlow('transient', 'surge', named, (speed,)))
    return flows


def compare_with_measurements(
    solver: ThreadedFlowSolver,
    model: TunnelModel,
    planned: Sequence[TunnelFlow],
    air: Air,
    report: Callable[[str], None],
) -> list[SphereComparison]:
    """Solve flows and compare all points with measured drag; report failed flows."""
    comparisons = []
    with closing(solver.solve_flows(model, planned, air[0])) as results:
        for flow, result in results:
            assert not isinstance(result, Blow)
            points, reasons = split_failed_points(flow, result)
            for name, reason in reasons.items():
                report(f'{name}: {reason}')
            for point in points:
                setting = RUN_TITLES[flow.kind].format(point.evidence.cells)
                comparisons.append(compare_sphere_drag(setting, point, air))
    return comparisons


def compare_sphere_drag(setting: str, point: SweepPoint, air: Air) -> SphereComparison:
    """Compare a point of the sphere with measured drag."""
    density, viscosity = air
    # The diameter is 1 m
    reynolds = point.speed / viscosity
    area = 0.25 * math.pi
    coefficient = -point.force[0] / (0.5 * density * point.speed**2 * area)
    return SphereComparison(
        setting, point.evidence.cells, point.speed, reynolds, coefficient, point.evidence.spread,
        morrison_drag_coefficient(reynolds), relative_deviation(coefficient, reynolds),
        point.evidence.seconds,
    )  # fmt: skip


KINDS: Final = ('preview', 'reference')


def solve_sphere(case: Case, options: Namespace) -> Row:
    """Solve the flows of a fidelity, and compare each point with the measured drag."""
    require_openfoam()
    model, failures = build_sphere_model(), list[str]()
    flows = plan_validation_flows(model, case.kind, TUNNEL_AIR)
    solver = ThreadedFlowSolver(cache_folder(), count_cores(), lambda *_: None)
    points = compare_with_measurements(solver, model, flows, TUNNEL_AIR, failures.append)
    return {'points': [asdict(each) for each in points], 'wrong': '; '.join(failures)}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the lines of the table."""
    yield '| setting | Reynolds number | drag coefficient | Morrison | outside the scatter by |'
    yield '|---|---|---|---|---|'
    for row in rows.values():
        for each in row.get('points', ()):
            yield (
                f'| {each["setting"]} | {each["reynolds"]:.2g} | {each["coefficient"]:.3f} '
                f'± {each["error"] * each["coefficient"]:.3f} | {each["measured"]:.3f} '
                f'| {100 * each["off"]:+.0f} % |'
            )


CAMPAIGN: Final = Campaign(
    lambda options: KINDS, solve_sphere, list_table, smoke='--kinds preview'
)

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Solve a whole sweep in parallel threads, each running a program on one core.

On two cores this is faster than one flow on both. A failing flow does not affect the others: it is
reported and left out.
"""

from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
import os
from pathlib import Path
from typing import Final, final

from lta_config.errors import BadInput
from lta_windtunnel import reduce
from lta_windtunnel.analytic import damping_moment, drag_force
from lta_windtunnel.flow_plan import Air, TunnelFlow
from lta_windtunnel.openfoam.case import (
    CaseFailed,
    CaseRunner,
    find_openfoam_version,
    FoamCase,
    Progress,
)
from lta_windtunnel.openfoam.output_reader import MeshFacts, read_mesh
from lta_windtunnel.still_air import TURN_RATES
from lta_windtunnel.sweep_table import (
    AXES,
    Axis,
    Blow,
    FlowQuality,
    RotorPlacement,
    SweepPoint,
    TunnelSweep,
)
from lta_windtunnel.tunnel import INCIDENCES, SPEEDS
from lta_windtunnel.tunnel_model import TunnelModel

SUMMARIZERS: Final = {
    'wind': reduce.summarize_steady_wind,
    'coarse': reduce.summarize_steady_wind,
    'transient': reduce.summarize_transient_wind,
    'spin': reduce.summarize_rotation,
}
Points = tuple[list[SweepPoint], dict[str, str]]  # points, and the refused ones with their reason
Found = Points | Blow


@final
class ThreadedFlowSolver:
    """
    Solve flows on this machine.

    `folder`: cache of the solved cases. `jobs`: number of parallel flows. `tell`: called with the
    progress of each case. `retry_failed`: whether to repeat cases that failed in an earlier run.
    """

    def __init__(
        self, folder: Path, jobs: int, tell: Progress, retry_failed: bool = False
    ) -> None:
        self._stages = CaseRunner(folder, tell, retry_failed)
        self._jobs = jobs

    def solver_version(self) -> str:
        """Return name and version of the solver."""
        return find_openfoam_version()

    def solve_flows(
        self, model: TunnelModel, flows: Sequence[TunnelFlow], density: float
    ) -> Generator[tuple[TunnelFlow, Found | CaseFailed]]:
        """Yield each flow with its result; arguments as in `solve_flow`."""
        with ThreadPoolExecutor(self._jobs) as pool:
            try:
                # Each mesh once, before all flows that share it
                meshes = {
                    mesh.key: pool.submit(solve_mesh, self._stages, mesh)
                    for mesh in list_distinct_meshes(flows)
                }
                pending = [
                    (
                        flow,
                        pool.submit(self._wait_for, meshes[flow.mesh.key], model, flow, density),
                    )
                    for flow in flows
                ]
                # In submission order, so that results do not depend on timing.
                for flow, future in pending:
                    try:
                        yield flow, future.result()
                    except CaseFailed as error:
                        yield flow, error
            # Also for KeyboardInterrupt and a closed generator: leave no solver running
            except BaseException:
                self._stages.stop()
                pool.shutdown(wait=False, cancel_futures=True)
                raise

    def _wait_for(
        self, mesh: Future[MeshFacts], model: TunnelModel, flow: TunnelFlow, density: float
    ) -> Found:
        """Solve a flow after its mesh, or raise the reason why that failed."""
        mesh.result()
        return solve_flow(self._stages, model, flow, density)


def list_distinct_meshes(flows: Sequence[TunnelFlow]) -> list[FoamCase]:
    """Return the distinct meshes of some flows."""
    return list({flow.mesh.key: flow.mesh for flow in flows}.values())


def solve_mesh(stages: CaseRunner, mesh: FoamCase) -> MeshFacts:
    """Solve a mesh and return its facts; raise `CaseFailed` if it is invalid."""
    facts = read_mesh(stages.solve(mesh))
    reduce.check_mesh(mesh.name, facts)
    return facts


def solve_flow(stages: CaseRunner, model: TunnelModel, flow: TunnelFlow, density: float) -> Found:
    """Solve a flow, after its mesh if needed, and return the result; density in kg/m3."""
    facts = solve_mesh(stages, flow.mesh)
    if flow.kind != 'coarse':  # a coarse mesh may lose thin bodies: it only shows the mesh error
        reduce.check_bodies(flow.mesh.name, facts.faces, flow.mesh.bodies)
    place = stages.solve(flow.case)
    # From the logs, so that a cached case keeps its original time
    spent = round(stages.processor_time(flow.case), 1) / max(len(flow.speeds), 1)
    solved = reduce.SolvedFlow(model, place, facts, spent, density)
    if flow.kind == 'blow':
        return reduce.summarize_rotors(solved, flow.shares or {})
    # A coarse mesh and its wind share the axis, so the case name labels the coarse one.
    points, refused = [], {}
    label = flow.case.name if flow.kind == 'coarse' else flow.about
    for speed in flow.speeds:
        step = next(each for each in flow.case.steps if each.name == f'{speed:g}')
        try:
            points.append(SUMMARIZERS[flow.kind](solved, flow.about, step, speed))
        except CaseFailed as error:  # one failed speed does not invalidate the others
            refused[f'{label} at {speed:g}'] = str(error)
    return points, refused


def split_failed_points(flow: TunnelFlow, result: Points | CaseFailed) -> Points:
    """Return the points of a flow and its failed ones, or the reason of a complete failure."""
    return ([], {flow.case.name: str(result)}) if isinstance(result, CaseFailed) else result


BYTES_A_CELL: Final = 4_000  # peak of snappyHexMesh, which needs more than the solvers
ANALYTIC_METHOD: Final = 'analytic estimate'
ESTIMATE_QUALITY: Final = FlowQuality(spread=0.0, window=0.0, cells=0, seconds=0.0)


def check_memory(flows: Sequence[TunnelFlow], jobs: int, limit: float) -> None:
    """Raise `BadInput` before any work if the meshes would exceed a limit [bytes]."""
    largest = max((flow.case.cells for flow in flows), default=0)
    # Worst case: all jobs mesh the largest case at once
    need = largest * BYTES_A_CELL * jobs
    if need > limit:
        raise BadInput(
            f'Meshes of up to {largest} cells, {jobs} at a time, need about '
            f'{need / 1e9:.1f} GB of memory, but only {limit / 1e9:.1f} GB are available; '
            'use --workers 1, a coarser fidelity, or more --memory.'
        )


def machine_memory() -> float:
    """Return the memory of this machine. [bytes]."""
    return float(os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES'))


def solve_sweep(
    solver: ThreadedFlowSolver,
    model: TunnelModel,
    flows: Sequence[TunnelFlow],
    air: Air,
    report: Callable[[str], None],
) -> tuple[dict[str, list[SweepPoint]], dict[str, Blow], dict[str, str], dict[str, SweepPoint]]:
    """Solve flows; return points by direction, patterns, refused flows and coarse meshes."""
    axes: dict[str, list[SweepPoint]] = {}
    blows: dict[str, Blow] = {}
    refused: dict[str, str] = {}
    coarse: dict[str, SweepPoint] = {}
    with closing(solver.solve_flows(model, flows, air[0])) as results:
        for flow, result in results:
            if isinstance(result, Blow):
                blows[flow.about] = result
                continue
            points, reasons = split_failed_points(flow, result)
            if flow.kind == 'coarse':
                for point in points:  # one, or none
                    coarse[flow.about] = point
            elif points:
                axes.setdefault(flow.about, []).extend(points)
            refused |= reasons
            for name, reason in reasons.items():
                report(f'{name}: {reason}')
    for each in axes.values():
        # Slow and fast points of an axis may come from different flows
        each.sort(key=lambda point: point.speed)
    return axes, blows, refused, coarse


def estimate_drag(model: TunnelModel, air: Air) -> dict[Axis, list[SweepPoint]]:
    """Return the estimate by hand for each axis."""
    estimates: dict[Axis, list[SweepPoint]] = {}
    for k, axis in enumerate(AXES):
        turning = k >= 3
        points = []
        for speed in TURN_RATES if turning else SPEEDS:
            wrench = [0.0] * 6
            value = (damping_moment if turning else drag_force)(model, k % 3, speed, air)
            wrench[k] = -float(f'{value:.5g}')
            points.append(
                SweepPoint(
                    speed=speed, force=wrench[:3], moment=wrench[3:], parts={}, viscous=0.0,
                    evidence=ESTIMATE_QUALITY,
                )
            )  # fmt: skip
        estimates[axis] = points
    return estimates


def build_sweep(
    model: TunnelModel, vehicle: str, fidelity: str, air: Air, axes: dict[str, list[SweepPoint]],
    blows: dict[str, Blow], refused: dict[str, str], coarse: dict[str, SweepPoint] | None = None,
    engine: str = ANALYTIC_METHOD,
) -> TunnelSweep:  # fmt: skip
    """Build a sweep from the results of `solve_sweep` and the solver's name."""
    return TunnelSweep.model_validate({
        'schema_version': 1,
        'name': model.name,
        'vehicle': vehicle,
        'fidelity': fidelity,
        'engine': engine,
        'geometry': model.fingerprint,
        'length': round(model.length, 5),
        'frontal': [round(model.frontal_area(k), 5) for k in range(3)],
        'density': air[0],
        'viscosity': air[1],
        'symmetries': [each.tolist() for each in model.find_symmetries()],
        'rotors': {
            name: RotorPlacement(place=list(each.place), axis=list(each.axis), thrust=each.thrust)
            for name, each in model.rotors.items()
        },
        'axes': {name: points for name, points in axes.items() if name not in INCIDENCES},
        'by_hand': estimate_drag(model, air),
        'blows': blows,
        'coarse': coarse or {},
        'inclined': {name: points[0] for name, points in axes.items() if name in INCIDENCES},
        'refused': refused,
    })  # fmt: skip

"""
Solve flows in parallel threads, each running a program on one core.

On two cores this is faster than one flow on both, and a failing flow does not affect the others.
"""

from collections.abc import Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Final, final

from lta_windtunnel import flow_checks, reduce
from lta_windtunnel.flow_plan import TunnelFlow
from lta_windtunnel.openfoam.case import CaseRunner, FoamCase, Progress
from lta_windtunnel.openfoam.output_reader import MeshFacts, read_mesh
from lta_windtunnel.openfoam.programs import CaseFailed, find_openfoam_version, FoamPrograms
from lta_windtunnel.sweep_table import Blow, SweepPoint
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
        self._programs = FoamPrograms()
        self._stages = CaseRunner(folder, self._programs, tell, retry_failed)
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
                self._programs.stop()
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
    flow_checks.check_mesh(mesh.name, facts)
    return facts


def solve_flow(stages: CaseRunner, model: TunnelModel, flow: TunnelFlow, density: float) -> Found:
    """Solve a flow, after its mesh if needed, and return the result; density in kg/m3."""
    facts = solve_mesh(stages, flow.mesh)
    if flow.kind != 'coarse':  # a coarse mesh may lose thin bodies: it only shows the mesh error
        flow_checks.check_bodies(flow.mesh.name, facts.faces, flow.mesh.bodies)
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

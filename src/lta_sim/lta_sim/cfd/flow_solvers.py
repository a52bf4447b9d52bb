"""
Who solves flows: threads of this machine, each with a program on one core.

On two cores that is faster than one flow on both, and a flow that dies takes nobody along.
"""

from collections.abc import Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Final, final, Protocol

from lta_sim.cfd import flow_checks, reduce
from lta_sim.cfd.flow_plan import TunnelFlow
from lta_sim.cfd.openfoam.case import FoamCase
from lta_sim.cfd.openfoam.case_runner import CaseRunner, Progress
from lta_sim.cfd.openfoam.engine import CaseFailed, find_version, FoamPrograms
from lta_sim.cfd.openfoam.mesh import list_solved_bodies
from lta_sim.cfd.openfoam.output_reader import read_mesh, read_patches
from lta_sim.cfd.sweep_table import Blow, SweepPoint
from lta_sim.cfd.tunnel_model import TunnelModel

READ: Final = {
    'wind': reduce.reduce_wind,
    'coarse': reduce.reduce_wind,
    'transient': reduce.reduce_transient,
    'spin': reduce.reduce_spin,
}
Points = tuple[list[SweepPoint], dict[str, str]]  # what was refused, too
Found = Points | Blow


class FlowSolver(Protocol):
    """Whoever solves flows, here or elsewhere."""

    def engine_name(self) -> str:
        """Return what they are solved with."""
        ...

    def solve_flows(
        self, model: TunnelModel, flows: Sequence[TunnelFlow], density: float
    ) -> Generator[tuple[TunnelFlow, Found | CaseFailed]]:
        """Yield each flow with its outcome, and stop when closed; parameters as `solve_flow`."""
        ...


@final
class ThreadedFlowSolver:
    """
    Solves flows on this machine.

    Parameters
    ----------
    folder : Path
        Where solved cases are kept.
    jobs : int
        How many at a time.
    tell : callable
        Told how far which case is.

    """

    def __init__(self, folder: Path, jobs: int, tell: Progress) -> None:
        self._programs = FoamPrograms()
        self._stages = CaseRunner(folder, self._programs, tell)
        self._jobs = jobs

    def engine_name(self) -> str:
        """Return what they are solved with."""
        return find_version()

    def solve_flows(
        self, model: TunnelModel, flows: Sequence[TunnelFlow], density: float
    ) -> Generator[tuple[TunnelFlow, Found | CaseFailed]]:
        """Yield each flow with what came of it; parameters as `solve_flow`."""
        with ThreadPoolExecutor(self._jobs) as pool:
            try:
                meshes = {
                    mesh.key: pool.submit(solve_mesh, self._stages, mesh)
                    for mesh in list_meshes(flows)
                }
                coming = [
                    (
                        flow,
                        pool.submit(
                            self._solve_after_mesh,
                            meshes[flow_mesh(flow).key],
                            model,
                            flow,
                            density,
                        ),
                    )
                    for flow in flows
                ]
                for flow, future in coming:
                    try:
                        yield flow, future.result()
                    except CaseFailed as error:
                        yield flow, error
            except BaseException:
                self._programs.stop()
                pool.shutdown(wait=False, cancel_futures=True)
                raise

    def _solve_after_mesh(
        self, mesh: Future[Path], model: TunnelModel, flow: TunnelFlow, density: float
    ) -> Found:
        mesh.result()  # or why there is none
        return solve_flow(self._stages, model, flow, density)


def flow_mesh(flow: TunnelFlow) -> FoamCase:
    """Return the case that makes the mesh of a flow."""
    assert flow.case.mesh is not None
    return flow.case.mesh


def list_meshes(flows: Sequence[TunnelFlow]) -> list[FoamCase]:
    """Return the meshes of some flows, each once."""
    return list({flow_mesh(flow).key: flow_mesh(flow) for flow in flows}.values())


def solve_mesh(stages: CaseRunner, mesh: FoamCase) -> Path:
    """Return the folder of a mesh that is made, or `CaseFailed` where it is none."""
    place = stages.solve(mesh)
    flow_checks.check_mesh(mesh.name, read_mesh(place))
    return place


def solve_flow(stages: CaseRunner, model: TunnelModel, flow: TunnelFlow, density: float) -> Found:
    """
    Return what a flow gives, its mesh made first where it is not there.

    Parameters
    ----------
    stages : Stages
        Where cases are solved.
    model : Model
        What stands in the tunnel.
    flow : Flow
        What is solved.
    density : float
        Of the air. [kg/m3]

    """
    mesh = solve_mesh(stages, flow_mesh(flow))
    if flow.kind != 'coarse':  # which is to tell what the mesh decides
        patches = read_patches(mesh)
        flow_checks.check_bodies(
            flow_mesh(flow).name, patches, list_solved_bodies(flow_mesh(flow), patches)
        )
    place = stages.solve(flow.case)
    spent = round(stages.processor_time(flow.case), 1)
    if flow.kind == 'blow':
        return reduce.reduce_blow(model, flow.shares or {}, place, mesh, spent, density)
    read = READ[flow.kind]
    points, refused = [], {}
    label = flow.case.name if flow.kind == 'coarse' else flow.about
    for speed in flow.speeds:
        step = next(each for each in flow.case.steps if each.name == f'{speed:g}')
        try:
            each = spent / len(flow.speeds)
            points.append(read(model, flow.about, step, speed, place, mesh, each, density))
        except CaseFailed as error:  # of one speed; the others stand
            refused[f'{label} at {speed:g}'] = str(error)
    return points, refused


def split_result(flow: TunnelFlow, result: Points | CaseFailed) -> Points:
    """Return the points of a flow and what was refused of it, or all of it and why."""
    return ([], {flow.case.name: str(result)}) if isinstance(result, CaseFailed) else result

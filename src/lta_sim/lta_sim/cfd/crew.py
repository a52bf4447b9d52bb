"""
Who solves flows: threads of this machine, each with a program on one core.

On two cores that is faster than one flow on both, and a flow that dies takes nobody along.
"""

from collections.abc import Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Final, final, Protocol

from lta_sim.cfd import gates, reduce
from lta_sim.cfd.model import Model
from lta_sim.cfd.openfoam.case import Case
from lta_sim.cfd.openfoam.engine import CaseFailed, Programs, version
from lta_sim.cfd.openfoam.forces import read_mesh, read_patches
from lta_sim.cfd.openfoam.mesh import standing
from lta_sim.cfd.openfoam.stage import Progress, Stages
from lta_sim.cfd.plan import Flow
from lta_sim.cfd.sweep_table import Blow, Point

READ: Final = {
    'wind': reduce.wind_point,
    'coarse': reduce.wind_point,
    'transient': reduce.transient_point,
    'spin': reduce.spin_point,
}
Points = tuple[list[Point], dict[str, str]]  # what was refused, too
Found = Points | Blow


class Crew(Protocol):
    """Whoever solves flows, here or elsewhere."""

    def engine(self) -> str:
        """Return what they are solved with."""
        ...

    def solved(
        self, model: Model, flows: Sequence[Flow], density: float
    ) -> Generator[tuple[Flow, Found | CaseFailed]]:
        """Yield each flow with what came of it, and stop when closed; parameters as `found_of`."""
        ...


@final
class Threads:
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
        self._programs = Programs()
        self._stages = Stages(folder, self._programs, tell)
        self._jobs = jobs

    def engine(self) -> str:
        """Return what they are solved with."""
        return version()

    def solved(
        self, model: Model, flows: Sequence[Flow], density: float
    ) -> Generator[tuple[Flow, Found | CaseFailed]]:
        """Yield each flow with what came of it; parameters as `found_of`."""
        with ThreadPoolExecutor(self._jobs) as pool:
            try:
                meshes = {
                    mesh.key: pool.submit(meshed, self._stages, mesh) for mesh in meshes_of(flows)
                }
                coming = [
                    (
                        flow,
                        pool.submit(self._after, meshes[mesh_of(flow).key], model, flow, density),
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

    def _after(self, mesh: Future[Path], model: Model, flow: Flow, density: float) -> Found:
        mesh.result()  # or why there is none
        return found_of(self._stages, model, flow, density)


def mesh_of(flow: Flow) -> Case:
    """Return the case that makes the mesh of a flow."""
    assert flow.case.mesh is not None
    return flow.case.mesh


def meshes_of(flows: Sequence[Flow]) -> list[Case]:
    """Return the meshes of some flows, each once."""
    return list({mesh_of(flow).key: mesh_of(flow) for flow in flows}.values())


def meshed(stages: Stages, mesh: Case) -> Path:
    """Return the folder of a mesh that is made, or `CaseFailed` where it is none."""
    place = stages.solve(mesh)
    gates.check_mesh(mesh.name, read_mesh(place))
    return place


def found_of(stages: Stages, model: Model, flow: Flow, density: float) -> Found:
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
    mesh = meshed(stages, mesh_of(flow))
    if flow.kind != 'coarse':  # which is to tell what the mesh decides
        patches = read_patches(mesh)
        gates.check_bodies(mesh_of(flow).name, patches, standing(mesh_of(flow), patches))
    place = stages.solve(flow.case)
    spent = round(stages.seconds(flow.case), 1)
    if flow.kind == 'blow':
        return reduce.blow(model, flow.shares or {}, place, mesh, spent, density)
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


def points_or_why(flow: Flow, found: Points | CaseFailed) -> Points:
    """Return the points of a flow and what was refused of it, or all of it and why."""
    return ([], {flow.case.name: str(found)}) if isinstance(found, CaseFailed) else found

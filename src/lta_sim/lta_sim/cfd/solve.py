"""
A whole sweep: its flows solved side by side, what fails named and left out, the rest kept.

Flows are independent programs on one core each: on two cores that is faster than one flow on
both, and a flow that dies takes nobody along.
"""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
import os
from pathlib import Path
from typing import Final

from lta_config.errors import BadInput
from lta_sim.cfd import gates, reduce
from lta_sim.cfd.analytic import damping, drag
from lta_sim.cfd.case import Case
from lta_sim.cfd.engine import CaseFailed, Programs, version
from lta_sim.cfd.forces import read_mesh
from lta_sim.cfd.model import Model
from lta_sim.cfd.plan import Air, Flow
from lta_sim.cfd.stage import Progress, Stages
from lta_sim.cfd.still import RATES
from lta_sim.cfd.sweep_table import AXES, Axis, Blow, Evidence, Place, Point, Sweep
from lta_sim.cfd.tunnel import SPEEDS

BYTES_A_CELL: Final = 4_000  # of snappyHexMesh, which takes more than the solvers
READ: Final = {
    'wind': reduce.wind_point,
    'transient': reduce.transient_point,
    'spin': reduce.spin_point,
}
HAND: Final = Evidence(spread=0.0, window=0.0, cells=0, seconds=0.0)
Found = tuple[list[Point], dict[str, str]] | Blow  # what was refused, too


def check_memory(flows: Sequence[Flow], jobs: int, limit: float) -> None:
    """Refuse, before any work, meshes that would not fit. [bytes]."""
    largest = max((flow.case.cells for flow in flows), default=0)
    need = largest * BYTES_A_CELL * jobs
    if need > limit:
        raise BadInput(
            f'A mesh of {largest} cells, {jobs} at a time, needs about {need / 1e9:.1f} GB and '
            f'there are {limit / 1e9:.1f}; use --jobs 1, a coarser fidelity, or more --memory.'
        )


def memory() -> float:
    """Return the memory of this machine. [bytes]."""
    return float(os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES'))


def solve(
    model: Model, flows: Sequence[Flow], air: Air, folder: Path, jobs: int, tell: Progress,
    said: Callable[[str], None],
) -> tuple[dict[str, list[Point]], dict[str, Blow], dict[str, str]]:  # fmt: skip
    """
    Solve flows and return the points of each axis, the patterns, and what was refused and why.

    Parameters
    ----------
    model : Model
        What stands in the tunnel.
    flows : sequence of Flow
        What is solved.
    air : (float, float)
        Density [kg/m3] and kinematic viscosity [m2/s].
    folder : Path
        Where solved cases are kept.
    jobs : int
        How many at a time.
    tell : callable
        Told how far which case is.
    said : callable
        Given a sentence on each flow that is refused.

    """
    programs = Programs()
    stages = Stages(folder, programs, tell)
    axes: dict[str, list[Point]] = {}
    blows: dict[str, Blow] = {}
    refused: dict[str, str] = {}
    with ThreadPoolExecutor(jobs) as pool:
        try:
            for flow, future in _begun(pool, stages, model, flows, air):
                try:
                    found = future.result()
                except CaseFailed as error:
                    refused[flow.case.name] = str(error)
                    said(f'{flow.case.name}: {error}')
                    continue
                if isinstance(found, Blow):
                    blows[flow.about] = found
                    continue
                if found[0]:
                    axes.setdefault(flow.about, []).extend(found[0])
                refused |= found[1]
                for name, reason in found[1].items():
                    said(f'{name}: {reason}')
        except BaseException:
            programs.stop()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    for points in axes.values():
        points.sort(key=lambda point: point.speed)
    return axes, blows, refused


def _begun(
    pool: ThreadPoolExecutor, stages: Stages, model: Model, flows: Sequence[Flow], air: Air
) -> Iterator[tuple[Flow, Future[Found]]]:
    """Begin everything, meshes first, and yield each flow with what will come of it."""
    meshes: dict[str, Future[Path]] = {}
    for flow in flows:
        mesh = flow.case.mesh
        if mesh is not None and mesh.key not in meshes:
            meshes[mesh.key] = pool.submit(_meshed, stages, mesh)
    coming = []
    for flow in flows:
        assert flow.case.mesh is not None
        mesh_place = meshes[flow.case.mesh.key]
        coming.append((flow, pool.submit(_solved, stages, model, flow, mesh_place, air[0])))
    yield from coming


def _meshed(stages: Stages, mesh: Case) -> Path:
    place = stages.solve(mesh)
    gates.check_mesh(mesh.name, read_mesh(place))
    return place


def _solved(
    stages: Stages, model: Model, flow: Flow, coming: Future[Path], density: float
) -> Found:
    mesh = coming.result()
    place = stages.solve(flow.case)
    spent = round(stages.seconds(flow.case), 1)
    if flow.kind == 'blow':
        return reduce.blow(model, flow.shares or {}, place, mesh, spent, density)
    read = READ[flow.kind]
    points, refused = [], {}
    for speed in flow.speeds:
        step = next(each for each in flow.case.steps if each.name == f'{speed:g}')
        try:
            each = spent / len(flow.speeds)
            points.append(read(model, flow.about, step, speed, place, mesh, each, density))
        except CaseFailed as error:  # of one speed; the others stand
            refused[f'{flow.about} at {speed:g}'] = str(error)
    return points, refused


def by_hand(model: Model, air: Air) -> dict[Axis, list[Point]]:
    """Return what is known by hand of each axis."""
    found: dict[Axis, list[Point]] = {}
    for k, axis in enumerate(AXES):
        turning = k >= 3
        points = []
        for speed in RATES if turning else SPEEDS:
            wrench = [0.0] * 6
            value = (damping if turning else drag)(model, k % 3, speed, air)
            wrench[k] = -float(f'{value:.5g}')
            points.append(
                Point(
                    speed=speed, force=wrench[:3], moment=wrench[3:], parts={}, viscous=0.0,
                    evidence=HAND,
                )
            )  # fmt: skip
        found[axis] = points
    return found


def sweep_of(
    model: Model, vehicle: str, fidelity: str, air: Air, axes: dict[str, list[Point]],
    blows: dict[str, Blow], refused: dict[str, str],
) -> Sweep:  # fmt: skip
    """Return a whole sweep; parameters as `solve` gave them."""
    return Sweep.model_validate({
        'schema_version': 1,
        'name': model.name,
        'vehicle': vehicle,
        'fidelity': fidelity,
        'engine': 'by hand' if fidelity == 'analytic' else version(),
        'geometry': model.fingerprint,
        'length': round(model.length, 5),
        'volume': round(float(model.hull.volume), 6),
        'frontal': [round(model.frontal(k), 5) for k in range(3)],
        'density': air[0],
        'viscosity': air[1],
        'symmetries': [each.tolist() for each in model.symmetries()],
        'rotors': {
            name: Place(place=list(each.place), axis=list(each.axis), thrust=each.thrust)
            for name, each in model.rotors.items()
        },
        'axes': axes,
        'by_hand': by_hand(model, air),
        'blows': blows,
        'refused': refused,
    })  # fmt: skip

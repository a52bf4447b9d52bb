"""Solve a whole sweep in parallel; failed flows are reported and left out."""

from collections.abc import Callable, Sequence
from contextlib import closing
import os
from typing import Final

from lta_config.errors import BadInput
from lta_windtunnel.analytic import damping_moment, drag_force
from lta_windtunnel.flow_plan import Air, TunnelFlow
from lta_windtunnel.flow_solvers import split_failed_points, ThreadedFlowSolver
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

BYTES_A_CELL: Final = 4_000  # peak of snappyHexMesh, which needs more than the solvers
ANALYTIC_METHOD: Final = 'analytic estimate'
ESTIMATE_QUALITY: Final = FlowQuality(spread=0.0, window=0.0, cells=0, seconds=0.0)


def check_memory(flows: Sequence[TunnelFlow], jobs: int, limit: float) -> None:
    """Raise `BadInput` before any work if the meshes would exceed a limit. [bytes]"""
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
        'volume': round(float(model.hull.volume), 6),
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

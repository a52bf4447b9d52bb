"""Reduce solved cases to mean forces and moments, in body axes and SI units."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from lta_windtunnel import flow_checks
from lta_windtunnel.openfoam.case import ProgramStep
from lta_windtunnel.openfoam.engine import RESIDUAL
from lta_windtunnel.openfoam.output_reader import (
    read_forces,
    read_mesh,
    read_momentum,
    WrenchHistory,
)
from lta_windtunnel.still_air import AXES
from lta_windtunnel.surface import read_surface_pressure
from lta_windtunnel.sweep_table import Blow, FlowQuality, SweepPoint
from lta_windtunnel.tunnel import has_symmetry_planes, OUTER, rotate_into_tunnel, SETTLING
from lta_windtunnel.tunnel_model import TunnelModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Hull lengths of flow before a transient is averaged: 4 until the first inflow has passed the
# hull, and 2 for its wake.
STARTING: Final = 6.0
BATCH: Final = 5.0  # lengths of flow, about one swing of a wake


def _averaging_window(wrench: WrenchHistory) -> slice:
    return slice(max(len(wrench.time) - flow_checks.WINDOW, 0), None)


def _mean_outflow(place: Path, begin: str, patches: Sequence[str]) -> Array:
    """Return the mean momentum and pressure flux out of the domain, at 1 kg/m3."""
    outer = read_forces(place, 'outer', begin)
    rows = [
        read_momentum(place, patch, begin)[-flow_checks.WINDOW :].mean(axis=0) for patch in patches
    ]
    total: Array = outer.force[_averaging_window(outer)].mean(axis=0) + np.sum(rows, axis=0)
    return total


def _read_residual(place: Path, step: str) -> float | None:
    text = (place / f'log.{step}').read_text(encoding='utf-8', errors='replace')
    # The end of a log of many megabytes
    residuals = RESIDUAL.findall(text[-8000:])
    return float(residuals[-1]) if residuals else None


def _count_cells(mesh: Path) -> int:
    cells = read_mesh(mesh)['cells']
    assert isinstance(cells, float)
    return int(cells)


def _unfold_symmetry(
    force: Array, moment: Array, planes: tuple[bool, bool]
) -> tuple[Array, Array]:
    """Return the wrench on the whole body from that on the solved half or quarter."""
    force, moment = force.copy(), moment.copy()
    for axis, is_one in zip((1, 2), planes, strict=True):
        if is_one:  # antisymmetric components cancel, the others double
            force *= 2.0
            moment *= 2.0
            force[..., axis] = 0.0
            # A plane of symmetry allows only the moment about its normal
            moment[..., [k for k in range(3) if k != axis]] = 0.0
    return force, moment


def summarize_steady_wind(
    model: TunnelModel, axis: str, step: ProgramStep, speed: float, place: Path, mesh: Path,
    seconds: float, density: float,
) -> SweepPoint:  # fmt: skip
    """
    Return the result of one speed [m/s] of a steady wind tunnel.

    `place` and `mesh` are the folders of the case and of its mesh, `seconds` is its processor time
    and `density` that of the air. [kg/m3]

    Raises
    ------
    CaseFailed
        If a check of the flow fails.

    """
    planes = has_symmetry_planes(model, axis)
    wrenches = {name: read_forces(place, name, step.begin) for name in model.bodies}
    drags = np.sum([each.force[_averaging_window(each), 0] for each in wrenches.values()], axis=0)
    spread = float(np.std(drags) / abs(np.mean(drags)))
    flow_checks.check_spread(spread, len(drags))
    flow_checks.check_brakes(float(np.mean(drags)))
    # Momentum balance: drag on the bodies plus momentum leaving the domain must cancel.
    lost = _mean_outflow(place, step.begin, OUTER)[0] + np.mean(drags)
    balance = float(abs(lost) / abs(np.mean(drags)))
    flow_checks.check_balance(balance)
    # The flow was solved at 1 m/s and 1 kg/m3; forces grow with rho U^2.
    scale = density * speed**2
    force, moment = _mean_body_wrench(axis, planes, wrenches, scale)
    return SweepPoint(
        speed=speed,
        force=_to_list(force),
        moment=_to_list(moment),
        parts=_drag_by_body(wrenches, scale * 2 ** sum(planes)),
        viscous=_viscous_share(wrenches),
        evidence=FlowQuality(
            spread=_round_to_five_digits(spread), window=float(len(drags)),
            balance=_round_to_five_digits(balance),
            residual=_read_residual(place, step.name), cells=_count_cells(mesh), seconds=seconds,
        ),
    )  # fmt: skip


def summarize_transient_wind(
    model: TunnelModel, axis: str, step: ProgramStep, speed: float, place: Path, mesh: Path,
    seconds: float, density: float,
) -> SweepPoint:  # fmt: skip
    """
    Return the result of a transient wind tunnel; its spread is the standard error of the mean.

    Arguments as for `summarize_steady_wind`.
    """
    wrenches = {name: read_forces(place, name, step.begin) for name in model.bodies}
    first = next(iter(wrenches.values()))
    # Skip the start: the wake needs time to develop.
    late = first.time >= SETTLING + STARTING * model.length
    drags = np.sum([each.force[late, 0] for each in wrenches.values()], axis=0)
    # Time steps vary: weight each value with its duration
    weights = np.gradient(first.time[late])
    error = standard_error(drags, weights, BATCH * model.length)
    flow_checks.check_mean(error, float(weights.sum()) / model.length)
    flow_checks.check_brakes(float(np.average(drags, weights=weights)))
    cut = {
        name: WrenchHistory(
            each.time[late], each.force[late], each.moment[late], each.viscous[late]
        )
        for name, each in wrenches.items()
    }
    scale = density * speed**2
    force, moment = _mean_body_wrench(axis, (False, False), cut, scale, weights)
    return SweepPoint(
        speed=speed,
        force=_to_list(force),
        moment=_to_list(moment),
        parts=_drag_by_body(cut, scale, weights),
        viscous=_viscous_share(cut, weights),
        evidence=FlowQuality(
            spread=_round_to_five_digits(error),
            window=_round_to_five_digits(float(weights.sum())),
            residual=_read_residual(place, step.name), cells=_count_cells(mesh), seconds=seconds,
        ),
    )  # fmt: skip


def standard_error(values: Array, weights: Array, batch: float) -> float:
    """
    Return the standard error of the mean of a history, relative to its mean. [1]

    Uses overlapping batch means (Meketon and Schmeiser 1984), because neighbouring values are
    correlated.

    `values`, `weights`: values and their durations [s]. `batch`: correlation length; for a shorter
    history the error is infinite [s].
    """
    # Integrals by interpolation, because batches need not end at a time step
    ends = np.concatenate(([0.0], np.cumsum(weights)))
    sums = np.concatenate(([0.0], np.cumsum(values * weights)))
    whole = ends[-1]
    # Fewer than one independent batch: the error is unknown.
    if whole <= batch:
        return float('inf')
    begins = np.linspace(0.0, whole - batch, len(values))
    means = (np.interp(begins + batch, ends, sums) - np.interp(begins, ends, sums)) / batch
    mean = sums[-1] / whole
    variance = batch / (whole - batch) * np.mean((means - mean) ** 2)
    return float(np.sqrt(variance) / abs(mean))


def _mean_body_wrench(
    axis: str,
    planes: tuple[bool, bool],
    wrenches: Mapping[str, WrenchHistory],
    scale: float,
    weights: Array | None = None,
) -> tuple[Array, Array]:
    """Return mean force and moment in body axes."""
    force, moment = np.zeros(3), np.zeros(3)
    for each in wrenches.values():
        rows = _averaging_window(each) if weights is None else slice(None)
        force += np.average(each.force[rows], axis=0, weights=weights)
        moment += np.average(each.moment[rows], axis=0, weights=weights)
    force, moment = _unfold_symmetry(force, moment, planes)
    # Transposed: from tunnel axes back to body axes.
    # A rotation matrix: its transpose is its inverse
    turn = rotate_into_tunnel(axis).T
    return scale * (turn @ force), scale * (turn @ moment)


def _drag_by_body(
    wrenches: Mapping[str, WrenchHistory], scale: float, weights: Array | None = None
) -> dict[str, float]:
    return {
        name: _round_to_five_digits(scale * _average_window(each, each.force[:, 0], weights))
        for name, each in wrenches.items()
    }


def _viscous_share(wrenches: Mapping[str, WrenchHistory], weights: Array | None = None) -> float:
    friction = sum(
        _average_window(each, each.viscous[:, 0], weights) for each in wrenches.values()
    )
    drag = sum(_average_window(each, each.force[:, 0], weights) for each in wrenches.values())
    return _round_to_five_digits(friction / drag)


def _average_window(wrench: WrenchHistory, values: Array, weights: Array | None) -> float:
    """Return the mean over the window of a steady flow, or over all of a transient."""
    if weights is None:
        return float(np.mean(values[_averaging_window(wrench)]))
    return float(np.average(values, weights=weights))


def summarize_rotation_flow(
    model: TunnelModel, about: str, step: ProgramStep, rate: float, place: Path, mesh: Path,
    seconds: float, density: float,
) -> SweepPoint:  # fmt: skip
    """Return the result of one rate of rotation; arguments as for `summarize_steady_wind`."""
    axis = np.array(AXES[about])
    wrenches = {name: read_forces(place, name, step.begin) for name in model.bodies}
    rows = {name: each.moment[_averaging_window(each)] @ axis for name, each in wrenches.items()}
    total = np.sum(list(rows.values()), axis=0)
    spread = float(np.std(total) / abs(np.mean(total)))
    flow_checks.check_spread(spread, len(total))
    # The moment must oppose the positive rotation
    flow_checks.check_brakes(-float(np.mean(total)))
    scale = density * rate**2
    force = sum(
        (e.force[_averaging_window(e)].mean(axis=0) for e in wrenches.values()), np.zeros(3)
    )
    moment = sum(
        (e.moment[_averaging_window(e)].mean(axis=0) for e in wrenches.values()), np.zeros(3)
    )
    return SweepPoint(
        speed=rate,
        force=_to_list(scale * force),
        moment=_to_list(scale * moment),
        parts={
            name: _round_to_five_digits(-scale * float(np.mean(each)))
            for name, each in rows.items()
        },
        viscous=0.0,
        evidence=FlowQuality(
            spread=_round_to_five_digits(spread), window=float(len(total)),
            residual=_read_residual(place, step.name), cells=_count_cells(mesh), seconds=seconds,
        ),
    )  # fmt: skip


def summarize_rotor_flow(
    model: TunnelModel, shares: Mapping[str, float], place: Path, mesh: Path, seconds: float,
    density: float,
) -> Blow:  # fmt: skip
    """Return the net wrench of running rotors; arguments as for `summarize_steady_wind`."""
    zones = read_mesh(mesh)['zones']
    assert isinstance(zones, dict)
    flow_checks.check_zones(zones, shares)
    thrust, torque, loudness = np.zeros(3), np.zeros(3), 0.0
    for name, share in shares.items():
        rotor = model.rotors[name]
        push = share * rotor.thrust * np.array(rotor.axis)
        thrust += push
        # The disks are momentum sources, so their thrust is not in the wall forces.
        torque += np.cross(rotor.place, push)
        loudness += abs(share) * rotor.thrust
    wrenches = {name: read_forces(place, name, '0') for name in model.bodies}
    walls = (
        np.sum([each.force[_averaging_window(each)] for each in wrenches.values()], axis=0)
        * density
    )
    turned = (
        np.sum([each.moment[_averaging_window(each)] for each in wrenches.values()], axis=0)
        * density
    )
    spread = float(np.linalg.norm(np.std(walls, axis=0)) / loudness)
    flow_checks.check_spread(spread, len(walls))
    # Momentum balance of the box: outflow, forces on the walls, and the thrust
    lost = density * _mean_outflow(place, '0', ('far',)) + walls.mean(axis=0) + thrust
    balance = float(np.linalg.norm(lost) / loudness)
    flow_checks.check_balance(balance)
    return Blow(
        shares=dict(shares),
        force=_to_list(thrust + walls.mean(axis=0)),
        moment=_to_list(torque + turned.mean(axis=0)),
        zones={name: zones[name] for name in shares},
        evidence=FlowQuality(
            spread=_round_to_five_digits(spread), window=float(len(walls)),
            balance=_round_to_five_digits(balance),
            residual=_read_residual(place, 'on'), cells=_count_cells(mesh), seconds=seconds,
        ),
        pressed={name: read_surface_pressure(place, name, density) for name in model.bodies},
    )  # fmt: skip


def _round_to_five_digits(number: float) -> float:
    return float(f'{number:.5g}')


def _to_list(vector: Array) -> list[float]:
    return [_round_to_five_digits(float(each)) for each in vector]

"""Solved cases to numbers: averages over the last rounds, turned into body axes and SI."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from lta_sim.cfd import gates
from lta_sim.cfd.model import Model
from lta_sim.cfd.openfoam.case import Step
from lta_sim.cfd.openfoam.engine import RESIDUAL
from lta_sim.cfd.openfoam.forces import read_forces, read_mesh, read_momentum, Wrenches
from lta_sim.cfd.still import AXES
from lta_sim.cfd.surface import read_surface
from lta_sim.cfd.sweep_table import Blow, Evidence, Point
from lta_sim.cfd.tunnel import OUTER, planes_of, SETTLING, TURNS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Lengths of flow before a transient is averaged: 4 until what came in first is past the hull, and
# 2 for its wake.
STARTING: Final = 6.0
BATCH: Final = 5.0  # lengths of flow, about one swing of a wake


def _ending(wrench: Wrenches) -> slice:
    return slice(max(len(wrench.time) - gates.WINDOW, 0), None)


def _kept(place: Path, begin: str, patches: Sequence[str]) -> Array:
    """Return what the air takes along, mean of the window, at 1 kg/m3: momentum and pressure."""
    outer = read_forces(place, 'outer', begin)
    rows = [read_momentum(place, patch, begin)[-gates.WINDOW :].mean(axis=0) for patch in patches]
    total: Array = outer.force[_ending(outer)].mean(axis=0) + np.sum(rows, axis=0)
    return total


def _residual(place: Path, step: str) -> float | None:
    text = (place / f'log.{step}').read_text(encoding='utf-8', errors='replace')
    found = RESIDUAL.findall(text[-8000:])
    return float(found[-1]) if found else None


def _cells(mesh: Path) -> int:
    cells = read_mesh(mesh)['cells']
    assert isinstance(cells, float)
    return int(cells)


def _whole(force: Array, moment: Array, planes: tuple[bool, bool]) -> tuple[Array, Array]:
    """Return the wrench on the whole body from that on the half or quarter that was solved."""
    force, moment = force.copy(), moment.copy()
    for axis, is_one in zip((1, 2), planes, strict=True):
        if is_one:  # what mirrors against itself is gone, the rest is twice
            force *= 2.0
            moment *= 2.0
            force[..., axis] = 0.0
            moment[..., [k for k in range(3) if k != axis]] = 0.0
    return force, moment


def wind_point(
    model: Model, axis: str, step: Step, speed: float, place: Path, mesh: Path, seconds: float,
    density: float,
) -> Point:  # fmt: skip
    """
    Return one speed of a steady wind tunnel.

    Parameters
    ----------
    model : Model
        What stood in it.
    axis : str
        How it moves.
    step : Step
        That solved this speed.
    speed : float
        Which. [m/s]
    place, mesh : Path
        Folders of the case and of its mesh.
    seconds : float
        That the case took. [s]
    density : float
        Of the air. [kg/m3]

    Raises
    ------
    CaseFailed
        If a gate does not hold.

    """
    planes = planes_of(model, axis)
    wrenches = {name: read_forces(place, name, step.begin) for name in model.bodies}
    drags = np.sum([each.force[_ending(each), 0] for each in wrenches.values()], axis=0)
    spread = float(np.std(drags) / abs(np.mean(drags)))
    gates.check_spread(spread, len(drags))
    gates.check_brakes(float(np.mean(drags)))
    lost = _kept(place, step.begin, OUTER)[0] + np.mean(drags)
    balance = float(abs(lost) / abs(np.mean(drags)))
    gates.check_balance(balance)
    scale = density * speed**2
    force, moment = _body(axis, planes, wrenches, scale)
    return Point(
        speed=speed,
        force=_listed(force),
        moment=_listed(moment),
        parts=_parts(wrenches, scale * 2 ** sum(planes)),
        viscous=_viscous(wrenches),
        evidence=Evidence(
            spread=_short(spread), window=float(len(drags)), balance=_short(balance),
            residual=_residual(place, step.name), cells=_cells(mesh), seconds=seconds,
        ),
    )  # fmt: skip


def transient_point(
    model: Model, axis: str, step: Step, speed: float, place: Path, mesh: Path, seconds: float,
    density: float,
) -> Point:  # fmt: skip
    """Return a transient wind tunnel, its spread the standard error; as `wind_point`."""
    wrenches = {name: read_forces(place, name, step.begin) for name in model.bodies}
    first = next(iter(wrenches.values()))
    late = first.time >= SETTLING + STARTING * model.length
    drags = np.sum([each.force[late, 0] for each in wrenches.values()], axis=0)
    weights = np.gradient(first.time[late])
    error = standard_error(drags, weights, BATCH * model.length)
    gates.check_mean(error, float(weights.sum()) / model.length)
    gates.check_brakes(float(np.average(drags, weights=weights)))
    cut = {
        name: Wrenches(each.time[late], each.force[late], each.moment[late], each.viscous[late])
        for name, each in wrenches.items()
    }
    scale = density * speed**2
    force, moment = _body(axis, (False, False), cut, scale, weights)
    return Point(
        speed=speed,
        force=_listed(force),
        moment=_listed(moment),
        parts=_parts(cut, scale, weights),
        viscous=_viscous(cut, weights),
        evidence=Evidence(
            spread=_short(error), window=_short(float(weights.sum())),
            residual=_residual(place, step.name), cells=_cells(mesh), seconds=seconds,
        ),
    )  # fmt: skip


def standard_error(values: Array, weights: Array, batch: float) -> float:
    """
    Return the standard error of the mean of a history over its mean. [1].

    By the means of overlapping batches (Meketon and Schmeiser 1984), since neighbours are alike.

    Parameters
    ----------
    values, weights : array (n,)
        A value and how long it held. [s]
    batch : float
        Beyond which values are independent; nothing is known of a shorter history. [s]

    """
    ends = np.concatenate(([0.0], np.cumsum(weights)))
    sums = np.concatenate(([0.0], np.cumsum(values * weights)))
    whole = ends[-1]
    if whole <= batch:
        return float('inf')
    begins = np.linspace(0.0, whole - batch, len(values))
    means = (np.interp(begins + batch, ends, sums) - np.interp(begins, ends, sums)) / batch
    mean = sums[-1] / whole
    variance = batch / (whole - batch) * np.mean((means - mean) ** 2)
    return float(np.sqrt(variance) / abs(mean))


def _body(
    axis: str,
    planes: tuple[bool, bool],
    wrenches: Mapping[str, Wrenches],
    scale: float,
    weights: Array | None = None,
) -> tuple[Array, Array]:
    """Return mean force and moment in body axes."""
    force, moment = np.zeros(3), np.zeros(3)
    for each in wrenches.values():
        rows = _ending(each) if weights is None else slice(None)
        force += np.average(each.force[rows], axis=0, weights=weights)
        moment += np.average(each.moment[rows], axis=0, weights=weights)
    force, moment = _whole(force, moment, planes)
    turn = TURNS[axis].T
    return scale * (turn @ force), scale * (turn @ moment)


def _parts(
    wrenches: Mapping[str, Wrenches], scale: float, weights: Array | None = None
) -> dict[str, float]:
    return {
        name: _short(scale * _mean(each, each.force[:, 0], weights))
        for name, each in wrenches.items()
    }


def _viscous(wrenches: Mapping[str, Wrenches], weights: Array | None = None) -> float:
    friction = sum(_mean(each, each.viscous[:, 0], weights) for each in wrenches.values())
    drag = sum(_mean(each, each.force[:, 0], weights) for each in wrenches.values())
    return _short(friction / drag)


def _mean(wrench: Wrenches, values: Array, weights: Array | None) -> float:
    """Return the mean of the window of a steady flow, or of all of a transient."""
    if weights is None:
        return float(np.mean(values[_ending(wrench)]))
    return float(np.average(values, weights=weights))


def spin_point(
    model: Model, about: str, step: Step, rate: float, place: Path, mesh: Path, seconds: float,
    density: float,
) -> Point:  # fmt: skip
    """Return one rate of a turning vehicle; as `wind_point`."""
    axis = np.array(AXES[about])
    wrenches = {name: read_forces(place, name, step.begin) for name in model.bodies}
    rows = {name: each.moment[_ending(each)] @ axis for name, each in wrenches.items()}
    total = np.sum(list(rows.values()), axis=0)
    spread = float(np.std(total) / abs(np.mean(total)))
    gates.check_spread(spread, len(total))
    gates.check_brakes(-float(np.mean(total)))
    scale = density * rate**2
    force = sum((e.force[_ending(e)].mean(axis=0) for e in wrenches.values()), np.zeros(3))
    moment = sum((e.moment[_ending(e)].mean(axis=0) for e in wrenches.values()), np.zeros(3))
    return Point(
        speed=rate,
        force=_listed(scale * force),
        moment=_listed(scale * moment),
        parts={name: _short(-scale * float(np.mean(each))) for name, each in rows.items()},
        viscous=0.0,
        evidence=Evidence(
            spread=_short(spread), window=float(len(total)),
            residual=_residual(place, step.name), cells=_cells(mesh), seconds=seconds,
        ),
    )  # fmt: skip


def blow(
    model: Model, shares: Mapping[str, float], place: Path, mesh: Path, seconds: float,
    density: float,
) -> Blow:  # fmt: skip
    """Return the net wrench of rotors that are on; as `wind_point`."""
    zones = read_mesh(mesh)['zones']
    assert isinstance(zones, dict)
    gates.check_zones(zones, shares)
    thrust, torque, loudness = np.zeros(3), np.zeros(3), 0.0
    for name, share in shares.items():
        rotor = model.rotors[name]
        push = share * rotor.thrust * np.array(rotor.axis)
        thrust += push
        torque += np.cross(rotor.place, push)
        loudness += abs(share) * rotor.thrust
    wrenches = {name: read_forces(place, name, '0') for name in model.bodies}
    walls = np.sum([each.force[_ending(each)] for each in wrenches.values()], axis=0) * density
    turned = np.sum([each.moment[_ending(each)] for each in wrenches.values()], axis=0) * density
    spread = float(np.linalg.norm(np.std(walls, axis=0)) / loudness)
    gates.check_spread(spread, len(walls))
    lost = density * _kept(place, '0', ('far',)) + walls.mean(axis=0) + thrust
    balance = float(np.linalg.norm(lost) / loudness)
    gates.check_balance(balance)
    return Blow(
        shares=dict(shares),
        force=_listed(thrust + walls.mean(axis=0)),
        moment=_listed(torque + turned.mean(axis=0)),
        zones={name: zones[name] for name in shares},
        evidence=Evidence(
            spread=_short(spread), window=float(len(walls)), balance=_short(balance),
            residual=_residual(place, 'on'), cells=_cells(mesh), seconds=seconds,
        ),
        pressed={name: read_surface(place, name, density) for name in model.bodies},
    )  # fmt: skip


def _short(number: float) -> float:
    return float(f'{number:.5g}')


def _listed(vector: Array) -> list[float]:
    return [_short(float(each)) for each in vector]

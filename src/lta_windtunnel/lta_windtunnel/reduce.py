# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Reduce solved cases to mean forces and moments, in body axes and SI units."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from lta_windtunnel.flow_fields import read_surface_pressure
from lta_windtunnel.openfoam.case import CaseFailed, ProgramStep, RESIDUAL
from lta_windtunnel.openfoam.output_reader import (
    MeshFacts,
    read_forces,
    read_momentum,
    WrenchHistory,
)
from lta_windtunnel.still_air import SPIN_AXES
from lta_windtunnel.sweep_table import Blow, FlowQuality, round_digits, SweepPoint
from lta_windtunnel.tunnel import (
    has_symmetry_planes,
    OUTER_PATCHES,
    rotate_into_tunnel,
    SETTLING_ITERATIONS,
)
from lta_windtunnel.tunnel_model import TunnelModel
import numpy as np
from numpy.typing import NDArray

MIN_CELLS: Final = 1000  # most cells of a mesh that is none
MIN_FACES: Final = 20  # least mesh faces on each body
MIN_DISK_CELLS: Final = 30  # least cells of a rotor disk
MAX_SPREAD: Final = 0.15  # largest relative deviation in the window; edge-on wakes swing by 7 %
MAX_IMBALANCE: Final = 0.10  # of the force: largest momentum error
MAX_MEAN_ERROR: Final = 0.05  # largest standard error of the mean of a transient
MIN_LENGTHS: Final = 10.0  # least hull lengths of averaged flow
MAX_NON_ORTHOGONALITY: Final = 75.0  # deg; largest non-orthogonality of a mesh
MAX_RATIO: Final = 2.0  # largest factor between the flow and the estimate by hand
AVERAGED_ITERATIONS: Final = 50  # iterations that are averaged


def check_mesh(name: str, facts: MeshFacts) -> None:
    """Raise `CaseFailed` for an invalid mesh."""
    # "not >" also rejects NaN, which stands for a missing number in the log
    if not facts.cells > MIN_CELLS:
        raise CaseFailed(
            f'The {name} has too few cells (more than {MIN_CELLS} are needed); check that the '
            'surface of the shape is closed.'
        )
    if not facts.non_orthogonality <= MAX_NON_ORTHOGONALITY:
        raise CaseFailed(
            f'The {name} has faces with a non-orthogonality of {facts.non_orthogonality:.0f} '
            f'degrees (allowed: {MAX_NON_ORTHOGONALITY:.0f}); smooth sharp corners of the shape.'
        )
    if facts.negative:
        raise CaseFailed(
            f'The {name} has {facts.negative:.0f} cells of negative volume; simplify the shape.'
        )


def check_bodies(name: str, faces: Mapping[str, int], bodies: Iterable[str]) -> None:
    """Raise `CaseFailed` if the mesh lost a body, such as a thin plate between cell centres."""
    for body in bodies:
        if faces.get(body, 0) < MIN_FACES:
            raise CaseFailed(
                f'The {name} has only {faces.get(body, 0)} faces on the body {body}, fewer '
                f'than {MIN_FACES}, because the body is too thin for the mesh; draw it '
                'thicker, or use --fidelity analytic.'
            )


def check_zones(zones: Mapping[str, int], shares: Mapping[str, float]) -> None:
    """Raise `CaseFailed` if a rotor disk has too few cells."""
    for name in shares:
        if zones.get(name, 0) < MIN_DISK_CELLS:
            raise CaseFailed(
                f'The rotor disk of {name} has only {zones.get(name, 0)} mesh cells, fewer '
                f'than {MIN_DISK_CELLS}; increase disk.diameter or disk.thickness in the tunnel '
                'file.'
            )


def check_spread(spread: float, rounds: int) -> None:
    """Raise `CaseFailed` if a steady force has not settled or has too few iterations."""
    if rounds < AVERAGED_ITERATIONS:
        raise CaseFailed(
            f'The solver did only {rounds} iterations, but the mean force needs '
            f'{AVERAGED_ITERATIONS}; look for the cause in its log file in the case folder '
            '(--cache).'
        )
    if not spread <= MAX_SPREAD:
        raise CaseFailed(
            f'The force still varies by {100 * spread:.0f} % (allowed: {100 * MAX_SPREAD:.0f} '
            '%), because the steady flow does not converge; use --fidelity reference.'
        )


def check_brakes(drag: float) -> None:
    """Raise `CaseFailed` for a drag in the direction of motion."""
    if not drag > 0.0:
        raise CaseFailed(
            'The computed drag points in the direction of motion, so the flow is wrong; check '
            'the shape and its mesh.'
        )


def check_mean(error: float, lengths: float) -> None:
    """Raise `CaseFailed` if the mean of a transient is too short or too uncertain."""
    if lengths < MIN_LENGTHS:
        raise CaseFailed(
            f'The mean force covers only {lengths:.1f} hull lengths of flow; at least '
            f'{MIN_LENGTHS:.0f} are needed. Look in the log file in the case folder (--cache) why '
            'the solver stopped early.'
        )
    if not error <= MAX_MEAN_ERROR:
        raise CaseFailed(
            f'The mean force is uncertain by {100 * error:.0f} % (allowed: '
            f'{100 * MAX_MEAN_ERROR:.0f} %), because the wake fluctuates too slowly for the '
            'simulated time. This flow is left out; --fidelity preview solves a steady flow.'
        )


def check_balance(balance: float) -> None:
    """Raise `CaseFailed` if the momentum of a flow does not balance."""
    if not balance <= MAX_IMBALANCE:
        raise CaseFailed(
            f'{100 * balance:.0f} % of the force is missing in the momentum balance of the '
            f'air (allowed: {100 * MAX_IMBALANCE:.0f} %), so the flow has not settled; use '
            '--fidelity reference.'
        )


def is_near_estimate(drag: float, by_hand: float) -> bool:
    """Return whether a drag and the estimate by hand are within a factor of two."""
    return by_hand / MAX_RATIO <= drag <= by_hand * MAX_RATIO


Array = NDArray[np.float64]
Rows = slice | NDArray[np.bool_]
# Hull lengths of flow before a transient is averaged: 4 until the first inflow has passed the
# hull, and 2 for its wake.
STARTING_LENGTHS: Final = 6.0
BATCH_LENGTHS: Final = 5.0  # lengths of flow, about one swing of a wake
LAST_ITERATIONS: Final = slice(-AVERAGED_ITERATIONS, None)  # of a steady flow
LOG_END: Final = 8000  # characters of a log, which may have megabytes, that have the last residual


@final
@dataclass(frozen=True, slots=True)
class SolvedFlow:
    """A solved case."""

    model: TunnelModel
    place: Path  # its folder
    mesh: MeshFacts
    seconds: float  # processor time of each result [s]
    density: float  # of the air [kg/m3]

    def read_bodies(self, begin: str, rows: Rows = LAST_ITERATIONS) -> dict[str, WrenchHistory]:
        """Return the averaged iterations of the wrench on each body, of the step that began so."""
        return {
            name: read_forces(self.place, name, begin).select(rows) for name in self.model.bodies
        }

    def mean_outflow(self, begin: str, patches: tuple[str, ...]) -> Array:
        """Return the mean momentum and pressure flux out of the domain, at 1 kg/m3 [N]."""
        total: Array = (
            read_forces(self.place, 'outer', begin).select(LAST_ITERATIONS).force.mean(axis=0)
        )
        for patch in patches:
            total = total + read_momentum(self.place, patch, begin)[LAST_ITERATIONS].mean(axis=0)
        return total

    def describe_quality(
        self, step: str, spread: float, window: float, balance: float | None = None
    ) -> FlowQuality:
        """Return the quality of the result of a step."""
        log = (self.place / f'log.{step}').read_text(encoding='utf-8', errors='replace')
        residuals = RESIDUAL.findall(log[-LOG_END:])
        return FlowQuality(
            spread=round_digits(spread), window=round_digits(window),
            balance=None if balance is None else round_digits(balance),
            residual=float(residuals[-1]) if residuals else None,
            cells=int(self.mesh.cells), seconds=self.seconds,
        )  # fmt: skip


def _total_force(bodies: Mapping[str, WrenchHistory]) -> Array:
    total: Array = np.sum([each.force for each in bodies.values()], axis=0)
    return total


def _total_moment(bodies: Mapping[str, WrenchHistory]) -> Array:
    total: Array = np.sum([each.moment for each in bodies.values()], axis=0)
    return total


def summarize_steady_wind(
    flow: SolvedFlow, axis: str, step: ProgramStep, speed: float
) -> SweepPoint:
    """
    Return the result of one speed [m/s] of a steady wind tunnel.

    Raises
    ------
    CaseFailed
        If a check of the flow fails.

    """
    bodies = flow.read_bodies(step.begin)
    drags = _total_force(bodies)[:, 0]
    drag = float(np.mean(drags))
    spread = float(np.std(drags)) / abs(drag)
    check_spread(spread, len(drags))
    check_brakes(drag)
    # Momentum balance: drag on the bodies plus momentum leaving the domain must cancel.
    balance = abs(float(flow.mean_outflow(step.begin, OUTER_PATCHES)[0]) + drag) / abs(drag)
    check_balance(balance)
    quality = flow.describe_quality(step.name, spread, float(len(drags)), balance)
    planes = has_symmetry_planes(flow.model, axis)
    return _build_wind_point(flow, axis, speed, bodies, planes, quality)


def summarize_transient_wind(
    flow: SolvedFlow, axis: str, step: ProgramStep, speed: float
) -> SweepPoint:
    """Return the result of a transient wind tunnel; its spread is the standard error."""
    length = flow.model.length
    time = next(iter(flow.read_bodies(step.begin, slice(None)).values())).time
    # Skip the start: the wake needs time to develop.
    bodies = flow.read_bodies(step.begin, time >= SETTLING_ITERATIONS + STARTING_LENGTHS * length)
    drags = _total_force(bodies)[:, 0]
    # Time steps vary: weight each value with its duration
    weights = np.gradient(next(iter(bodies.values())).time)
    window = float(weights.sum())
    error = standard_error(drags, weights, BATCH_LENGTHS * length)
    check_mean(error, window / length)
    check_brakes(float(np.average(drags, weights=weights)))
    quality = flow.describe_quality(step.name, error, window)
    return _build_wind_point(flow, axis, speed, bodies, (False, False), quality, weights)


def standard_error(values: Array, weights: Array, batch: float) -> float:
    """
    Return the standard error of the mean of a history, relative to its mean [1].

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


def _build_wind_point(
    flow: SolvedFlow, axis: str, speed: float, bodies: Mapping[str, WrenchHistory],
    planes: tuple[bool, bool], quality: FlowQuality, weights: Array | None = None,
) -> SweepPoint:  # fmt: skip
    """Return the mean wrench in body axes; `weights` are the durations of the rows."""

    def average(values: Array) -> Array:
        mean: Array = np.average(values, axis=0, weights=weights)
        return mean

    # The flow was solved at 1 m/s and 1 kg/m3; forces grow with rho U^2.
    scale = flow.density * speed**2
    force, moment = average(_total_force(bodies)), average(_total_moment(bodies))
    drags = {name: float(average(each.force)[0]) for name, each in bodies.items()}
    friction = sum(float(average(each.viscous)[0]) for each in bodies.values())
    for k in (k for k, is_one in zip((1, 2), planes, strict=True) if is_one):
        # Only half of the body was solved: antisymmetric components cancel, the others double. A
        # plane of symmetry allows only the moment about its normal.
        force, moment, scale = force * (np.arange(3) != k), moment * (np.arange(3) == k), 2 * scale
    # A rotation matrix: its transpose, from tunnel to body axes, is its inverse
    turn = rotate_into_tunnel(axis).T
    return SweepPoint(
        speed=speed,
        force=_to_list(scale * (turn @ force)),
        moment=_to_list(scale * (turn @ moment)),
        parts={name: round_digits(scale * each) for name, each in drags.items()},
        viscous=round_digits(friction / sum(drags.values())),
        evidence=quality,
    )


def summarize_rotation(flow: SolvedFlow, about: str, step: ProgramStep, rate: float) -> SweepPoint:
    """Return the result of one rate of rotation [rad/s]."""
    axis = np.array(SPIN_AXES[about])
    bodies = flow.read_bodies(step.begin)
    moments = _total_moment(bodies)
    mean = float(np.mean(moments @ axis))
    spread = float(np.std(moments @ axis)) / abs(mean)
    check_spread(spread, len(moments))
    # The moment must oppose the positive rotation
    check_brakes(-mean)
    scale = flow.density * rate**2
    return SweepPoint(
        speed=rate,
        force=_to_list(scale * _total_force(bodies).mean(axis=0)),
        moment=_to_list(scale * moments.mean(axis=0)),
        parts={
            name: round_digits(-scale * float(np.mean(each.moment @ axis)))
            for name, each in bodies.items()
        },
        viscous=0.0,
        evidence=flow.describe_quality(step.name, spread, float(len(moments))),
    )


def summarize_rotors(flow: SolvedFlow, shares: Mapping[str, float]) -> Blow:
    """Return the net wrench of running rotors."""
    check_zones(flow.mesh.zones, shares)
    thrust, torque, loudness = np.zeros(3), np.zeros(3), 0.0
    for name, share in shares.items():
        rotor = flow.model.rotors[name]
        push = share * rotor.thrust * np.array(rotor.axis)
        thrust += push
        # The disks are momentum sources, so their thrust is not in the wall forces.
        torque += np.cross(rotor.place, push)
        loudness += abs(share) * rotor.thrust
    bodies = flow.read_bodies('0')
    walls, turned = flow.density * _total_force(bodies), flow.density * _total_moment(bodies)
    spread = float(np.linalg.norm(np.std(walls, axis=0))) / loudness
    check_spread(spread, len(walls))
    # Momentum balance of the box: outflow, forces on the walls, and the thrust
    lost = flow.density * flow.mean_outflow('0', ('far',)) + walls.mean(axis=0) + thrust
    balance = float(np.linalg.norm(lost)) / loudness
    check_balance(balance)
    return Blow(
        shares=dict(shares),
        force=_to_list(thrust + walls.mean(axis=0)),
        moment=_to_list(torque + turned.mean(axis=0)),
        zones={name: flow.mesh.zones[name] for name in shares},
        evidence=flow.describe_quality('on', spread, float(len(walls)), balance),
        pressed={name: read_surface_pressure(flow.place, name, flow.density) for name in bodies},
    )


def _to_list(vector: Array) -> list[float]:
    return [round_digits(float(each)) for each in vector]

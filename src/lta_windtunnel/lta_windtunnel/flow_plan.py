# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plan the flows of a sweep for a fidelity."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, final, Literal

from lta_windtunnel.openfoam.case import FoamCase
from lta_windtunnel.still_air import build_blowing_case, build_spinning_case, TURN_RATES
from lta_windtunnel.still_air import SPIN_AXES as SPINS
from lta_windtunnel.thrust_allocation import maps_onto, REVERSED_SUFFIX
from lta_windtunnel.tunnel import (
    build_steady_wind_case,
    build_transient_wind_case,
    choose_mesh_fineness,
    COARSE_MESH,
    FAST_MESH,
    INCIDENCES,
    PREVIEW,
    ROUGH_MESH,
    SPEEDS,
)
from lta_windtunnel.tunnel_model import TunnelModel

Kind = Literal['wind', 'coarse', 'transient', 'spin', 'blow']
Air = tuple[float, float]  # density [kg/m3], kinematic viscosity [m2/s]
TUNNEL_AIR: Final[Air] = (1.2, 1.5e-5)  # at 20 degC
MIDDLE_SPEED: Final = 1.0  # m/s
SLOW_SPEED: Final = 0.2  # m/s; here the steady model is accurate for a sphere
# Hull lengths of flow in a transient; the first ones are not averaged
TRANSIENT_LENGTHS: Final = 26.0


@final
@dataclass(frozen=True, slots=True)
class TunnelFlow:
    """One flow of a sweep."""

    kind: Kind  # 'wind', 'coarse' (a wind on a coarser mesh), 'transient', 'spin' or 'blow'
    about: str  # axis or rotor pattern
    case: FoamCase
    speeds: Sequence[float] = ()  # speeds of the results [m/s or rad/s]
    # Thrust of the running rotors, relative to full thrust
    shares: Mapping[str, float] | None = None

    @property
    def mesh(self) -> FoamCase:
        """Case that makes the mesh."""
        assert self.case.mesh is not None
        return self.case.mesh


def list_rotor_patterns(model: TunnelModel) -> dict[str, Mapping[str, float]]:
    """
    Return the rotor patterns to solve: each rotor forward and reversed, and those of the file.

    A rotor that is equivalent to an earlier one by symmetry is left out.
    """
    singles: dict[str, Mapping[str, float]] = {}
    changes = model.find_symmetries()
    for name in model.rotors:
        if not any(
            maps_onto(change, model.rotors[earlier], model.rotors[name])
            for earlier in singles
            for change in changes
        ):
            singles[name] = {name: 1.0}
    # Listed last: the most informative flows are solved first
    back = {f'{name}{REVERSED_SUFFIX}': {name: -1.0} for name in singles}
    return {**model.patterns, **singles, **back}


def plan_flows(
    model: TunnelModel, fidelity: str, air: Air, only: Sequence[str] = ()
) -> list[TunnelFlow]:
    """
    Return the flows of a sweep, the most informative first.

    Sway and pitch are left out where a quarter turn gives them from surge and roll.

    `fidelity`: 'preview' or 'reference'. `air`: density [kg/m3] and kinematic viscosity [m2/s].
    `only`: axes, incidences and patterns to solve; by default all but the incidences.
    """
    flows = [
        *_plan_winds(model, fidelity, air[1]),
        *_plan_rotation_flows(model, air[1]),
        *_plan_rotor_flows(model, air),
    ]
    if fidelity == 'preview':
        flows += _plan_coarse_winds(model, air[1])
    flows = [flow for flow in flows if not only or flow.about in only]
    return flows + [
        _plan_incidence(model, name, fidelity, air[1]) for name in INCIDENCES if name in only
    ]


def _wind_directions(model: TunnelModel) -> Sequence[str]:
    return ('heave', 'surge') if model.has_quarter_symmetry else ('heave', 'surge', 'sway')


def _plan_winds(model: TunnelModel, fidelity: str, viscosity: float) -> Iterator[TunnelFlow]:
    for axis in _wind_directions(model):
        if fidelity == 'preview':
            case = build_steady_wind_case(model, axis, viscosity, PREVIEW)
            yield TunnelFlow('wind', axis, case, SPEEDS)
            continue
        fine = choose_mesh_fineness(model, viscosity, MIDDLE_SPEED)
        # One transient per axis, at the middle speed; the slow point is steady, see `SLOW_SPEED`
        eddies = build_transient_wind_case(
            model, axis, viscosity, fine, MIDDLE_SPEED, TRANSIENT_LENGTHS
        )
        yield TunnelFlow('transient', axis, eddies, (MIDDLE_SPEED,))
        slow = build_steady_wind_case(model, axis, viscosity, PREVIEW, (SLOW_SPEED,))
        yield TunnelFlow('wind', axis, replace(slow, name=f'{axis}, slow'), (SLOW_SPEED,))


def _plan_incidence(model: TunnelModel, name: str, fidelity: str, viscosity: float) -> TunnelFlow:
    """
    Return forward flight with the nose up, at the middle speed.

    Transients use the coarse mesh: at 10 degrees, three times the processor time changed lift and
    moment by 5 %.
    """
    if fidelity == 'preview':
        case = build_steady_wind_case(model, name, viscosity, PREVIEW, (MIDDLE_SPEED,))
        return TunnelFlow('wind', name, case, (MIDDLE_SPEED,))
    fine = choose_mesh_fineness(model, viscosity, MIDDLE_SPEED)
    coarse = fine if fine is FAST_MESH else ROUGH_MESH
    case = build_transient_wind_case(
        model, name, viscosity, coarse, MIDDLE_SPEED, TRANSIENT_LENGTHS
    )
    return TunnelFlow('transient', name, case, (MIDDLE_SPEED,))


def _plan_coarse_winds(model: TunnelModel, viscosity: float) -> Iterator[TunnelFlow]:
    """Yield the middle speed of each wind on a coarser mesh."""
    for axis in _wind_directions(model):
        case = build_steady_wind_case(model, axis, viscosity, COARSE_MESH, (MIDDLE_SPEED,))
        yield TunnelFlow(
            'coarse', axis, replace(case, name=f'{axis} on a coarser mesh'), (MIDDLE_SPEED,)
        )


def _plan_rotation_flows(model: TunnelModel, viscosity: float) -> Iterator[TunnelFlow]:
    for about in SPINS:
        if about == 'pitch' and model.has_quarter_symmetry:
            continue
        yield TunnelFlow('spin', about, build_spinning_case(model, about, viscosity), TURN_RATES)


def _plan_rotor_flows(model: TunnelModel, air: Air) -> Iterator[TunnelFlow]:
    if not model.rotors:
        return
    for name, shares in list_rotor_patterns(model).items():
        yield TunnelFlow('blow', name, build_blowing_case(model, name, shares, air), shares=shares)

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define the raw sweep: the result of each flow, in SI units and body axes about the hull centre.

`refit` fits coefficients and columns again from this file alone, without a flow solver.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal

from lta_config.errors import BadInput
from lta_config.files import format_error, StrictModel
from pydantic import ConfigDict, Field, ValidationError

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Axis = Literal['surge', 'sway', 'heave', 'roll', 'pitch', 'yaw']
AXES: tuple[Axis, ...] = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')


class FlowQuality(StrictModel):
    """
    Quality of a flow.

    spread: relative standard deviation of drag or thrust in the window, for a transient the
    standard error of the mean [1]; window: averaged iterations, or seconds of a transient;
    residual: of the pressure at the end; balance: momentum residual over the force [1]; cells: of
    the mesh.
    """

    spread: float
    window: float
    residual: float | None = None
    balance: float | None = None
    cells: int
    seconds: float


class SweepPoint(StrictModel):
    """Aerodynamic wrench on the vehicle at one speed [m/s] or rate [rad/s] [N, N m]."""

    speed: Annotated[float, Field(gt=0.0)]
    force: Vector
    moment: Vector
    parts: Mapping[str, float]  # drag of each body [N or N m]
    viscous: float  # share of the drag that is friction [1]
    evidence: FlowQuality


class SurfacePressure(StrictModel):
    """
    Pressure on a body relative to the far field [Pa].

    least, most: extremes over its faces, with their positions [m]; below: map seen from below,
    rows along y from the lowest, columns along x, None outside the body, empty if no map was
    stored; side: edge of that square. [m]
    """

    least: float
    most: float
    least_at: Vector
    most_at: Vector
    below: Sequence[Sequence[float | None]]
    side: float


class Blow(StrictModel):
    """
    Net wrench with some rotors running, including their own thrust [N, N m].

    pressed: pressure of their jets on each body; missing in older sweeps.
    """

    shares: Mapping[str, float]
    force: Vector
    moment: Vector
    zones: Mapping[str, int]
    evidence: FlowQuality
    pressed: Mapping[str, SurfacePressure] = Field(default_factory=dict)


class RotorPlacement(StrictModel):
    """A rotor as placed in the tunnel."""

    place: Vector
    axis: Vector
    thrust: float


class TunnelSweep(StrictModel):
    """A whole sweep."""

    model_config = ConfigDict(extra='ignore')  # older sweeps have the volume of the hull
    schema_version: Literal[1]
    name: str
    vehicle: str
    fidelity: Literal['analytic', 'preview', 'reference']
    engine: str
    geometry: str  # fingerprint
    length: float  # of the hull [m]
    frontal: Vector  # shadows of the hull along x, y, z [m2]
    density: float  # [kg/m3]
    viscosity: float  # kinematic [m2/s]
    # Rotations and reflections that map the bodies onto themselves, row by row.
    symmetries: Sequence[Sequence[Vector]]
    rotors: Mapping[str, RotorPlacement]
    axes: Mapping[Axis, Sequence[SweepPoint]]
    by_hand: Mapping[Axis, Sequence[SweepPoint]]
    blows: Mapping[str, Blow]
    # One speed of an axis on a coarser mesh; missing in older sweeps.
    coarse: Mapping[Axis, SweepPoint] = Field(default_factory=dict)
    # Forward flight with the nose up, by the name of the incidence; missing in older sweeps.
    inclined: Mapping[str, SweepPoint] = Field(default_factory=dict)
    refused: Mapping[str, str]  # failed flows and flows that failed a check, with the reason


def round_digits(number: float, digits: int = 5) -> float:
    """Return a number rounded to significant digits."""
    return float(f'{number:.{digits}g}')


def read_sweep(path: Path) -> TunnelSweep:
    """Read a sweep from its file; raise `BadInput` for any error."""
    try:
        return TunnelSweep.model_validate_json(path.read_bytes())
    except OSError as error:
        raise BadInput(f'{path} cannot be read ({error.strerror}); check the path.') from None
    except ValidationError as error:
        raise BadInput(f'{path}: {format_error(error)}') from None


def drop_pressure_maps(sweep: TunnelSweep) -> TunnelSweep:
    """Return a sweep without its pressure maps, which are most of its size."""
    blows = {
        name: blow.model_copy(
            update={
                'pressed': {
                    body: pressed.model_copy(update={'below': []})
                    for body, pressed in blow.pressed.items()
                }
            }
        )
        for name, blow in sweep.blows.items()
    }
    return sweep.model_copy(update={'blows': blows})


def format_sweep(sweep: TunnelSweep) -> str:
    """Format a sweep as JSON."""
    return sweep.model_dump_json(indent=1) + '\n'

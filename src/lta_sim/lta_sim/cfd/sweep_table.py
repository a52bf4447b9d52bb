"""
The raw sweep: what each flow gave, in SI and body axes about the hull centre. Small data.

From it alone, without a flow solver, coefficients and columns are fitted again (`refit`).
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal

from lta_config.errors import BadInput
from lta_config.files import Record
from lta_config.sentence import sentence
from pydantic import Field, ValidationError

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Axis = Literal['surge', 'sway', 'heave', 'roll', 'pitch', 'yaw']
AXES: tuple[Axis, ...] = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')


class Evidence(Record):
    """
    How good a flow is.

    spread: standard deviation of drag or thrust in the window over its mean, of a transient the
    standard error of the mean [1]; window: rounds, or seconds of a transient, that are averaged;
    residual: of the pressure at the end; balance: momentum that is not accounted for, over the
    force [1]; cells: of the mesh.
    """

    spread: float
    window: float
    residual: float | None = None
    balance: float | None = None
    cells: int
    seconds: float


class Point(Record):
    """One speed [m/s] or rate [rad/s]: what the air does to the vehicle. [N, N m]."""

    speed: Annotated[float, Field(gt=0.0)]
    force: Vector
    moment: Vector
    parts: Mapping[str, float]  # drag of each body [N or N m]
    viscous: float  # share of the drag that is friction [1]
    evidence: Evidence


class Pressed(Record):
    """
    The pressure on a body over that of the air far away. [Pa].

    least, most: of its faces, with the places of both [m]; below: seen from below, rows along y
    from the least, columns along x, None where the body is not, no row where no map was kept;
    side: of that square. [m]
    """

    least: float
    most: float
    least_at: Vector
    most_at: Vector
    below: Sequence[Sequence[float | None]]
    side: float


class Blow(Record):
    """
    Some rotors on: the net wrench, their own thrust included. [N, N m].

    pressed: what their jets do to each body; older sweeps do not tell.
    """

    shares: Mapping[str, float]
    force: Vector
    moment: Vector
    zones: Mapping[str, int]
    evidence: Evidence
    pressed: Mapping[str, Pressed] = Field(default_factory=dict)


class Place(Record):
    """A rotor as it stood in the tunnel."""

    place: Vector
    axis: Vector
    thrust: float


class Sweep(Record):
    """A whole sweep."""

    schema_version: Literal[1]
    name: str
    vehicle: str
    fidelity: Literal['analytic', 'preview', 'reference']
    engine: str
    geometry: str  # fingerprint
    length: float  # of the hull [m]
    volume: float  # [m3]
    frontal: Vector  # shadows of the hull along x, y, z [m2]
    density: float  # [kg/m3]
    viscosity: float  # kinematic [m2/s]
    # Turns and mirrorings that leave the bodies as they are, row by row.
    symmetries: Sequence[Sequence[Vector]]
    rotors: Mapping[str, Place]
    axes: Mapping[Axis, Sequence[Point]]
    by_hand: Mapping[Axis, Sequence[Point]]
    blows: Mapping[str, Blow]
    # One speed of an axis on a coarser mesh; older sweeps do not tell.
    coarse: Mapping[Axis, Point] = Field(default_factory=dict)
    refused: Mapping[str, str]  # flows that came to nothing or failed a gate, and why


def read_sweep(path: Path) -> Sweep:
    """Return a sweep from its file; anything wrong is a `BadInput` sentence."""
    try:
        return Sweep.model_validate_json(path.read_bytes())
    except OSError as error:
        raise BadInput(f'{path} cannot be read ({error.strerror}); check the path.') from None
    except ValidationError as error:
        raise BadInput(f'{path}: {sentence(error)}') from None


def without_maps(sweep: Sweep) -> Sweep:
    """Return a sweep without its maps of pressure, which are most of it: small data to keep."""
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


def sweep_text(sweep: Sweep) -> str:
    """Return a sweep as it is kept."""
    return sweep.model_dump_json(indent=1) + '\n'

"""What a flow must show before its numbers are taken."""

from collections.abc import Iterable, Mapping
from typing import Final

from lta_sim.cfd.openfoam.engine import CaseFailed

FACES: Final = 20  # of the mesh, on each body
ZONE: Final = 30  # cells of a rotor's disk
SPREAD: Final = 0.15  # of a steady flow's window; edge-on wakes swing by 7 %
BALANCE: Final = 0.10  # of the force
ERROR: Final = 0.05  # standard, of the mean of a transient
LENGTHS: Final = 10.0  # of flow that are averaged
ANGLE: Final = 75.0  # deg
FACTOR: Final = 2.0  # between the flow and the estimate by hand
WINDOW: Final = 50  # rounds


def check_mesh(name: str, facts: Mapping[str, float | Mapping[str, int]]) -> None:
    """Refuse a mesh that is no mesh; facts as `read_mesh` gives them."""
    cells, angle, negative = facts['cells'], facts['non_orthogonality'], facts['negative']
    assert isinstance(cells, float)
    assert isinstance(angle, float)
    assert isinstance(negative, float)
    if not cells > 1000:
        raise CaseFailed(f'The {name} has no cells; see whether its shape is closed.')
    if not angle <= ANGLE:
        raise CaseFailed(
            f'The {name} has faces {angle:.0f} degrees askew, over {ANGLE:.0f}; '
            'simplify sharp corners of the shape.'
        )
    if negative:
        raise CaseFailed(
            f'The {name} has {negative:.0f} cells of negative volume; simplify the shape.'
        )


def check_bodies(name: str, faces: Mapping[str, int], bodies: Iterable[str]) -> None:
    """Refuse a mesh that has lost a body, as a plate or a bar between the cells' middles is."""
    for body in bodies:
        if faces.get(body, 0) < FACES:
            raise CaseFailed(
                f'The {name} has {faces.get(body, 0)} faces on {body}, fewer than {FACES}: it is '
                'too thin to be found; draw it thicker, or take --fidelity analytic.'
            )


def check_zones(zones: Mapping[str, int], shares: Mapping[str, float]) -> None:
    """Refuse rotors whose disks are too few cells to blow."""
    for name in shares:
        if zones.get(name, 0) < ZONE:
            raise CaseFailed(
                f'The disk of {name} has {zones.get(name, 0)} cells, fewer than {ZONE}; '
                'make disk.diameter or disk.thickness of the tunnel file larger.'
            )


def check_spread(spread: float, rounds: int) -> None:
    """Refuse a force that still moves, or was seen too briefly."""
    if rounds < WINDOW:
        raise CaseFailed(f'Only {rounds} rounds were solved, fewer than the {WINDOW} averaged.')
    if not spread <= SPREAD:
        raise CaseFailed(
            f'The force still swings by {100 * spread:.0f} % (over {100 * SPREAD:.0f} %); '
            'the steady flow does not settle: take --fidelity reference.'
        )


def check_brakes(drag: float) -> None:
    """Refuse a drag that pushes."""
    if not drag > 0.0:
        raise CaseFailed('The air pushes where it should brake; the flow is wrong.')


def check_mean(error: float, lengths: float) -> None:
    """Refuse the mean of a transient that is too short or too uncertain."""
    if lengths < LENGTHS:
        raise CaseFailed(f'Only {lengths:.1f} lengths of flow are averaged, under {LENGTHS:.0f}.')
    if not error <= ERROR:
        raise CaseFailed(
            f'The mean force is uncertain by {100 * error:.0f} % (over {100 * ERROR:.0f} %); '
            'its wake swings too slowly for the flow that was solved.'
        )


def check_balance(balance: float) -> None:
    """Refuse a flow whose momentum does not add up."""
    if not balance <= BALANCE:
        raise CaseFailed(
            f'{100 * balance:.0f} % of the force is not in the momentum of the air (over '
            f'{100 * BALANCE:.0f} %); the flow has not settled.'
        )


def is_near_estimate(drag: float, by_hand: float) -> bool:
    """Tell whether a drag and the estimate by hand are within a factor of two."""
    return by_hand / FACTOR <= drag <= by_hand * FACTOR

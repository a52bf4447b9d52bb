"""Check a solved flow before its numbers are used."""

from collections.abc import Iterable, Mapping
from typing import Final

from lta_windtunnel.openfoam.output_reader import MeshFacts
from lta_windtunnel.openfoam.programs import CaseFailed

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

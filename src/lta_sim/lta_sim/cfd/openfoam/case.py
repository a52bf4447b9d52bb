"""Define an OpenFOAM case: its files, and the programs that solve it step by step."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Final, final

FORMAT: Final = 'lta-1'  # cache format; cases of another format are solved again
NOTHING: Final[Mapping[str, str]] = {}


@final
@dataclass(frozen=True, slots=True)
class ProgramStep:
    """
    One program run in the folder of a case.

    Parameters
    ----------
    name : str
        Unique within the case.
    files : mapping of str to str
        Files to write before the run, by path; they replace existing ones.
    rounds : int
        Approximate number of iterations or time steps; 0 if it reports none.
    begin : str
        Name of the time folder that it starts from.

    """

    name: str
    command: Sequence[str]
    files: Mapping[str, str] = field(default_factory=dict)
    rounds: int = 0
    begin: str = '0'


@final
@dataclass(frozen=True, slots=True)
class FoamCase:
    """
    A mesh, or a flow on a mesh.

    Parameters
    ----------
    name : str
        Label for users.
    files : mapping of str to str or bytes
        Content by path.
    mesh : FoamCase, optional
        Case of the mesh that the flow is solved on.
    cells : int
        Expected number of cells.

    """

    name: str
    files: Mapping[str, str | bytes]
    steps: Sequence[ProgramStep]
    mesh: 'FoamCase | None' = None
    cells: int = 0

    @property
    def key(self) -> str:
        """Hash of everything that determines the result, including the mesh."""
        # Step files are hashed too: they change the result as much as the case's files.
        digest = sha256(FORMAT.encode())
        digest.update(self.mesh.key.encode() if self.mesh else b'')
        for path, content in sorted(self.files.items()):
            digest.update(path.encode())
            digest.update(content if isinstance(content, bytes) else content.encode())
        for step in self.steps:
            digest.update(repr((step.name, tuple(step.command), step.begin)).encode())
            digest.update(repr(sorted(step.files.items())).encode())
        # 80 bits: collisions are out of the question, and paths stay short
        return digest.hexdigest()[:20]

    @property
    def work(self) -> float:
        """Cells times iterations, for the time estimate."""
        # A step without iterations counts as 20; 50,000 cells where the number is unknown
        return sum(max(step.rounds, 20) for step in self.steps) * float(self.cells or 50_000)

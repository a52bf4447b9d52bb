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
    """One program run in the folder of a case."""

    name: str  # unique within the case
    command: Sequence[str]
    # Files to write before the run, by path; they replace existing ones
    files: Mapping[str, str] = field(default_factory=dict)
    rounds: int = 0  # approximate number of iterations or time steps; 0 if it reports none
    begin: str = '0'  # name of the time folder that it starts from


@final
@dataclass(frozen=True, slots=True)
class FoamCase:
    """A mesh, or a flow on a mesh."""

    name: str  # label for users
    files: Mapping[str, str | bytes]  # content by path
    steps: Sequence[ProgramStep]
    mesh: 'FoamCase | None' = None  # case of the mesh that the flow is solved on
    cells: int = 0  # expected number of cells

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

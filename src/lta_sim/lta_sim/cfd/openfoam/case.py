"""An OpenFOAM case: all of its files, and the programs that solve it step by step."""

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
        Of the step, once in its case.
    command : sequence of str
        Program and arguments.
    files : mapping of str to str
        What is written before, by path; it replaces what was there.
    rounds : int
        Iterations or time steps that it makes, about; 0 where it counts none.
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
    A mesh, or a flow on one.

    Parameters
    ----------
    name : str
        What people call it.
    files : mapping of str to str or bytes
        Content by path.
    steps : sequence of Step
        One after the other.
    mesh : Case, optional
        On whose mesh it is solved.
    cells : int
        Of the mesh, as expected.

    """

    name: str
    files: Mapping[str, str | bytes]
    steps: Sequence[ProgramStep]
    mesh: 'FoamCase | None' = None
    cells: int = 0

    @property
    def key(self) -> str:
        """Hash of everything that determines the result: its own content and its mesh."""
        # Step files are hashed too: they change the result as much as the case's files.
        told = sha256(FORMAT.encode())
        told.update(self.mesh.key.encode() if self.mesh else b'')
        for path, content in sorted(self.files.items()):
            told.update(path.encode())
            told.update(content if isinstance(content, bytes) else content.encode())
        for step in self.steps:
            told.update(repr((step.name, tuple(step.command), step.begin)).encode())
            told.update(repr(sorted(step.files.items())).encode())
        return told.hexdigest()[:20]

    @property
    def work(self) -> float:
        """Cells times iterations, for the time estimate."""
        return sum(max(step.rounds, 20) for step in self.steps) * float(self.cells or 50_000)

"""Show the progress of a sweep: running flows, their residuals and the time left."""

from collections.abc import Sequence
import math
from typing import final

from lta_report.progress_bar import ProgressBar
from lta_windtunnel.flow_plan import TunnelFlow
from lta_windtunnel.openfoam.case import CaseRunner, FoamCase, ProgramStep
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn


def list_cases(flows: Sequence[TunnelFlow]) -> list[FoamCase]:
    """Return the unique cases of some flows, meshes first."""
    meshes = [flow.case.mesh for flow in flows if flow.case.mesh is not None]
    unique = {case.key: case for case in [*meshes, *(flow.case for flow in flows)]}
    return list(unique.values())


@final
class TunnelProgress(ProgressBar):
    """
    Progress bar of a sweep.

    The time left is extrapolated from the pace of the last ten minutes, so that it includes the
    load of other programs.
    """

    def __init__(self, console: Console, flows: Sequence[TunnelFlow]) -> None:
        columns = (
            TextColumn('{task.description}'),
            BarColumn(),
            TimeRemainingColumn(),
        )
        self._cases = list_cases(flows)
        # A bar with a total of 0 would never complete.
        work = sum(case.work for case in self._cases) or 1.0
        super().__init__(console, *columns, begin='meshes', total=work, period=600.0)
        self._done: dict[str, float] = {}
        self._telling: dict[str, str] = {}

    def skip_solved(self, stages: CaseRunner) -> None:
        """Exclude cases that are already solved."""
        self._cases = [case for case in self._cases if not stages.is_done(case)]
        self.update_bar(total=sum(case.work for case in self._cases) or 1.0)

    def update_case_progress(
        self, case: FoamCase, step: ProgramStep, share: float, residual: float
    ) -> None:
        """Update the progress of a case."""
        # Programs without iterations count as 20 rounds, so that they advance the bar too.
        rounds = [max(each.rounds, 20) for each in case.steps]
        before = sum(rounds[: list(case.steps).index(step)])
        done = (before + share * rounds[list(case.steps).index(step)]) / sum(rounds)
        self._done[case.key] = done * case.work
        suffix = '' if math.isnan(residual) else f' {residual:.0e}'
        self._telling[case.key] = f'{case.name} {100 * done:.0f} %{suffix}'
        if done >= 1.0:
            del self._telling[case.key]
        # Three running cases fit on a line.
        words = ', '.join(list(self._telling.values())[:3])
        self.update_bar(completed=sum(self._done.values()), description=words)

"""
Compare the drag of a sphere in the wind tunnel with Morrison's formula and Achenbach's scatter.

Needs OpenFOAM. A kind is a fidelity of `lta cfd run`. The steady flows of `preview`, on two
meshes, take minutes, the transient ones of `reference` about an hour. Solved flows are cached.
"""

from argparse import Namespace
from collections.abc import Iterator
from dataclasses import asdict
from typing import Final

from lta_config.machine import count_cores
from lta_windtunnel.flow_plan import TUNNEL_AIR
from lta_windtunnel.flow_solvers import ThreadedFlowSolver
from lta_windtunnel.openfoam.case import cache_folder
from lta_windtunnel.openfoam.programs import require_openfoam
from lta_windtunnel.validation import (
    build_sphere_model,
    compare_with_measurements,
    plan_validation_flows,
)

from campaigns.harness import Campaign, Case, Row, Rows

KINDS: Final = ('preview', 'reference')


def solve_sphere(case: Case, options: Namespace) -> Row:
    """Solve the flows of a fidelity, and compare each point with the measured drag."""
    require_openfoam()
    model, failures = build_sphere_model(), list[str]()
    flows = plan_validation_flows(model, case.kind, TUNNEL_AIR)
    solver = ThreadedFlowSolver(cache_folder(), count_cores(), lambda *_: None)
    points = compare_with_measurements(solver, model, flows, TUNNEL_AIR, failures.append)
    return {'points': [asdict(each) for each in points], 'wrong': '; '.join(failures)}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the lines of the table."""
    yield '| setting | Reynolds number | drag coefficient | Morrison | outside the scatter by |'
    yield '|---|---|---|---|---|'
    for row in rows.values():
        for each in row.get('points', ()):
            yield (
                f'| {each["setting"]} | {each["reynolds"]:.2g} | {each["coefficient"]:.3f} '
                f'± {each["error"] * each["coefficient"]:.3f} | {each["measured"]:.3f} '
                f'| {100 * each["off"]:+.0f} % |'
            )


CAMPAIGN: Final = Campaign(lambda options: KINDS, solve_sphere, list_table)

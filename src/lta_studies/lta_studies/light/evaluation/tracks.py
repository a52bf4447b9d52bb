"""Plot one flight of each strategy from above, all with the same seed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

from lta_flight.loop_view import LoopView
from lta_flight.report.room import choose_tick_distance, draw_room
from lta_flight.sweep.plan import SweepPlan
from lta_model.scenario import Scenario
from lta_report.curves import Array
from lta_report.drawing import create_figure
from lta_studies.light.evaluation import labels
from lta_studies.light.evaluation.cells import EvaluationCell
from lta_studies.light.evaluation.flights import build_standalone_job, prepare_flight
from lta_studies.light.evaluation.pictures import LEGEND, strategy_color
import numpy as np
from plotly.graph_objects import Figure, Scatter

BEADS = 400  # points of a track, at most about twice that
MARGIN = 0.25  # m of blank space around the room


@final
@dataclass(frozen=True, slots=True)
class EvaluationTrack:
    """Ground track of one flight over time. [s], [m, map]"""

    strategy: str
    time: Array
    x: Array
    y: Array
    reached: bool


def select_track_seed(cells: Sequence[EvaluationCell]) -> int:
    """Return the first seed in which the most strategies reach the lamp."""
    seeds = sorted({seed for cell in cells for seed in cell.rows})
    # -seed: of equal seeds the first
    return max(seeds, key=lambda seed: (sum(seed in cell.arrivals for cell in cells), -seed))


def fly_again(
    plan: SweepPlan, cells: Sequence[EvaluationCell], seed: int
) -> tuple[list[EvaluationTrack], Scenario]:
    """Repeat the flights of one seed, since rows do not store tracks."""
    flight_tracks = []
    for cell in cells:
        if seed not in cell.rows:
            continue
        row = cell.rows[seed]
        loop = prepare_flight(build_standalone_job(plan, plan.build_job(row.index)))
        view = LoopView(loop)
        for _ in loop.iterate_steps():
            view.record_step()
        truth = view.truth
        # Integer division, so the step is too small rather than too large.
        keep = slice(None, None, max(1, len(truth.x) // BEADS))
        way = (truth.time[keep], truth.x[keep], truth.y[keep])
        flight_tracks.append(EvaluationTrack(cell.strategy, *way, seed in cell.arrivals))
    return flight_tracks, loop.world.scenario


def plot_tracks(tracks: Sequence[EvaluationTrack], scenario: Scenario, height: float) -> Figure:
    """Plot some tracks in their room."""
    figure = create_figure()
    draw_room(figure, scenario, height)
    figure.update_traces(showlegend=False)
    for each in tracks:
        shade = strategy_color(each.strategy)
        figure.add_trace(
            Scatter(
                x=each.x.astype(np.float32), y=each.y.astype(np.float32), mode='lines',
                name=labels.label_strategy(each.strategy), line={'color': shade, 'width': 1.8},
                showlegend=True, hoverinfo='name',
            )
        )  # fmt: skip
    length, width, _ = scenario.room.size.vector
    step = choose_tick_distance(max(length, width))
    shared = {'showgrid': False, 'dtick': step, 'constrain': 'domain'}
    figure.update_xaxes(
        range=[-length / 2 - MARGIN, length / 2 + MARGIN], title_text='x [m]', **shared
    )
    figure.update_yaxes(
        range=[-width / 2 - MARGIN, width / 2 + MARGIN], title_text='y [m]', scaleanchor='x',
        constraintoward='top', **shared,
    )  # fmt: skip
    return figure.update_layout(
        hovermode='closest', showlegend=True, legend=LEGEND,
        margin={'l': 44, 'r': 12, 't': 26, 'b': 40},
    )  # fmt: skip

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Which hull carries most for its drag: three shapes in six sizes, by hand or in the wind tunnel.

In the environment of LTA; writes hull_shapes.html beside what it prints:

    (root=$PWD; . tools/workspace.sh; .venv/bin/python examples/hull_shapes.py)
    (root=$PWD; . tools/workspace.sh; .venv/bin/python examples/hull_shapes.py solve)

The second way solves the flow of each at 0.5 m/s by OpenFOAM (a minute or two each, kept).
"""

import sys

from lta_config.constants import AIR_DENSITY, HELIUM_DENSITY
from lta_windtunnel.analytic import drag_force
from lta_windtunnel.flow_plan import TunnelFlow
from lta_windtunnel.openfoam.case import cache_folder
from lta_windtunnel.shape import ellipse_profile, mylar_profile, revolve_profile, Z_TURNED_TO
from lta_windtunnel.solve import solve_sweep, ThreadedFlowSolver
from lta_windtunnel.tunnel import build_steady_wind_case, PREVIEW
from lta_windtunnel.tunnel_model import TunnelModel
import plotly.graph_objects as go
from trimesh import Trimesh

AIR = (1.2, 1.5e-5)  # kg/m3, m2/s
SPEED = 0.5  # m/s
FOIL = 0.047  # kg/m2: GT-MAB's envelope, 116.8 g on 2.467 m2
DIAMETERS = (0.6, 0.7, 0.8, 0.9, 1.0, 1.1)  # m


def balloon(diameter: float) -> Trimesh:
    """Two discs of foil, joined at the rim (flies edge-on)."""
    return revolve_profile(mylar_profile(), diameter / 2, 0.599 * diameter)


def sphere(diameter: float) -> Trimesh:
    """Of gores: more seams, the least foil."""
    return revolve_profile(ellipse_profile(), diameter / 2, diameter)


def cigar(diameter: float) -> Trimesh:
    """Twice as long as thick, nose first; thinner than the sphere, for its volume."""
    mesh = revolve_profile(ellipse_profile(), 0.4 * diameter, 1.6 * diameter)
    return mesh.apply_transform(Z_TURNED_TO['x'])


def solved(model: TunnelModel) -> float:
    """Return the drag that the wind tunnel finds. [N]."""
    case = build_steady_wind_case(model, 'surge', AIR[1], PREVIEW, (SPEED,))
    flow = TunnelFlow('wind', 'surge', case, (SPEED,))
    crew = ThreadedFlowSolver(cache_folder(), 1, lambda *_: None)
    axes, _, refused, _ = solve_sweep(crew, model, [flow], AIR, print)
    return float('nan') if refused else -axes['surge'][0].force[0]


def by_hand(model: TunnelModel) -> float:
    """Return the drag that Hoerner's formula gives. [N]."""
    return drag_force(model, 0, SPEED, AIR)


found = []
for shape in (balloon, sphere, cigar):
    for diameter in DIAMETERS:
        model = TunnelModel(shape.__name__, {'envelope': shape(diameter)}, {}, {})
        lift = 0.93 * model.hull.volume * (AIR_DENSITY - HELIUM_DENSITY)  # 93 % pure
        carried = 1e3 * (lift - FOIL * model.hull.area)  # g
        braked = 1e3 * (solved if 'solve' in sys.argv else by_hand)(model)  # mN
        found.append((shape.__name__, diameter, carried, braked))

best = [
    each
    for each in found
    if each[2] > 0.0 and not any(o[2] >= each[2] and o[3] < each[3] for o in found)
]
print(f'shape    size [m]  carries [g]  drag at {SPEED} m/s [mN]')
for each in found:
    mark = ' *' if each in best else ''
    print(f'{each[0]:8s} {each[1]:8.1f} {each[2]:12.0f} {each[3]:12.1f}{mark}')
print('* nothing carries as much with less drag')

figure = go.Figure()
for name in ('balloon', 'sphere', 'cigar'):
    rows = [each for each in found if each[0] == name]
    figure.add_scatter(
        x=[each[2] for each in rows], y=[each[3] for each in rows], text=[e[1] for e in rows],
        name=name, mode='lines+markers+text', textposition='top left',
    )  # fmt: skip
front = sorted(best, key=lambda each: each[2])
figure.add_scatter(
    x=[each[2] for each in front], y=[each[3] for each in front], name='Pareto front',
    line={'dash': 'dot', 'shape': 'hv'},
)  # fmt: skip
figure.update_layout(
    title='Payload and drag of hulls, by diameter [m]',
    xaxis_title='carries [g]',
    yaxis_title=f'drag at {SPEED} m/s [mN]',
    template='plotly_white',
)
figure.write_html('hull_shapes.html', include_plotlyjs=True)

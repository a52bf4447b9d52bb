"""
Compare forward flight with the nose up against what the model flies.

Drag by axis and the moment of attached flow (Munk 1924) do not suffice: a real hull also lifts,
and loses a share of that moment. Both follow from flows at a known incidence, and are the effects
`oblique_lift` and `munk_moment` of a vehicle file.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model import mass_properties
from lta_windtunnel.aero_fit import fit_drag_by_axis
from lta_windtunnel.sweep_table import SweepPoint, TunnelSweep
from lta_windtunnel.tunnel import INCIDENCES


@final
@dataclass(frozen=True, slots=True)
class InclinedFlow:
    """Forces and moment at one incidence, each beside what the model flies."""

    incidence: float  # deg
    point: SweepPoint
    by_axis: tuple[float, float]  # drag by axis along body x and z [N]
    munk: float  # moment of attached flow about body y [N m]
    normal: float  # force along body z beyond the drag by axis [N]
    lift_slope: float  # of that force's coefficient, on the hull's shadow from above [1/rad]

    @property
    def lost(self) -> float:
        """Return the missing share of the Munk moment. [1]"""
        return 1.0 - self.point.moment[1] / self.munk


def compare_inclined_flows(sweep: TunnelSweep) -> list[InclinedFlow]:
    """Return the flows of a sweep with the nose up, by incidence; level flight has no moment."""
    fits = fit_drag_by_axis(sweep)
    along, _, upright, *_ = mass_properties.added_mass(
        load_vehicle_file(sweep.vehicle).hull, sweep.density
    )
    comparisons = []
    for name, point in sweep.inclined.items():
        angle = math.radians(INCIDENCES[name])
        c, s = math.cos(angle), math.sin(angle)
        forward, down = point.speed * c, point.speed * s
        by_axis = (-fits['surge'].drag_at(forward), fits['heave'].drag_at(down))
        normal = point.force[2] - by_axis[1]
        pressure = 0.5 * sweep.density * point.speed**2
        comparisons.append(
            InclinedFlow(
                INCIDENCES[name],
                point,
                by_axis,
                # -(v x A v) about y, for v = (forward, 0, -down)
                (along - upright) * forward * down,
                normal,
                normal / (pressure * sweep.frontal[2] * angle),
            )
        )
    return sorted(comparisons, key=lambda flow: flow.incidence)

"""Convert a layout to JSON, in SI units and on the plan's own axes."""

from typing import Any

from lta_studies.light.plan.gaps import find_gaps
from lta_studies.light.plan.handover import LampHandover
from lta_studies.light.plan.layout import LampLayout


def encode_layout(layout: LampLayout, handover: LampHandover) -> dict[str, Any]:
    """Return the JSON object of a layout."""
    floor, audible, count = layout.floor, layout.is_received, layout.received_count
    names = [lamp.name for lamp in layout.lamps]
    return {
        'plan': layout.plan.name,
        'vehicle': layout.ear.vehicle.file.name,
        'cell': floor.cell,
        'overlap': layout.overlap,
        'altitude': layout.plan.altitude.si,
        'floor_area': floor.area,
        'wanted_area': float(floor.target_cells.sum()) * floor.cell**2,
        'coverage': layout.coverage,
        'coverage_by_lamps': {
            # Share of the cells that receive at least k lamps
            str(k): float((count >= k).mean())
            for k in range(1, int(count.max(initial=0)) + 1)
        },
        'snr_needed': layout.ear.required_snr,
        'light_needed': layout.least,
        'lamps_at_least': layout.bound,
        'lamps_per_m2': len(names) / floor.area,
        'm2_per_lamp': floor.area / len(names) if names else None,
        'harmonics_clear_up_to': layout.order,
        'lamps': [
            {
                'name': lamp.name,
                'position': list(lamp.mount.position),
                'facing': list(lamp.mount.axis),
                'frequency': lamp.frequency,
                'there_already': bool(lamp.mount.name),
                'heard_area': float(audible[k].sum()) * floor.cell**2,
                'hands_over_to': [names[j] for i, j in handover.edges if i == k],
            }
            for k, lamp in enumerate(layout.lamps)
        ],
        'route': [names[k] for k in handover.route],
        'gaps': [gap._asdict() for gap in find_gaps(layout)],
    }

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute light and SNR of each lamp over each cell.

Light, diodes, amplifier, ADC and demodulation are those of the simulator (`lta_sim.light_link`).
"""

from collections.abc import Sequence
import math
from typing import Final

from lta_config.compilation.compiler import compile_functions
from lta_model.light.direct_light import build_beam, DiodeResponse
from lta_model.light.field import LightField
from lta_model.light.lamp import BeaconLamp, SquareWave
from lta_model.light.reflected_light import LAMP_ROWS, scratch_size, UNIFORM_ROW
from lta_model.mass_properties import half_axes
from lta_report.json_value import ExactArray
from lta_report.study_store import StoreFormat
from lta_sim.light_link import build_light_link, expected_magnitude, LightLink, write_ring_light
from lta_studies.light.plan.floor import Array, FloorGrid, FloorPlan, LampMount, Mask, Vector
from lta_studies.light.plan.frequencies import LOWEST_FLICKER
from lta_studies.light.plan.joint_snr import (
    compute_crosstalk,
    compute_joint_snr,
    is_saturated,
    LightReceiver,
    Numbers,
)
from lta_studies.light.plan.rays import compute_cell_light
import numpy as np
from pydantic import TypeAdapter

BELOW_SATURATION = 1.0 - 1e-9  # just below saturation of the ADC
HEADING_COUNT = 64  # per full turn, 5.6 degrees apart
GROUP = 64  # lamps whose light one worker computes at a time
LIGHT_STORE: Final[StoreFormat[Array]] = StoreFormat(
    'light.jsonl', 'plan', 'plan of lamps', TypeAdapter(ExactArray)
)


def build_light_field(plan: FloorPlan, mount: LampMount, frequency: float) -> LightField:
    """Return the light field of one lamp with the ambient light, without reflections."""
    lamp = plan.lamp
    return LightField(
        lamps=(
            BeaconLamp(
                position=mount.position,
                axis=mount.axis,
                flux=lamp.flux.si,
                wave=SquareWave(frequency, lamp.duty.si),
                efficacy=lamp.efficacy.si,
                order=lamp.lambertian_order,
            ),
        ),
        ambient=plan.ambient.ambient,
    )


def build_lamp_link(
    plan: FloorPlan, ear: LightReceiver, mount: LampMount, frequency: float
) -> LightLink:
    """Return the light link of a lamp at a frequency [Hz]."""
    field = build_light_field(plan, mount, frequency)
    return build_light_link(
        field,
        ear.vehicle.diodes,
        half_axes(ear.vehicle.file.hull),
        ear.demodulation.model_copy(update={'frequency': frequency}),
        ear.light.sample_rate.si,
        ear.light.samples,
    )


def pack_common_parameters(reception: LightLink) -> Numbers:
    """Return the numbers common to all lamps, as in `diode_snr`."""
    (signal,) = reception.signals
    return (
        signal.counts, reception.dark, reception.steady, reception.top, reception.variance,
        reception.shot, reception.shot * signal.duty, reception.samples,
    )  # fmt: skip


def single_lamp_snr(reception: LightLink, share: float, light: float) -> float:
    """
    Return the SNR of a single lamp on a diode.

    `reception`: light link of the lamp. `share`: share of isotropic ambient light that the diode
    reads. `light`: light of the lamp on the diode [lx].
    """
    (signal,) = reception.signals
    own, steady = signal.counts * light, share * reception.steady
    if is_saturated(own, share, pack_common_parameters(reception)):
        return 0.0
    swing, quiet, _ = expected_magnitude(reception, signal, own, steady)
    return swing / (quiet + reception.hum * share)


def solve_required_light(reception: LightLink, share: float, needed: float) -> float:
    """Return the light at which the SNR reaches `needed`, by bisection; inf if never [lx]."""
    low, high = (
        0.0,
        max(reception.top - reception.dark - share * reception.steady, 0.0)
        / reception.signals[0].counts
        * BELOW_SATURATION,
    )
    # Not received even just below saturation
    if single_lamp_snr(reception, share, high) < needed:
        return math.inf
    # 60 halvings exhaust double precision.
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (
            (low, middle)
            if single_lamp_snr(reception, share, middle) >= needed
            else (middle, high)
        )
    return high


def compute_lamp_light(
    plan: FloorPlan,
    ear: LightReceiver,
    floor: FloorGrid,
    mounts: Sequence[LampMount],
    faintest: float,
) -> Array:
    """
    Compute the light of every lamp over every wanted cell.

    `plan`, `ear`, `floor`, `mounts`: hall, receiver, cells and positions of lamps. `faintest`:
    light below which a lamp is ignored [lx]. The result has shape (lamps, 2, cells): light on the
    brightest diode at the worst and the best heading [lx].
    """
    (kernel,) = compile_functions(compute_cell_light)
    cells, planes, hull = _prepare_cells(plan, ear, floor)
    headings, eye = choose_headings(planes, hull), _build_diode_response(ear)
    light = np.zeros((len(mounts), 2, len(cells)))
    for k, mount in enumerate(mounts):
        # The geometry of the beam does not depend on its frequency (1 Hz here).
        lamp = build_beam(build_light_field(plan, mount, 1.0).first_lamp)
        kernel(lamp, eye, cells, floor.walls, planes, hull, headings, faintest, light[k])
    return light


def compute_group_light(
    plan: FloorPlan, ear: LightReceiver, floor: FloorGrid, mounts: Sequence[LampMount],
    faintest: float, begin: int,
) -> Array:  # fmt: skip
    """Compute the light of one group of lamps, from a place in their list on."""
    return compute_lamp_light(plan, ear, floor, mounts[begin : begin + GROUP], faintest)


def compute_simultaneous_snr(
    plan: FloorPlan, ear: LightReceiver, floor: FloorGrid, mounts: Sequence[LampMount],
    tones: Sequence[float], visible: Mask,
) -> Array:  # fmt: skip
    """
    Compute the SNR of each lamp over every wanted cell while all lamps are on.

    `plan`, `ear`, `floor`, `mounts`: hall, receiver, cells and lamps. `tones`: frequencies of the
    lamps [Hz]. `visible`, shape (lamps, cells): where no wall hides a lamp.
    """
    (kernel,) = compile_functions(compute_joint_snr)
    cells, planes, hull = _prepare_cells(plan, ear, floor)
    links = [build_lamp_link(plan, ear, *pair) for pair in zip(mounts, tones, strict=True)]
    window, quiet = compute_crosstalk(ear, tones, plan.lamp.duty.si)
    snr = np.empty(visible.shape)
    kernel(
        np.array([each.lamps[0] for each in links]), _build_diode_response(ear),
        np.ascontiguousarray(visible.T),
        cells, planes, hull, choose_headings(planes, hull), pack_common_parameters(links[0]),
        np.array([(link.signals[0].gain, link.signals[0].leak, link.hum) for link in links]),
        window, quiet,
        np.empty((len(links), len(planes))), snr,
    )  # fmt: skip
    return snr


def _build_diode_response(ear: LightReceiver) -> DiodeResponse:
    return DiodeResponse(ear.vehicle.diodes.response, ear.vehicle.diodes.edge_cosine)


def ambient_shares(plan: FloorPlan, ear: LightReceiver) -> Array:
    """Return each diode's share of isotropic ambient light, shape (diodes,) [1]."""
    # The shares of ambient light do not depend on the lamp, so any lamp will do.
    nowhere = LampMount((0.0, 0.0, plan.lamp.height.si), (1.0, 0.0, 0.0))
    link = build_lamp_link(plan, ear, nowhere, LOWEST_FLICKER)
    out = np.empty((LAMP_ROWS + 1, len(link.planes)))
    scratch = np.empty(scratch_size(1))
    write_ring_light(link, (0.0, 0.0, plan.altitude.si), (0.0, 0.0, 0.0, 1.0), out, scratch)
    return np.asarray(out[UNIFORM_ROW])


def _prepare_cells(
    plan: FloorPlan, ear: LightReceiver, floor: FloorGrid
) -> tuple[Array, Array, Vector]:
    """Return hull centres over the wanted cells, diode planes and hull half axes."""
    centres = floor.cell_centers
    cells = np.hstack([centres, np.full((len(centres), 1), plan.altitude.si)])
    diodes = ear.vehicle.diodes
    # Columns: position (0 to 2), axis (3 to 5), gain (6), share of ambient light (7)
    planes = np.column_stack([diodes.planes, diodes.diode_gains, ambient_shares(plan, ear)])
    return cells, planes, half_axes(ear.vehicle.file.hull)


def choose_headings(planes: Array, hull: Vector) -> Array:
    """Return cosine and sine of the headings; one diode spacing suffices if symmetric."""
    turn = 2.0 * math.pi / len(planes)
    cosine, sine = math.cos(turn), math.sin(turn)
    # Turn the ring by one spacing: if each diode lands on the next, it is symmetric.
    turned = planes.copy()
    rotation = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    turned[:, :3], turned[:, 3:6] = planes[:, :3] @ rotation, planes[:, 3:6] @ rotation
    alike = hull[0] == hull[1] and np.allclose(np.roll(turned, 1, axis=0), planes, atol=1e-9)
    count, span = (
        (max(HEADING_COUNT // len(planes), 4), turn) if alike else (HEADING_COUNT, 2.0 * math.pi)
    )
    angles = np.arange(count) * (span / count)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)

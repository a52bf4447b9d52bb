"""lta cfd run: the wind tunnel of one vehicle, from its shape to its aero file."""

from enum import StrEnum
from pathlib import Path
import sys
from typing import Annotated

from lta_cli.options.out_option import Out
from lta_cli.options.pictures_option import can_be_taken, Pictures
from lta_cli.options.plain_console import plain_console
from lta_config.errors import unknown
from lta_config.schema.mount_file import load_mount
from lta_config.schema.tunnel_file import load_tunnel_file
from lta_config.typed import near, typed
from lta_report.results_folder import all_at_once, can_be_made, page_line, results_folder
from lta_report.screenshots import write_pictures
from lta_sim.cfd.aero_text import aero_text
from lta_sim.cfd.model import Model, model_of
from lta_sim.cfd.openfoam.engine import Programs
from lta_sim.cfd.openfoam.stage import Stages
from lta_sim.cfd.plan import Air, Flow, flows
from lta_sim.cfd.slices import Slice, slice_of
from lta_sim.cfd.solve import solve, sweep_of
from lta_sim.cfd.sweep_table import Sweep, sweep_text, without_maps
from lta_studies.cfd.crews import Cache, can_solve, crew_for, folder_of, Jobs, Scheduler
from lta_studies.cfd.page import title, write_page
from lta_studies.cfd.progress import TunnelProgress
from lta_studies.cfd.tables import coefficients, patterns
from lta_studies.energy.tables import show
import typer

AIR: Air = (1.2, 1.5e-5)  # kg/m3, m2/s: 20 degC
SHOWN = ('heave', 'surge', 'up_left', 'both_up', 'all', 'up_left_reversed', 'forward_left')


class Fidelity(StrEnum):
    """How much a number costs, and how good it is."""

    analytic = 'analytic'
    preview = 'preview'
    reference = 'reference'


def run(
    name: Annotated[
        str, typer.Argument(metavar='TUNNEL', help='A shipped tunnel file, or a file.')
    ] = 'gtmab',
    fidelity: Annotated[
        Fidelity, typer.Option(help='By hand, steady, or transient.')
    ] = Fidelity.preview,
    only: Annotated[
        list[str] | None, typer.Option(help='Axes and patterns alone; repeatable.')
    ] = None,
    mount: Annotated[
        str | None, typer.Option(help='Solar panels as a mount file has them: side, bottom, top.')
    ] = None,
    jobs: Jobs = None,
    cache: Cache = None,
    scheduler: Scheduler = None,
    limit: Annotated[
        float | None,
        typer.Option('--memory', help='Memory there is in GB; all of it by default.', min=0.1),
    ] = None,
    out: Out = None,
    pictures: Pictures = None,
    json: Annotated[bool, typer.Option('--json', help='Print the sweep as JSON.')] = False,
) -> None:
    """
    Put a vehicle into the wind tunnel: drag along and about six axes, and its rotors on.

    A tunnel file in config/tunnels says what stands in it: hull and rotors of a vehicle file, the
    bodies below, or STL files. Flows are solved by OpenFOAM, side by side, each once: what is
    solved is kept and a run that was stopped goes on. --fidelity analytic needs no OpenFOAM;
    preview is steady, minutes; reference transient, an hour.

    The results are a page; NAME.sweep.json, all that was solved; NAME.aero.yaml, fitted, which a
    vehicle file can name ("aero: PATH"); and, where rotors blew, NAME.blown.json, the sweep with
    maps of the pressure.

    Exit status 0: done, and what was refused is said. 1: nothing could be solved. 2: bad input.
    130: Ctrl-C.

    Example: lta cfd run gtmab --only heave --only both_up
    """
    console = plain_console(stderr=json)
    can_be_taken(pictures)
    file, _ = load_tunnel_file(name)
    model = model_of(name, load_mount(mount) if mount else None)
    target = results_folder(out, f'{model.name}-cfd')
    can_be_made(target)
    wanted: list[Flow] = []
    if fidelity is not Fidelity.analytic:
        can_solve(jobs, scheduler)
        known = flows(model, fidelity, AIR)
        if strangers := [each for each in only or () if each not in {f.about for f in known}]:
            raise unknown('axis or pattern', strangers[0], [f.about for f in known])
        wanted = flows(model, fidelity, AIR, only or ())
    if wanted:
        with (
            TunnelProgress(console, wanted) as bar,
            crew_for(wanted, bar, jobs, cache, scheduler, limit) as crew,
        ):
            found = solve(crew, model, wanted, AIR, bar.say)
            sweep = sweep_of(model, file.vehicle, fidelity, AIR, *found, engine=crew.engine())
    else:
        sweep = sweep_of(model, file.vehicle, fidelity, AIR, {}, {}, {})
    words = ['cfd', 'run', name, '--fidelity', fidelity.value]
    words += [word for each in only or () for word in ('--only', each)]
    words += ['--mount', mount] if mount else []
    with all_at_once(target, 'report.html') as part:
        small = sweep_text(without_maps(sweep))
        (part / f'{model.name}.sweep.json').write_text(small, encoding='utf-8')
        if sweep.blows:
            (part / f'{model.name}.blown.json').write_text(sweep_text(sweep), encoding='utf-8')
        (part / f'{model.name}.aero.yaml').write_text(aero_text(sweep), encoding='utf-8')
        drawn = pictured(model, sweep, wanted, folder_of(cache))
        write_page(sweep, drawn, {'Solve it again': typed(*words)}, part / 'report.html')
    if pictures is not None:
        write_pictures(target / 'report.html', pictures)
    if json:
        sys.stdout.write(small)
    show(coefficients(sweep), console)
    if sweep.blows:
        show(patterns(sweep), console)
    lines = [title(sweep), page_line(near(target / 'report.html'))]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
    if wanted and not sweep.axes and not sweep.blows:
        raise typer.Exit(1)


def pictured(model: Model, sweep: Sweep, wanted: list[Flow], folder: Path) -> list[Slice]:
    """Return the planes through the flows that tell most."""
    stages = Stages(folder, Programs(), lambda *_: None)
    found: list[Slice] = []
    for flow in sorted(wanted, key=lambda each: each.about not in SHOWN):
        there = flow.about in sweep.blows or flow.about in sweep.axes
        if there and len(found) < len(SHOWN) and flow.kind in ('wind', 'blow'):
            piece = slice_of(model, flow, stages.place(flow.case))
            found += [piece] if piece is not None else []
    return found

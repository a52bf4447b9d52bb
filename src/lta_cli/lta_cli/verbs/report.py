"""lta report: write the page of a recorded flight."""

from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_analysis.door import check_picture_output
from lta_cli.options.common_options import folder_option, Pictures, RobotOption
from lta_config.errors import BadInput
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.reader import read_bag
from lta_data.bag.recorded_flight import select_robot
from lta_flight.report.page import write_page
from lta_report.browser import find_chromium
from lta_report.flight_video import check_video_output, write_video
from lta_report.results_folder import stage_results
from lta_report.screenshots import write_pictures
import typer


def report(
    bag: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    out: Annotated[
        Path | None,
        folder_option('Folder of report.html or report-ROBOT.html; that of the bag by default.'),
    ] = None,
    robot: RobotOption = None,
    pictures: Pictures = None,
    video: Annotated[
        Path | None,
        typer.Option(
            help='Film the 3-D view: MP4 or GIF file to write; needs Chromium and ffmpeg.',
            metavar='FILE',
        ),
    ] = None,
) -> None:
    """
    Write the page of a recorded flight, and with --pictures and --video its figures and a film.

    Example: lta report runs/20261120-lamp_room-1/bag --pictures thesis/figures

    Example: lta report runs/20261120-lamp_room-1/bag --video flight.mp4

    Example: lta report fleet/bag --robot lta2
    """
    bag = find_bag(bag)
    stored = read_bag(bag)
    select_robot(stored, robot)  # raises BadInput before any folder is created
    if next(stored.iterate_messages(), None) is None:
        raise BadInput(f"'{bag}' contains no message to report on; choose another bag.")
    # Several robots of a bag must not overwrite each other's page
    name = 'report.html' if robot is None else f'report-{robot}.html'
    folder = (out or bag.absolute().parent).absolute()
    check_picture_output(pictures)
    if video is not None:
        find_chromium()
        check_video_output(video)
    with stage_results(folder, name) as part:
        write_page(bag, part / name, robot)
    page = folder / name
    console = plain_console()
    console.print(f'Page {page}', highlight=False, soft_wrap=True)
    if pictures is not None:
        for picture in write_pictures(page, pictures):
            console.print(f'Picture {picture}', highlight=False, soft_wrap=True)
    if video is not None:
        write_video(page, video)
        console.print(f'Video {video}', highlight=False, soft_wrap=True)

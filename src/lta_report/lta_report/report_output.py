"""Write a report to its results folder: JSON, further files, page and pictures."""

from pathlib import Path
from typing import Final

from lta_report.page_frame import write_file
from lta_report.report import Report
from lta_report.report_page import render_report
from lta_report.results_folder import write_json
from lta_report.screenshots import write_pictures

PAGE: Final = 'report.html'


def write_report(
    report: Report, folder: Path, *, page: bool = True, pictures: Path | None = None
) -> Path | None:
    """
    Write the results of a study, and return the path of its page.

    `folder`: results folder, which exists. `page`: whether to write the page. `pictures`: folder
    for a PNG of each figure; needs Chromium, and the page. Raise `BadInput` if writing fails.
    """
    name = report.json_name or f'{report.command.split()[-1]}.json'
    write_json(report.data, folder / name)
    for other, text in report.outputs.items():
        write_file(text, folder / other)
    if not page:
        return None
    written = write_file(render_report(report), folder / PAGE)
    if pictures is not None:
        write_pictures(written, pictures)
    return written

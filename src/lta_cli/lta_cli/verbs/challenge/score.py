"""lta challenge score: score discovery on flights with hidden effects."""

from pathlib import Path
from typing import Annotated

from lta_challenge.report import build_report, format_markdown_page
from lta_challenge.score import ChallengeScore, score_challenge
from lta_cli.options.common_options import (
    check_picture_output,
    Json,
    parse_folder,
    Pictures,
    plain_console,
    print_json,
    RetryFailed,
    WorkerCount,
)
from lta_cli.options.study_command import Page, show_report, StudyRun
from lta_config.errors import BadInput
from lta_report.page_frame import write_file
from lta_report.report_output import PAGE, write_report
from lta_report.study import StudyOptions
import typer


def score(
    folders: Annotated[
        list[Path],
        typer.Argument(
            help='Folders written by "lta challenge make"; scores and an HTML report are written '
            'into each.'
        ),
    ],
    most: Annotated[
        int | None, typer.Option(help='Maximum number of cases to score; all by default.', min=1)
    ] = None,
    markdown: Annotated[
        Path | None,
        typer.Option(
            help='Also write all scores to this Markdown file.',
            parser=parse_folder,
            metavar='FILE',
        ),
    ] = None,
    workers: WorkerCount = None,
    retry: RetryFailed = False,
    page: Page = True,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Run discovery on the cases of challenges, then compare its results with the answers.

    An interrupted run resumes; a change of an effect or of the vehicle file starts again. Counts
    exact and wrong names, missed effects, "unexplained" verdicts and intervals that contain the
    truth. Compares held-out errors with those of an oracle that knows which effect was hidden but
    not its size. Effects that such data cannot distinguish count as one
    (docs/discovery_classes.md).

    Exit status 0: scored, whatever the score. 2: bad input.

    Example: lta challenge score hidden
    """
    # Otherwise the cases would count twice in the summary
    if len({place.resolve() for place in folders}) < len(folders):
        raise BadInput('The same challenge folder is given twice; give each folder only once.')
    if pictures is not None and (len(folders) > 1 or not page):
        raise BadInput('--pictures needs one challenge folder and its page; remove the others.')
    check_picture_output(pictures)
    console = plain_console(stderr=json)
    done: list[ChallengeScore] = []
    results: list[object] = []
    for place in folders:
        scored = score_challenge(place, StudyOptions(workers, retry_failed=retry), console, most)
        report = build_report(scored, place)
        write_report(report, place, page=page, pictures=pictures)
        show_report(report, StudyRun(console, place.absolute(), None, page), False)
        done.append(scored)
        content = dict(report.data)
        results.append(content | ({'page': str(place.absolute() / PAGE)} if page else {}))
        if markdown is not None:
            # Write after each challenge: many challenges take hours.
            write_file(format_markdown_page(done), markdown)
    if json:
        # One document, also for several folders
        print_json(results[0] if len(results) == 1 else results)

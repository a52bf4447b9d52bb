"""lta challenge score: score discovery on flights with hidden effects."""

from pathlib import Path
from typing import Annotated

from lta_challenge.report import build_report, format_markdown_page
from lta_challenge.score import score_challenge
from lta_cli.options.common_options import parse_folder
from lta_cli.options.study_command import study_command, StudyRun
from lta_config.errors import BadInput
from lta_report.page_frame import write_file
from lta_report.report import Report
from lta_report.results_folder import resolve_folder
import typer


@study_command('challenge-score', quick={'most': 3})
def score(
    folders: Annotated[
        list[Path], typer.Argument(help='Folders written by "lta challenge make".')
    ],
    most: Annotated[
        int | None,
        typer.Option(help='Maximum number of cases of each challenge; all by default.', min=1),
    ] = None,
    markdown: Annotated[
        Path | None,
        typer.Option(
            help='Also write all scores to this Markdown file.',
            parser=parse_folder,
            metavar='FILE',
        ),
    ] = None,
    *,
    run: StudyRun,
) -> Report:
    """
    Run discovery on the cases of challenges, then compare its results with the answers.

    Scores and page are about all cases together, and go into the challenge, or into a folder of
    their own if there are several. Finished cases are stored in their challenge, so an interrupted
    run resumes; a change of an effect or of the vehicle file starts again. With --scheduler, all
    machines must share the challenges.

    Counts exact and wrong names, missed effects, "unexplained" verdicts and intervals that contain
    the truth. Compares held-out errors with those of an oracle that knows which effect was hidden
    but not its size. Effects that such data cannot distinguish count as one
    (docs/discovery_classes.md).

    Exit status 0: scored, whatever the score. 2: bad input. 130: Ctrl-C.

    Example: lta challenge score runs/hidden
    """
    places = [place.absolute() for place in folders]
    # Otherwise the cases would count twice in the summary
    if len({place.resolve() for place in places}) < len(places):
        raise BadInput('The same challenge folder is given twice; give each folder only once.')
    run.open_folder(places[0] if len(places) == 1 else resolve_folder(None, 'challenge-score'))
    done = []
    for place in places:
        done.append(score_challenge(place, run.options, run.console, most))
        if markdown is not None:
            # Write after each challenge: many challenges take hours.
            write_file(format_markdown_page(done), markdown)
    return build_report(done, places)

"""Turn a function that returns a report into a command with the output options of all studies."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import wraps
import inspect
from pathlib import Path
from typing import Annotated, Any, Final, final, get_type_hints

from lta_bridge.provenance import read_commit
from lta_cli.app import WORDS
from lta_cli.options.common_options import (
    check_picture_output,
    Json,
    Out,
    Pictures,
    plain_console,
    print_json,
    ResumedOut,
)
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_report.report import Report
from lta_report.report_output import PAGE, write_report
from lta_report.report_terminal import print_report
from lta_report.results_folder import (
    check_creatable,
    format_page_line,
    resolve_folder,
    stage_results,
)
from rich.console import Console
import typer

Page = Annotated[bool, typer.Option('--page/--no-page', help='Write an HTML report.')]
OPTIONS = {'out': Out, 'page': Page, 'pictures': Pictures, 'json': Json}
QUICK = 'quick'
FLAGS = ('--json', '--page', '--no-page')
FOLDERS = ('--out', '--pictures')
DEFAULTS = {QUICK: False, 'out': None, 'page': True, 'pictures': None, 'json': False}
NOTHING: Final[Mapping[str, object]] = {}


@final
@dataclass(slots=True)
class StudyRun:
    """What a study gets from its command, as the argument `run`."""

    console: Console  # for progress; it writes to stderr if the results are printed as JSON
    # Results folder, absolute. A study that resumes or names it calls `open_folder`.
    folder: Path
    out: Path | None  # the folder that the user has chosen
    page: bool  # whether a page is written; a study may then skip what only the page shows

    def open_folder(self, default: Path) -> Path:
        """Set and return the results folder: the user's, or a default one."""
        self.folder = (self.out or default).absolute()
        return self.folder


def study_command(
    name: str, *, resumes: bool = False, quick: Mapping[str, object] = NOTHING
) -> Callable[[Callable[..., Report]], Callable[..., None]]:
    """
    Give a function that returns a report the options --out, --no-page, --pictures and --json.

    The function may have an argument `run`, a `StudyRun`. Nothing is written before it returns,
    unless it resumes.

    `name`: name of the results folder, runs/<time>-<name>. `resumes`: whether the study stores
    finished work in its folder, which may therefore exist. `quick`: options of the study that
    --quick sets, unless the user gives them. Without any, the command has no --quick.
    """

    def decorate(study: Callable[..., Report]) -> Callable[..., None]:
        signature = inspect.signature(study)
        added = {**OPTIONS, 'out': ResumedOut} if resumes else dict(OPTIONS)
        if quick:
            added = {QUICK: build_quick_option(quick), **added}

        @wraps(study)
        def command(
            context: typer.Context,
            *args: Any,  # noqa: ANN401 - the study's own options
            out: Path | None,
            page: bool,
            pictures: Path | None,
            json: bool,
            **options: Any,  # noqa: ANN401
        ) -> None:
            if pictures is not None and not page:
                raise BadInput('--pictures needs the page; remove --no-page.')
            run = StudyRun(plain_console(stderr=json), resolve_folder(out, name), out, page)
            check_picture_output(pictures)
            if not resumes:
                check_creatable(run.folder)
            own = {'run': run} if 'run' in signature.parameters else {}
            if quick and options.pop(QUICK):
                options |= {key: value for key, value in quick.items() if is_unset(context, key)}
            words = context.meta.get(WORDS, ())
            try:
                report = study(*args, **own, **options)
            except KeyboardInterrupt:
                if resumes:
                    show_resume_command(words, run)
                raise
            report = add_origin(report, words, run.folder if resumes else None)
            with nullcontext(run.folder) if resumes else stage_results(run.folder, PAGE) as folder:
                write_report(report, folder, page=page, pictures=pictures)
            show_report(report, run, json)
            if report.status:
                raise typer.Exit(report.status)

        hints = {
            'context': typer.Context, **get_type_hints(study, include_extras=True), **added,
            'return': None,
        }  # fmt: skip
        hints.pop('run', None)
        command.__annotations__ = hints
        command.__signature__ = add_options(signature, added)  # type: ignore[attr-defined]
        # Typer would otherwise read the annotations of the study
        del command.__wrapped__
        return command

    return decorate


def build_quick_option(quick: Mapping[str, object]) -> object:
    """Return the declaration of --quick, whose help names the options that it sets."""
    parts = ' '.join(f'--{name} {value}' for name, value in quick.items())
    return Annotated[bool, typer.Option(f'--{QUICK}', help=f'The same as {parts}.')]


def is_unset(context: typer.Context, name: str) -> bool:
    """Return whether the command line leaves an option at its default."""
    source = context.get_parameter_source(name)
    return source is None or source.name == 'DEFAULT'


def add_options(signature: inspect.Signature, options: Mapping[str, object]) -> inspect.Signature:
    """Return a signature with the context and the output options instead of `run`."""
    first = inspect.Parameter(
        'context', inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=typer.Context
    )
    own = [each for each in signature.parameters.values() if each.name != 'run']
    added = [
        inspect.Parameter(
            name, inspect.Parameter.KEYWORD_ONLY, default=DEFAULTS[name], annotation=kind
        )
        for name, kind in options.items()
    ]
    return signature.replace(parameters=[first, *own, *added], return_annotation=None)


def add_origin(report: Report, words: Sequence[str], folder: Path | None) -> Report:
    """
    Add the commit to the facts of a report, and the command that repeats it to the commands.

    `words` are those of the command line. A study that resumes continues in its `folder`.
    """
    kept = drop_output_options(words)
    if folder is not None:
        kept += ['--out', str(relative_path(folder))]
    name = 'Repeat this study' if folder is None else 'Resume or repeat this study'
    commands = {name: format_lta_command(*kept)} if words else {}
    return replace(
        report,
        facts={**report.facts, 'commit': read_commit()},
        commands={**commands, **report.commands},
    )


def show_resume_command(words: Sequence[str], run: StudyRun) -> None:
    """Print how to resume a study that was stopped, if it has stored anything."""
    if words and run.folder.is_dir():
        # The default folder contains the time, so the same command would start again
        command = format_lta_command(
            *drop_output_options(words), '--out', relative_path(run.folder)
        )
        run.console.print(
            f'Finished work is stored; resume with: {command}',
            highlight=False, markup=False, soft_wrap=True,
        )  # fmt: skip


def drop_output_options(words: Sequence[str]) -> list[str]:
    """Return the words of a command line without those that say where results go."""
    kept, skip = list[str](), False
    for word in words:
        name = word.split('=')[0]
        if skip or name in FLAGS or name in FOLDERS:
            # The folder is the next word, unless it follows an equals sign
            skip = not skip and word in FOLDERS
            continue
        kept.append(word)
    return kept


def show_report(report: Report, run: StudyRun, json: bool) -> None:
    """Print a report and the path of its page."""
    page = run.folder / PAGE if run.page else None
    if json:
        print_json(report.data, page)
    print_report(report, run.console)
    if page is not None:
        run.console.print(
            format_page_line(relative_path(page)), highlight=False, markup=False, soft_wrap=True
        )

"""Turn a function that returns a report into a command; all studies have the same options."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from functools import partial, wraps
import inspect
from itertools import chain
from pathlib import Path
import shlex
from typing import Annotated, Any, Final, final, get_type_hints, TypeVar

from lta_bridge.provenance import read_commit
from lta_cli.app import WORDS
from lta_cli.options.common_options import (
    check_picture_output,
    Json,
    Out,
    Pictures,
    plain_console,
    print_json,
    RetryFailed,
    Scheduler,
    WorkerCount,
)
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_report.report import Report
from lta_report.report_output import PAGE, write_report
from lta_report.report_terminal import print_report
from lta_report.results_folder import (
    check_creatable,
    create_folder,
    format_page_line,
    resolve_folder,
    stage_results,
)
from lta_report.study import Study, StudyOptions
from rich.console import Console
import typer

Item = TypeVar('Item')
Result = TypeVar('Result')

Page = Annotated[bool, typer.Option('--page/--no-page', help='Write an HTML report.')]
OUTPUT: Final[Mapping[str, object]] = {
    'out': Out, 'page': Page, 'pictures': Pictures, 'json': Json,
}  # fmt: skip
COMPUTING: Final[Mapping[str, object]] = {
    'workers': WorkerCount, 'scheduler': Scheduler, 'retry_failed': RetryFailed,
}  # fmt: skip
QUICK: Final = 'quick'
FLAGS = ('--json', '--page', '--no-page')
FOLDERS = ('--out', '--pictures')
DEFAULTS = {'out': None, 'page': True, 'pictures': None, 'workers': None, 'scheduler': None}


@final
@dataclass(slots=True)
class StudyRun:
    """What a study gets from its command, as the argument `run`."""

    console: Console  # for progress; it writes to stderr if the results are printed as JSON
    # Results folder, absolute. A study that resumes or names it calls `open_folder`.
    folder: Path
    out: Path | None  # the folder that the user has chosen
    page: bool  # whether a page is written; a study may then skip what only the page shows
    options: StudyOptions = field(default_factory=StudyOptions)
    quick: bool = False

    def open_folder(self, default: Path) -> Path:
        """Set and return the results folder: the user's, or a default one."""
        self.folder = (self.out or default).absolute()
        return self.folder

    def run_study(
        self, study: Study[Item, Result], identity: str, items: Sequence[Item]
    ) -> list[Result]:
        """Run the items of a study that its folder does not hold, and return all results."""
        return study.run(items, self.folder, identity, self.options, self.console).require_all()


def report_command(name: str) -> Callable[[Callable[..., Report]], Callable[..., None]]:
    """
    Give a function that returns a report the options --out, --no-page, --pictures and --json.

    The function may have an argument `run`, a `StudyRun`. Nothing is written before it returns.
    `name`: name of the results folder, runs/<time>-<name>.
    """
    return partial(build_command, name, OUTPUT, {}, False)


def study_command(
    name: str, *, quick: str | Mapping[str, object], resumes: bool = True
) -> Callable[[Callable[..., Report]], Callable[..., None]]:
    """
    Like `report_command`, with the options --quick, --workers, --scheduler and --retry-failed.

    `quick`: options of the study that --quick sets, unless the user gives them, or the help of a
    --quick that the study reads from `run`. `resumes`: whether the study stores finished work in
    its folder, which may therefore exist.
    """
    options = {QUICK: build_quick_option(quick), **COMPUTING, **OUTPUT}
    preset = {} if isinstance(quick, str) else quick
    return partial(build_command, name, options, preset, resumes)


def build_command(
    name: str,
    added: Mapping[str, object],
    preset: Mapping[str, object],
    resumes: bool,
    study: Callable[..., Report],
) -> Callable[..., None]:
    """Return the command of a study, with some options added, and some preset by --quick."""
    signature = inspect.signature(study)

    @wraps(study)
    def command(
        context: typer.Context,
        *args: Any,  # noqa: ANN401 - the study's own options
        out: Path | None,
        page: bool,
        pictures: Path | None,
        json: bool,
        quick: bool = False,
        workers: int | None = None,
        scheduler: str | None = None,
        retry_failed: bool = False,
        **options: Any,  # noqa: ANN401
    ) -> None:
        if pictures is not None and not page:
            raise BadInput('--pictures needs the page; remove --no-page.')
        run = StudyRun(
            plain_console(stderr=json), resolve_folder(out, name), out, page,
            StudyOptions(workers, scheduler, retry_failed), quick,
        )  # fmt: skip
        check_picture_output(pictures)
        if not resumes:
            check_creatable(run.folder)
        own = {'run': run} if 'run' in signature.parameters else {}
        if quick:
            options |= {key: value for key, value in preset.items() if is_unset(context, key)}
        words = context.meta.get(WORDS, ())
        try:
            report = study(*args, **own, **options)
        except KeyboardInterrupt:
            if resumes:
                show_resume_command(words, run)
            raise
        publish_report(report, run, words, json=json, pictures=pictures, resumes=resumes)

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


def publish_report(
    report: Report,
    run: StudyRun,
    words: Sequence[str],
    *,
    json: bool,
    pictures: Path | None = None,
    resumes: bool = False,
) -> None:
    """
    Write a report to the folder of its run, print it, and exit with its status unless that is 0.

    `words` are those of the command line. `resumes`: whether the folder holds finished work.
    """
    report = add_origin(report, words, run.folder if resumes else None)
    if resumes:
        # A study may store its finished work elsewhere
        create_folder(run.folder)
    with nullcontext(run.folder) if resumes else stage_results(run.folder, PAGE) as folder:
        write_report(report, folder, page=run.page, pictures=pictures)
    show_report(report, run, json)
    if report.status:
        raise typer.Exit(report.status)


def build_quick_option(quick: str | Mapping[str, object]) -> object:
    """Return the declaration of --quick, whose help names the options that it sets."""
    if not isinstance(quick, str):
        words = [(f'--{name}', str(value)) for name, value in quick.items()]
        quick = f'The same as {shlex.join(chain(*words))}.'
    return Annotated[bool, typer.Option(f'--{QUICK}', help=quick)]


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
    only = inspect.Parameter.KEYWORD_ONLY
    added = [
        inspect.Parameter(name, only, default=DEFAULTS.get(name, False), annotation=kind)
        for name, kind in options.items()
    ]
    return signature.replace(parameters=[first, *own, *added], return_annotation=None)


def add_origin(report: Report, words: Sequence[str], folder: Path | None) -> Report:
    """
    Add the commit to the facts of a report, and the command that repeats it to the commands.

    `words` are those of the command line. A study that resumes continues in its `folder`.
    """
    arguments = drop_output_options(words)
    if folder is not None:
        arguments += ['--out', str(relative_path(folder))]
    name = 'Repeat this study' if folder is None else 'Resume or repeat this study'
    commands = {name: format_lta_command(*arguments)} if words else {}
    return replace(
        report,
        facts={**report.facts, 'commit': read_commit()},
        commands={**commands, **report.commands},
    )


def show_resume_command(words: Sequence[str], run: StudyRun) -> None:
    """Print how to resume a study that was stopped, if it has stored anything."""
    if words and any(run.folder.glob('*')):
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
    rest, skip = list[str](), False
    for word in words:
        name = word.split('=')[0]
        if skip or name in FLAGS or name in FOLDERS:
            # The folder is the next word, unless it follows an equals sign
            skip = not skip and word in FOLDERS
            continue
        rest.append(word)
    return rest


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

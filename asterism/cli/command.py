"""What commands share: common options, consent, progress, table, warnings and exit status, and options of several."""

from __future__ import annotations

import dataclasses
import functools
import gc
import inspect
import io
import re
import shutil
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TextIO, get_args, get_origin

import typer

from asterism.equilibrium.errors import Error, one_line
from asterism.process.progress import ProgressLine
from asterism.process.settings import field_types
from asterism.process.version import __version__

if TYPE_CHECKING:
    from asterism.equilibrium.newton.minimise import Iteration
    from asterism.exact.cost import Cost
    from asterism.pattern.design.design import Design
    from asterism.results.record import Record


DONE = 0
NO_ANSWER = 1
WRONG_INPUT = 2
INTERRUPTED = 130

# options of all commands; their values are the attributes of `Run` with the same names
COMMON_OPTIONS: dict[str, tuple[Any, Any]] = {
    "strict": (
        Annotated[bool, typer.Option("--strict", help="End with exit status 1 if a result is not reliable.")],
        False,
    ),
    "yes": (Annotated[bool, typer.Option("--yes", help="Compute also what takes long or needs much memory.")], False),
    "quiet": (Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")], False),
}


class Mistake(Error):
    """An option or argument is wrong; the message names it and the allowed values."""


class Interrupted(Error):
    """Ctrl-C has ended a command; the message says where it can be continued."""

    exit_status = 130


class Progress(ProgressLine):
    """One changing line on a terminal; elsewhere one line for each stage."""

    _stage = ""

    def report(self, stage: str, iteration: Iteration) -> None:
        """Show an iteration; `stage` describes the stage, such as the released part of the stretch."""
        if stage != self._stage and not self.is_live:
            self.close()
        self._stage = stage
        name = f"{stage} released" if stage.endswith("%") else stage
        begin = f"  {name:<32} iteration {iteration.number:<4} energy {iteration.energy:.4f} N mm"
        clock = f"   {time.monotonic() - self.start_s:.1f} s"
        line = f"{begin}   gradient {iteration.gradient_norm:.1e} N{clock}"
        # a line that wraps cannot be replaced
        room = shutil.get_terminal_size().columns - 1
        if self.is_live and len(line) > room:
            line = (begin[: max(room - len(clock), 0)] + clock)[:room]
        self.change(line)


class Run:
    """One run of a command, with its output: progress, results and warnings.

    Attributes
    ----------
    quiet : print results, warnings and errors, but not progress.
    strict : a result that is not reliable ends with exit status 1.
    yes : compute also what takes long or needs much memory.
    is_doubtful : a printed result is not reliable.
    stream : output stream of progress.
    progress : what is printed there; `command` begins and ends it. `say` prints a line, `report` shows an iteration.
    """

    def __init__(self, quiet: bool = False, strict: bool = False, yes: bool = False) -> None:
        self.quiet, self.strict, self.yes = quiet, strict, yes
        self.is_doubtful = False
        # a quiet command discards its progress
        self.stream: TextIO = io.StringIO() if quiet else sys.stderr
        # loading the libraries may take longer than a user waits without a sign, so it begins with the command
        self.progress = Progress(self.stream)
        self.say, self.report = self.progress.say, self.progress.report

    @contextmanager
    def computing(self, compile_ahead: Literal["discrete", "fem"] | None = None) -> Iterator[None]:
        """Announce the compilation of a first run, also ahead for the package that the block uses last."""
        from asterism.process.compiling import announce_compiling, compiling_ahead

        _collect_from_here()
        with compiling_ahead(compile_ahead), announce_compiling(self.say):
            try:
                yield
            finally:
                self.progress.close()

    def hand_over(self) -> TextIO:
        """The stream of progress, for a computation that shows its progress itself."""
        self.progress.end()
        _collect_from_here()
        return self.stream

    def cost(self, cost: Cost) -> None:
        """Print what a computation costs; ask for consent if that is much.

        Raises Mistake: it costs much, and neither --yes nor a terminal gives consent.
        """
        if (cost.seconds > 300.0 or cost.memory_mb > 4000.0) and not self.yes:
            with self.progress.paused():
                _ask(cost)
        self.say(f"about {cost.in_words()}")

    @contextmanager
    def resumable(self, folder: Path, what: str) -> Iterator[None]:
        """Say where finished parts are, if the block is interrupted and they are kept in a folder."""
        try:
            yield
        except KeyboardInterrupt:
            if not folder.exists():
                raise
            where = f"finished {what} are in {folder}, and the same command continues from there"
            raise Interrupted(f"interrupted; {where}") from None

    def table(self, rows: Mapping[str, str], width: int = 20, doubts: Sequence[str] = ()) -> None:
        """Print named values, one a line; first the reasons for which the result is not reliable."""
        if doubts:
            self.is_doubtful = True
            rows = {"not reliable": "; ".join(doubts), **rows}
        self.lines(f"  {name:<{width}} {value}" for name, value in rows.items())

    def lines(self, lines: Iterable[str]) -> None:
        """Print lines of a result on standard output."""
        for line in lines:
            typer.echo(one_line(line))

    def result(
        self, summary: Record, directory: Path, files: Iterable[str], doubts: Sequence[str] | None = None
    ) -> None:
        """Print the numbers of a result, and its files; `doubts` are by default those of its shape."""
        from asterism.results.words import doubts as of_shape

        self.table(summary.table(), doubts=of_shape(summary) if doubts is None else doubts)
        self.files(directory, files)

    def files(self, directory: Path, names: Iterable[str]) -> None:
        """Print the folder and the names of the written files."""
        self.lines([f"{directory}: {', '.join(names)}"])

    def warn(self, *lines: str) -> None:
        """Print warnings on standard error, one a line."""
        for line in lines:
            print(f"asterism: {one_line(line)}", file=sys.stderr)


def _collect_from_here() -> None:
    """Collect reference cycles, as long computations need it, but not among the objects of the loaded libraries."""
    gc.freeze()
    gc.enable()


def _show_warning(run: Run, otherwise: Callable[..., None], message: Any, category: type, *place: Any) -> None:
    if category.__name__ == "DrawingWarning":
        run.warn(str(message))
    else:
        otherwise(message, category, *place)


def command(function: Callable[..., int | None]) -> Callable[..., int]:
    """Make a command for typer from a function whose first parameter is a `Run`.

    The command has the function's other parameters and the common options. The fields of a parameter that is a settings
    object are options of their own. Its value is the exit status, 0 for None.
    """
    signature = inspect.signature(function, eval_str=True)
    own: list[inspect.Parameter] = []
    settings: dict[str, type[Any]] = {}
    for parameter in list(signature.parameters.values())[1:]:
        kind = parameter.annotation
        if isinstance(kind, type) and dataclasses.is_dataclass(kind):
            settings[parameter.name] = kind
            own += _options_of(kind)
        else:
            own.append(parameter)
    common = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
        for name, (annotation, default) in COMMON_OPTIONS.items()
    ]

    @functools.wraps(function)
    def run_command(**arguments: Any) -> int:
        run = Run(**{name: arguments.pop(name) for name in COMMON_OPTIONS})
        for name, kind in settings.items():
            given = {field.name: arguments.pop(field.name) for field in dataclasses.fields(kind)}
            arguments[name] = kind(**{key: tuple(v) if isinstance(v, list) else v for key, v in given.items()})
        with run.progress, warnings.catch_warnings():
            # what is left out of a drawing is a warning of the command, all others are Python's
            warnings.showwarning = functools.partial(_show_warning, run, warnings.showwarning)
            try:
                status = function(run, **arguments) or DONE
            except Error as error:
                design = arguments.get("design")
                raise (with_design_file(error, design) if isinstance(design, Path) else error) from None
        return NO_ANSWER if status == DONE and run.strict and run.is_doubtful else status

    parameters = [*own, *common]
    run_command.__signature__ = signature.replace(parameters=parameters, return_annotation=int)  # type: ignore[attr-defined]
    run_command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters} | {"return": int}
    return run_command


def _options_of(kind: type) -> list[inspect.Parameter]:
    """The fields of a settings object as options, with what its docstring says about each."""
    entries = re.findall(r"^(\w+) : (.*(?:\n +.*)*)", inspect.getdoc(kind) or "", re.MULTILINE)
    texts = {name: " ".join(text.replace("`", "").split()) for name, text in entries}
    types = field_types(kind)
    options = []
    for field in dataclasses.fields(kind):
        plain, names, limits = types[field.name]
        more: dict[str, Any] = {}
        if plain is bool and not field.default:
            names = names or [f"--{field.name.replace('_', '-')}"]
        if get_origin(plain) is tuple:
            plain = list[get_args(plain)[0]]  # type: ignore[misc]
        elif tuple[float, float] in get_args(plain):
            plain, more = Any, {"parser": two_sizes, "metavar": "WIDTHxDEPTH"}
        allowed = "".join(f" From {low:g} to {high:g}." for low, high in limits)
        option = typer.Option(*names, help=texts[field.name][:1].upper() + texts[field.name][1:] + allowed, **more)
        annotation: Any = Annotated[plain, option]
        kept = {"default": field.default, "annotation": annotation}
        options.append(inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, **kept))
    return options


def two_sizes(text: str) -> tuple[float, float]:
    """Two sizes from a text such as `300x250`; one number is both."""
    words = re.split("[x×]", text.lower())
    try:
        sizes = [float(word) for word in words]
    except ValueError:
        sizes = []
    if len(sizes) not in (1, 2):
        raise typer.BadParameter(f"must be width x depth, such as 300x250, not {text!r}")
    return sizes[0], sizes[-1]


def _ask(cost: Cost) -> None:
    """Ask on the terminal whether to begin; without a terminal, a mistake names the option that consents."""
    question = f"takes about {cost.in_words()}"
    if not (sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()):
        raise Mistake(f"{question}: use --yes to compute it, or {cost.cheaper}")
    typer.confirm(f"{question}: compute it?", abort=True, err=True)


def with_design_file(error: Error, file: Path) -> Error:
    """The error after the name of the file, if it is about a field of a design and names no file."""
    from asterism.homogenize.errors import LawError
    from asterism.pattern.design.design import Design
    from asterism.pattern.design.errors import DesignError

    field = error.field if isinstance(error, DesignError | LawError) else ""
    if re.split(r"\W", field, maxsplit=1)[0] not in Design.model_fields or not str(error).startswith(
        (f"{field}:", f"{field} =")
    ):
        return error
    if isinstance(error, DesignError):
        return error.within(file)
    assert isinstance(error, LawError)
    return type(error)(f"{file}: {error}", error.stars, error.place_mm, error.field)


# units of the numbers in a file, as `asterism.measure.scan.MM`
FileUnit = Literal["mm", "cm", "m", "in", "um"]
DesignFile = Annotated[Path, typer.Argument(help="Design file (.toml or .json).")]
MaterialFile = Annotated[
    Path | None,
    typer.Option(
        help="Name (see asterism materials) or file of a material, in place of the design's fabric and plastic."
    ),
]
LawFile = Annotated[
    Path | None, typer.Option(help="File of the law (.npz; default: that of the design, or of the paper's material).")
]
PrinterName = Annotated[str, typer.Option(help="Name of a printer (see asterism printers), or its file.")]
Processes = Annotated[
    int | None, typer.Option("--jobs", min=1, max=1000, help="Number of processes (default: one per core).")
]
DaskAddress = Annotated[
    str | None, typer.Option("--dask", help="Address of a Dask scheduler, instead of processes on this machine.")
]
Contact = Annotated[
    bool | None,
    typer.Option("--contact/--no-contact", help="Prevent the sheet from passing through itself (requires ipctk)."),
]
ToleranceOption = Annotated[
    float | None,
    typer.Option(
        help="Refine the mesh until the error of the shape is within this part of the diameter, in percent, instead of "
        "the value or the edge length in the design; not for the paper's hinges."
    ),
]
EdgeOption = Annotated[
    float | None, typer.Option(help="Edge length of the exact mesh in mm, instead of the value in the design.")
]
BackendOption = Annotated[str, typer.Option(help="Linear solver: auto, pardiso, cholmod, superlu or amg.")]


def output_option(help: str) -> Any:
    """-o, for the annotation of a parameter that is a path, or None without the option."""
    return typer.Option("-o", "--output", help=help, parser=nonempty_path)


def nonempty_path(text: str) -> Path:
    """Refuse an empty name: it would be the working directory, and usually comes from a variable that is not set."""
    if not str(text):
        raise typer.BadParameter("must not be empty")
    return Path(text)


def check_workers(jobs: int | None, dask: str | None) -> None:
    """Refuse --jobs beside --dask."""
    if jobs is not None and dask is not None:
        raise Mistake("--jobs: applies to processes of this machine, not to --dask")


def root() -> typer.Typer:
    """`asterism` itself, to which commands are added."""
    app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)

    @app.callback(invoke_without_command=True)
    def without_command(
        context: typer.Context,
        version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
    ) -> None:
        """Compute the shape of plastic stars or lines printed on stretched fabric."""
        if version:
            typer.echo(__version__)
        elif context.invoked_subcommand is None:
            typer.echo(context.get_help())

    return app


def group(help: str, *commands: Callable[..., int]) -> typer.Typer:
    """Commands below one name."""
    app = typer.Typer(help=help, invoke_without_command=True)
    names = [each.__name__ for each in commands]

    @app.callback()
    def needs_a_command(context: typer.Context) -> None:
        if context.invoked_subcommand is None:
            raise Mistake(f"{context.info_name}: needs a command: {', '.join(names[:-1])} or {names[-1]}")

    for each in commands:
        app.command()(each)
    return app


def results_folder(design: Path, output: Path | None, default: Path, *names: str) -> Path:
    """The folder given by the user, or the default one, for files of these names (or summary.json and its like).

    Raises OutputError: the folder cannot be written to, holds files of another origin, or the results would replace the
    design.
    """
    from asterism.results.files import SUMMARY_FILE, OutputError, check_writable

    directory = output or default
    for name in names or (SUMMARY_FILE,):
        with suppress(OSError):  # of a file that is not there
            if (directory / name).samefile(design):
                raise OutputError(
                    f"--output: {str(directory)!r} is where {design.name} is and stays; choose another name"
                )
    check_writable(directory, *names)
    return directory


# entries of the design in whose place options stand
OVERRIDES = {
    "edge": "mesh.edge_mm",
    "tolerance": "mesh.tolerance_percent",
    "contact": "solver.contact",
}


def with_overrides(design: Design, **options: Any) -> Design:
    """The design with the entries given on the command line: options of `OVERRIDES`; None for no change.

    Raises DesignError: a value is not allowed; the message names the option.
    """
    from asterism.pattern.design.design import Design
    from asterism.pattern.design.entries import with_entries
    from asterism.pattern.design.errors import DesignError
    from asterism.pattern.layout.build import layout

    data = design.to_dict()
    given = {OVERRIDES[option]: value for option, value in options.items() if value is not None}
    if not given:
        return design
    refines = "mesh.tolerance_percent" in given
    if refines:
        if "mesh.edge_mm" in given:
            raise Mistake("--tolerance: goes without --edge: the mesh is refined until the error is within it")
        data["mesh"].pop("edge_mm", None)
    try:
        new = Design.from_dict(with_entries(data, given))
        if refines and new.mesh_edge_mm is not None:
            plates = "plate and consistent have one; --edge sets the mesh of others"
            raise Mistake(f"--tolerance: not for fabric.bending = {new.fabric.bending!r}: {plates}")
        layout(new)
    except DesignError as error:
        for option, field in OVERRIDES.items():
            if field == error.field and field in given:
                raise DesignError(f"--{option}", error.allowed, error.value) from None
        raise
    return new

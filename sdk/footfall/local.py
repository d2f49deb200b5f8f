"""The one door to the server packages: work in this process, and what a service is made of.

Everything of the server is imported inside functions, and where it is not installed the error
says what to install.
"""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, NoReturn

from footfall.documents import Problem, is_simulation
from footfall.documents import read_problem as read_document
from footfall.errors import BadProblem, EngineFault, Issue, MissingServer, ServeFailed
from footfall.result import Result, SimulationResult
from footfall.sse import Event

_SERVER = frozenset({"api", "worker", "solver", "schemas", "store", "examples"})


def solve(
    problem: Problem,
    *,
    on_event: Callable[[Event], object] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> Result:
    """Solve a problem in this process, without a service.

    Parameters
    ----------
    problem : dict, str or Path
        The problem, or the path of a JSON file that holds it.
    on_event : callable, optional
        Is called with every stage, NLP iteration and solved mesh.
    should_stop : callable, optional
        Is asked at every NLP iteration; true ends the solve with the best iterate.

    Returns
    -------
    Result
        However the mathematics ended; ``result.status`` says how.

    Raises
    ------
    BadProblem
        With every issue of the problem.
    BadFile, MissingServer, EngineFault
        See ``footfall.errors``.
    """
    document = read_document(problem)
    with _needs("worker", "solving in this process"), _translated():
        from solver import solve as engine

        solution = engine(_read(document), **_options(on_event, should_stop))
    return Result(solution.model_dump(mode="json"))


def simulate(
    simulation: Problem,
    *,
    on_event: Callable[[Event], object] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> SimulationResult:
    """Simulate in this process, without a service.

    Parameters
    ----------
    simulation : dict, str or Path
        The simulation, or the path of a JSON file that holds it.
    on_event, should_stop : callable, optional
        As for ``solve``; asked and told after some steps.

    Returns
    -------
    SimulationResult
        However the motion ended; ``result.status`` says how.

    Raises
    ------
    BadProblem
        With every issue of the simulation.
    BadFile, MissingServer, EngineFault
        See ``footfall.errors``.
    """
    document = read_document(simulation)
    with _needs("worker", "simulating in this process"), _translated():
        from solver.simulation import simulate as engine

        result = engine(_read_simulation(document), **_options(on_event, should_stop))
    return SimulationResult(result.model_dump(mode="json"))


def _options(
    on_event: Callable[[Event], object] | None, should_stop: Callable[[], bool] | None
) -> dict[str, Any]:
    options: dict[str, Any] = {}
    if on_event is not None:
        options["on_event"] = lambda event: on_event(_event(event))
    if should_stop is not None:
        options["should_stop"] = should_stop
    return options


def validate(problem: Problem) -> list[Issue]:
    """What is wrong with a problem or simulation, checked here; an empty list: it is fine.

    What only the built model can tell (a NaN at the guess) shows when it is solved.
    """
    return check(problem)[0]


def check(problem: Problem) -> tuple[list[Issue], list[str]]:
    """What is wrong with a problem or simulation; and warnings about one that is fine."""
    document = read_document(problem)
    with _needs("worker", "checking a problem in this process"):
        from schemas.remarks import remarks, simulated_remarks

        try:
            with _translated():
                if is_simulation(document):
                    return [], list(simulated_remarks(_read_simulation(document)))
                return [], list(remarks(_read(document)))
        except BadProblem as error:
            return error.issues, []


def _read(document: dict[str, Any]) -> Any:
    from schemas.inlining import inlined
    from schemas.reading import read_problem

    sources = _sources()
    return read_problem(document, lambda raw: inlined(raw, sources))


def _read_simulation(document: dict[str, Any]) -> Any:
    from schemas.inlining import inlined_simulation
    from schemas.simulations import read_simulation

    sources = _sources()
    return read_simulation(document, lambda raw: inlined_simulation(raw, sources))


def _sources() -> Any:
    """Where the names in a document lead here; jobs are at their service alone."""
    import examples as gallery
    from schemas.errors import UnknownJob
    from schemas.inlining import Sources

    def result(_: str) -> NoReturn:
        raise UnknownJob(
            "there are no jobs in this process",
            "Solve it through the service that has the job, with --server URL.",
        )

    names = [*gallery.names(), *gallery.simulations()]
    return Sources(lambda: names, gallery.load, result)


def examples() -> dict[str, dict[str, Any]]:
    """The gallery as it is installed here: name -> problem or simulation."""
    with _needs("worker", "the gallery without a service"):
        import examples as gallery

        names = [*gallery.names(), *gallery.simulations()]
        return {name: gallery.load(name) for name in names}


def queue_binary() -> Path:
    """The binary of the embedded queue server."""
    with _needs("embedded", "the embedded queue server"), _translated():
        from store.embedded import binary

        return binary()


def queue_server(folder: Path) -> AbstractContextManager[Any]:
    """The embedded queue server over a data folder, not yet started; it has a ``url``."""
    with _needs("api,worker,embedded", "serving"):
        from store.embedded import EmbeddedServer

        return EmbeddedServer(folder)


@contextmanager
def starting() -> Iterator[None]:
    """Turn the server's own errors while it starts into ours."""
    with _needs("api,worker,embedded", "serving"), _translated():
        yield


def check_server_packages() -> None:
    """Raise ``MissingServer`` unless api and worker can be started here."""
    with _needs("api,worker,embedded", "serving"):
        import uvicorn  # noqa: F401

        import api.settings  # noqa: F401
        import worker.settings  # noqa: F401


@contextmanager
def _needs(extras: str, what: str) -> Iterator[None]:
    try:
        yield
    except ModuleNotFoundError as error:
        missing = (error.name or "?").partition(".")[0]
        package = "footfall-server" if missing in _SERVER else missing
        raise MissingServer(
            f"{what.capitalize()} needs the package {package}, which is not installed.",
            f"pip install 'footfall-server[{extras}]', or use a service with --server URL.",
        ) from error


@contextmanager
def _translated() -> Iterator[None]:
    from schemas import errors

    try:
        yield
    except errors.BadProblem as error:
        issues = [Issue(i.pointer, i.message, i.hint, i.column) for i in error.issues]
        raise BadProblem(issues) from error
    except errors.EngineFault as error:
        raise EngineFault(error.message, error.hint) from error
    except errors.FootfallError as error:
        raise ServeFailed(error.message, error.hint) from error


def _event(event: Any) -> Event:
    document = event.model_dump(mode="json")
    return Event(document["type"], document)

"""The words of the command line: commands, options, helps with examples."""

import argparse
import sys
from collections.abc import Callable, Mapping
from importlib.metadata import version

from footfall.cli import codes, drawing, gallery, jobs, service, solving, sweeping
from footfall.client import DEFAULT_URL

Run = Callable[[argparse.Namespace], int]

_ABOUT = "Trajectory optimization, also through contact, as a service or in this process."
_START = """start here:
  footfall examples                    what there is to solve
  footfall solve FILE                  solve a problem in this process
  footfall simulate FILE               simulate a system in this process
  footfall serve                       keep a service running
  footfall submit FILE --watch         solve through the service

exit codes: 0 converged, or simulated to its end; 3 finished otherwise, 2 bad problem, 1 fault,
130 interrupted"""


class _Words:
    """Collects the commands; each has a run function, a help and an example."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        self.url = environment.get("FOOTFALL_URL") or DEFAULT_URL
        self.folder = environment.get("FOOTFALL_DATA") or ".footfall"
        self.environment = environment
        self.top = argparse.ArgumentParser(
            prog="footfall",
            description=_ABOUT,
            epilog=_START,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        said = f"footfall {version('footfall')}"
        self.top.add_argument("--version", action="version", version=said)
        self._commands = self.top.add_subparsers(metavar="COMMAND")
        self.top.set_defaults(run=self._help, json=False)

    def _help(self, _: argparse.Namespace) -> int:
        self.top.print_help(sys.stderr)
        return codes.BAD_INPUT

    def command(self, name: str, run: Run, words: str, example: str) -> argparse.ArgumentParser:
        """A command with the options that all have."""
        added = self._commands.add_parser(
            name,
            help=words,
            description=words[0].upper() + words[1:] + ".",
            epilog=f"example:\n  {example}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        added.add_argument("--json", action="store_true", help="JSON alone on stdout, for programs")
        added.set_defaults(run=run, environment=self.environment)
        return added

    def remote(self, name: str, run: Run, words: str, example: str) -> argparse.ArgumentParser:
        """A command that talks to a service."""
        added = self.command(name, run, words, example)
        help_ = f"where the service is (default: FOOTFALL_URL or {DEFAULT_URL})"
        added.add_argument("--server", metavar="URL", default=self.url, help=help_)
        return added


def parser(environment: Mapping[str, str]) -> argparse.ArgumentParser:
    """The whole command line; ``environment`` gives the defaults."""
    words = _Words(environment)
    _solving(words)
    _jobs(words)
    _sweeps(words)
    _service(words)
    return words.top


def _solving(words: _Words) -> None:
    solve = words.command(
        "solve",
        solving.solve,
        "solve a problem and wait for the result",
        "footfall solve examples/cart_pole.json --report cart_pole.html",
    )
    _problem(solve)
    _files(solve)
    through = "solve through this service instead of in this process"
    solve.add_argument("--server", metavar="URL", help=through)
    simulate = words.command(
        "simulate",
        solving.simulate,
        "simulate a system and wait for the result",
        "footfall simulate my_simulation.json --report motion.html",
    )
    simulate.add_argument("file", metavar="FILE", help="the simulation's JSON file, or - for stdin")
    _files(simulate)
    through = "simulate through this service instead of in this process"
    simulate.add_argument("--server", metavar="URL", help=through)
    validate = words.command(
        "validate",
        solving.validate,
        "check a problem or simulation without running it",
        "footfall validate my_problem.json",
    )
    _problem(validate)
    validate.add_argument("--server", metavar="URL", help="let this service check it")
    examples = words.command(
        "examples",
        gallery.examples,
        "list the gallery, or print one of its problems",
        "footfall examples cart_pole > my_problem.json",
    )
    examples.add_argument("name", nargs="?", help="the example to print")
    examples.add_argument("--server", metavar="URL", help="the gallery of this service")


def _jobs(words: _Words) -> None:
    submit = words.remote(
        "submit",
        jobs.submit,
        "queue a problem or simulation at the service and print the job's id",
        "footfall submit my_problem.json --watch",
    )
    _problem(submit)
    submit.add_argument("--watch", action="store_true", help="follow it and print the result")
    warm = "start from the solution of this job of yours; of a simulation: its controls"
    submit.add_argument("--guess-from", metavar="JOB", help=warm)
    watch = words.remote(
        "watch", jobs.watch, "follow a job to its end and print the result", "footfall watch ID"
    )
    watch.add_argument("id", help="the job's id")
    for command in (submit, watch):
        _files(command)
    listed = words.remote("jobs", jobs.jobs, "list your latest jobs", "footfall jobs --limit 5")
    listed.add_argument("--kind", choices=("solve", "simulation"), help="only these")
    listed.add_argument("--limit", type=_count, default=20, help="how many (default: 20)")
    cancel = words.remote(
        "cancel", jobs.cancel, "cancel a job; it keeps its best iterate", "footfall cancel ID"
    )
    cancel.add_argument("id", help="the job's id")
    cancel.add_argument("--now", action="store_true", help="kill it without asking first")
    result = words.remote(
        "result",
        jobs.result,
        "fetch the result of a job",
        "footfall result ID --json > result.json",
    )
    result.add_argument("id", help="the job's id")
    _files(result)
    report = words.command(
        "report",
        drawing.report,
        "draw a result that was kept: the page, or pictures",
        "footfall report result.json --motion motion.svg > page.html",
    )
    report.add_argument("file", metavar="FILE", help="the result's JSON file, or - for stdin")
    report.add_argument("--problem", metavar="FILE", help="what it came of: its bounds are drawn")
    report.set_defaults(output=None)
    _drawn(report)


def _sweeps(words: _Words) -> None:
    sweep = words.remote(
        "sweep",
        sweeping.sweep,
        "solve a problem at many places through the service",
        "footfall sweep examples/cart_pole.json --grid /phases/0/system/parameters/m1=0.5,1,2",
    )
    what = "the problem's JSON file, or that of a whole sweep, or - for stdin"
    sweep.add_argument("file", metavar="FILE", help=what)
    over = sweep.add_mutually_exclusive_group()
    over.add_argument(
        "--grid",
        metavar="POINTER=VALUES",
        action="append",
        help="values for a place in the problem, comma between them; again for more places",
    )
    over.add_argument("--multistart", type=_count, metavar="N", help="so many guesses instead")
    sweep.add_argument(
        "--chunk", type=_count, metavar="N", help="points that a job solves in a row"
    )
    cold = "start each point from the problem's guess, not from the solution before"
    sweep.add_argument("--cold", action="store_true", help=cold)
    sweep.add_argument("--detach", action="store_true", help="do not wait; print the sweep's id")


def _service(words: _Words) -> None:
    serve = words.command(
        "serve",
        service.serve,
        "run a whole service on this machine: queue server, api and workers",
        "footfall serve --port 8000 --workers 2",
    )
    serve.add_argument("--host", default="127.0.0.1", help="the address (default: 127.0.0.1)")
    serve.add_argument("--port", type=_port, default=8000, help="default: 8000; 0: any free one")
    serve.add_argument("--workers", type=_count, default=1, help="how many (default: 1)")
    worker = words.command(
        "worker",
        service.worker,
        "run one more worker for the service of a data folder or of REDIS_URL",
        "REDIS_URL=redis://queue:6379/0 footfall worker",
    )
    worker.add_argument("--name", default="", help="a unique name (default: made up)")
    for command in (serve, worker):
        command.add_argument("--data-dir", default=words.folder, help=f"default: {words.folder}")
    words.remote(
        "doctor",
        service.doctor,
        "look whether all that Footfall needs is here and works",
        "footfall doctor",
    )


def _problem(command: argparse.ArgumentParser) -> None:
    command.add_argument("file", metavar="FILE", help="the problem's JSON file, or - for stdin")


def _files(command: argparse.ArgumentParser) -> None:
    command.add_argument("--output", metavar="FILE", help="write the result's JSON here too")
    _drawn(command)


def _drawn(command: argparse.ArgumentParser) -> None:
    command.add_argument("--report", metavar="FILE", help="write the report's HTML here")
    command.add_argument("--picture", metavar="FILE", help="write the curves as SVG here")
    command.add_argument("--motion", metavar="FILE", help="write frames of the motion as SVG here")


def _port(text: str) -> int:
    return _number(text, 65_535)


def _count(text: str) -> int:
    return _number(text, 256)


def _number(text: str, top: int) -> int:
    if not text.isdecimal() or int(text) > top:
        raise argparse.ArgumentTypeError(f"expected a whole number from 0 to {top}, got {text!r}")
    return int(text)

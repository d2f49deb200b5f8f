"""The commands that talk to a service: submit, watch, cancel, result; solve with --server."""

import argparse
import sys
from collections.abc import Callable, Mapping
from itertools import islice
from typing import Any

from footfall.cli import codes
from footfall.cli.output import check_places, deliver, note, refuse, show_json
from footfall.cli.progress import progress
from footfall.client import Client, Job
from footfall.documents import is_simulation, read_json
from footfall.errors import BadProblem, NoResult
from footfall.result import Result
from footfall.summary import table, words


def client(options: argparse.Namespace) -> Client:
    """A client of the service that the options name; the key is FOOTFALL_KEY's."""
    return Client(options.server, options.environment.get("FOOTFALL_KEY"))


def submit(options: argparse.Namespace) -> int:
    """Queue a problem or simulation and print the job's id; with --watch go on to its result."""
    problem = read_json(options.file)
    if options.guess_from:
        place = "controls" if is_simulation(problem) else "guess"
        problem[place] = {"from_job": options.guess_from}
    if options.watch:
        check_places(options)
        return run_through(options, problem)
    try:
        with client(options) as service:
            _show(_way(service, problem)(problem), options)
    except BadProblem as error:
        return refuse(error, problem, options)
    return codes.CONVERGED


def _way(service: Client, document: Mapping[str, Any]) -> Callable[[dict[str, Any]], Job]:
    return service.simulate if is_simulation(document) else service.submit


def run_through(options: argparse.Namespace, problem: dict[str, Any]) -> int:
    """Submit, follow, print; Ctrl-C cancels the job and keeps what it has by then."""
    with client(options) as service:
        try:
            job = _way(service, problem)(problem)
            note(f"job {job.id}")
            try:
                return deliver(_followed(service, job.id), options, problem)
            except KeyboardInterrupt:
                return _interrupted(service, job.id, options, problem)
        except BadProblem as error:  # on submission, or when the worker built its model
            return refuse(error, problem, options)


def watch(options: argparse.Namespace) -> int:
    """Follow a job to its end; Ctrl-C only stops looking."""
    with client(options) as service:
        try:
            return deliver(_followed(service, options.id), options)
        except KeyboardInterrupt:
            note(f"the job goes on; 'footfall cancel {options.id}' ends it")
            return codes.INTERRUPTED


def cancel(options: argparse.Namespace) -> int:
    """Cancel a job."""
    with client(options) as service:
        _show(service.cancel(options.id, now=options.now), options)
    return codes.CONVERGED


def result(options: argparse.Namespace) -> int:
    """Fetch the result of an ended job."""
    with client(options) as service:
        return deliver(service.result(options.id), options)


def jobs(options: argparse.Namespace) -> int:
    """List the latest jobs, the newest first."""
    with client(options) as service:
        latest = list(islice(service.jobs(kind=options.kind), options.limit))
    if options.json:
        show_json([job.document for job in latest])
    else:
        rows = [[j.id, j.name, j.kind, j.status, words(j.solution_status or "")] for j in latest]
        print(table(["id", "name", "kind", "job", "result"], rows, left=5))
    return codes.CONVERGED


def _followed(service: Client, job_id: str) -> Result:
    with progress(sys.stderr) as shown:
        return service.wait(job_id, on_event=shown)


def _interrupted(
    service: Client, job_id: str, options: argparse.Namespace, problem: Mapping[str, Any]
) -> int:
    note("cancelling; once more leaves the job to itself")
    service.cancel(job_id)
    try:
        deliver(service.wait(job_id, timeout=30), options, problem)
    except NoResult as error:
        note(error.message)
    return codes.INTERRUPTED


def _show(job: Job, options: argparse.Namespace) -> None:
    if options.json:
        show_json(job.document)
    else:
        print(job.id)
        note(f"{job.name}: {job.status}")

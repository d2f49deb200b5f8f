"""``footfall serve``, ``footfall worker`` and ``footfall doctor``."""

import argparse
import os
import sys
import time
from pathlib import Path

from footfall import local
from footfall.cli import codes
from footfall.cli.doctor import examine
from footfall.cli.interrupt import Interrupt
from footfall.cli.output import note, show_json
from footfall.serving import ServeSettings, Service
from footfall.summary import plural, table


def serve(options: argparse.Namespace) -> int:
    """Run a whole service until SIGINT or SIGTERM."""
    redis_url = options.environment.get("REDIS_URL", "")
    folder = Path(options.data_dir)
    settings = ServeSettings(options.host, options.port, options.workers, folder, redis_url)
    with Interrupt("stopping") as interrupt, Service(settings, note) as service:
        _announce(service, options)
        while not interrupt.asked():
            service.watch()
            time.sleep(0.2)
    return codes.CONVERGED


def worker(options: argparse.Namespace) -> int:
    """Become a worker: this process is replaced by one."""
    local.check_server_packages()
    command = [sys.executable, "-P", "-m", "worker"]
    command += ["--name", options.name] if options.name else []
    command += ["--json"] if options.json else []
    sys.stdout.flush()
    environment = options.environment | {"FOOTFALL_DATA": options.data_dir}
    os.execve(command[0], command, environment)  # noqa: S606 - our own interpreter and module


def doctor(options: argparse.Namespace) -> int:
    """Look at each thing that is needed; 1 if something that must be there is not."""
    findings = examine(options.server)
    if options.json:
        show_json([finding.to_dict() for finding in findings])
    else:
        rows = [[f.name, f.state, f.words] for f in findings]
        mends = [f"{f.name}: {f.mend}" for f in findings if f.mend]
        print("\n".join([table(["what", "state", "found"], rows, left=3), *mends]))
    return codes.FAULT if any(f.state == "missing" for f in findings) else codes.CONVERGED


def _announce(service: Service, options: argparse.Namespace) -> None:
    if options.json:
        show_json({"url": service.url, "pid": os.getpid()})
    else:
        crew = plural(options.workers, "worker")
        print(f"Footfall serves at {service.url} ({crew}, data in {options.data_dir})")
    sys.stdout.flush()

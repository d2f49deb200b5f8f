"""The demo: start a service, solve the cart-pole over HTTP, write demo/report.html, stop."""

import sys
import tempfile
from pathlib import Path

from footfall.cli.main import main
from footfall.serving import ServeSettings, Service

PROBLEM = "examples/cart_pole.json"
REPORT = "demo/report.html"


def demo() -> int:
    """Return the exit code of the command: 0 if the problem was solved and certified."""
    with tempfile.TemporaryDirectory(prefix="footfall-") as folder:
        print("Starting the queue server, the api and a worker", flush=True)
        with Service(ServeSettings(port=0, folder=Path(folder)), print) as service:
            command = ["solve", PROBLEM, "--server", service.url, "--report", REPORT]
            print("$ footfall", *command, "\n", flush=True)
            return main(command)


if __name__ == "__main__":
    sys.exit(demo())

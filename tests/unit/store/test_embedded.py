"""The embedded server: private, alone, durable, and never outliving its owner."""

import os
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from schemas.errors import StoreUnavailable
from store import connect, embedded
from store.embedded import EmbeddedServer
from tests.support.service import ROOT, submit, wait_until

OWNER = """
import sys, time
from pathlib import Path
from store.embedded import EmbeddedServer
server = EmbeddedServer(Path(sys.argv[1]))
server.start()
print(server.pid, flush=True)
time.sleep(60)
"""


def alive(pid: int) -> bool:
    status = Path(f"/proc/{pid}/stat")
    return status.exists() and status.read_text().rsplit(")", 1)[1].split()[0] != "Z"


def test_it_is_for_this_user_alone(tmp_path: Path) -> None:
    with EmbeddedServer(tmp_path / "data") as server:
        connect(server.url).ping()
        socket = embedded.socket_path(tmp_path / "data")
        assert stat.S_IMODE(socket.parent.stat().st_mode) == 0o700
        assert stat.S_IMODE((tmp_path / "data").stat().st_mode) == 0o700
        listening = Path(f"/proc/{server.pid}/net/tcp").read_text()
        inodes = {
            str(each.readlink())
            for each in Path(f"/proc/{server.pid}/fd").iterdir()
            if each.is_symlink()
        }
        tcp = {f"socket:[{line.split()[9]}]" for line in listening.splitlines()[1:]}
        assert not inodes & tcp


def test_a_long_path_gets_a_short_socket(tmp_path: Path) -> None:
    folder = tmp_path / ("long" * 20) / ("longer" * 10)
    assert len(os.fsencode(embedded.socket_path(folder))) <= 100
    assert embedded.socket_path(folder) == embedded.socket_path(folder)
    with EmbeddedServer(folder) as server:
        connect(server.url).ping()


def test_a_second_one_on_the_same_data_is_refused(tmp_path: Path) -> None:
    with (
        EmbeddedServer(tmp_path) as first,
        pytest.raises(StoreUnavailable, match=f"process {os.getpid()}"),
    ):
        EmbeddedServer(tmp_path).start()
    connected = EmbeddedServer(tmp_path)
    with connected:
        assert connected.url == first.url


def test_it_dies_with_its_owner_and_frees_the_data(tmp_path: Path) -> None:
    words = [sys.executable, "-c", OWNER, str(tmp_path)]
    with subprocess.Popen(words, cwd=ROOT, stdout=subprocess.PIPE) as owner:
        assert owner.stdout is not None
        server = int(owner.stdout.readline())
        assert alive(server)
        owner.kill()
    wait_until(lambda: not alive(server))
    with EmbeddedServer(tmp_path):
        pass


def test_sigkill_loses_no_accepted_job(tmp_path: Path) -> None:
    with EmbeddedServer(tmp_path) as server:
        accepted = [submit(connect(server.url), f"job {number}") for number in range(20)]
        os.kill(server.pid, signal.SIGKILL)
    with EmbeddedServer(tmp_path) as server:
        store = connect(server.url)
        assert list(store.queue.waiting()) == accepted
        assert {record.id for record in store.jobs.live()} == set(accepted)
        assert all(store.jobs.problem(job_id) for job_id in accepted)


def test_a_server_that_cannot_start_says_why(tmp_path: Path) -> None:
    (tmp_path / "appendonlydir").write_text("in the way")
    with pytest.raises(StoreUnavailable, match="did not start"):
        EmbeddedServer(tmp_path).start()
    (tmp_path / "appendonlydir").unlink()
    with EmbeddedServer(tmp_path):
        pass


def test_without_the_wheel_the_mend_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(embedded, "find_spec", lambda _: None)
    with pytest.raises(StoreUnavailable) as caught:
        embedded.binary()
    assert "REDIS_URL" in caught.value.hint

"""The worker on top of RQ: one queue, a fork for each job, quick to see and mend a death."""

import logging
import math
import os
import signal
import time
from types import FrameType
from typing import TYPE_CHECKING, Any

from redis import Redis
from rq import Queue, Worker
from rq.job import Job
from rq.serializers import JSONSerializer
from rq.timeouts import UnixSignalDeathPenalty

from schemas.errors import StoreUnavailable, UnknownJob
from schemas.jobs import JobStatus
from store.backend.queue import open_queue
from store.ports import Store
from worker import limits
from worker.presence import Presence
from worker.recovery import WORKED_ON, Loss, Sweep, settle
from worker.settings import WorkerSettings

if TYPE_CHECKING:
    from redis.client import Pipeline

logger = logging.getLogger("footfall.worker")


_TOLD_TO_END = Loss(how="its worker was told to end", blameless=True)


class FineAlarm(UnixSignalDeathPenalty):
    """RQ's alarm, also for parts of a second."""

    def setup_death_penalty(self) -> None:
        """Start the alarm."""
        signal.signal(signal.SIGALRM, self.handle_death_penalty)
        signal.setitimer(signal.ITIMER_REAL, self._timeout)

    def cancel_death_penalty(self) -> None:
        """Stop it."""
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, signal.SIG_DFL)


class FootfallWorker(Worker):
    """Takes ids from the queue and forks a process for each.

    RQ delivers, forks, waits and stops; the records, not RQ's registries, say what becomes of a
    job. RQ's retries are off: a lost attempt is handed on by ``worker.recovery`` alone.
    ``glance`` is the same store without patience.
    """

    death_penalty_class = FineAlarm

    def __init__(
        self,
        client: Redis,
        store: Store,
        glance: Store,
        settings: WorkerSettings,
        presence: Presence,
    ) -> None:
        self._settings = settings
        self._store = store
        self._glance = glance
        self._presence = presence
        self._sweep = Sweep(store, settings)
        self._on_job = ""
        self._signal = 0
        self._leaving = False
        self._cancel_seen: float | None = None
        super().__init__(
            [open_queue(client)],
            name=presence.name,
            connection=client,
            serializer=JSONSerializer,
            maintenance_interval=math.ceil(settings.maintenance),
            worker_ttl=math.ceil(settings.ttl),
            job_monitoring_interval=settings.tick,  # FineAlarm allows parts of a second
            log_job_description=False,
        )

    # Times: RQ adds a minute and more to each of these.

    @property
    def dequeue_timeout(self) -> int:
        """Seconds of one blocking read; between two, heartbeat and sweep."""
        return max(1, int(min(self._settings.ttl / 3, self._settings.maintenance)))

    def get_heartbeat_ttl(self, job: Job) -> int:  # noqa: ARG002 - RQ's signature
        """Seconds for which RQ believes that a job lives."""
        return math.ceil(self._settings.ttl)

    def heartbeat(self, timeout: int | None = None, pipeline: "Pipeline | None" = None) -> None:  # noqa: ARG002
        """Tell that this worker lives; called by RQ on every turn of its loops."""
        super().heartbeat(math.ceil(self._settings.ttl), pipeline)
        if not self.is_horse:
            self._presence.tell(self._on_job)

    # Between jobs, and during one.

    def run_maintenance_tasks(self) -> None:
        """RQ's own housekeeping, then ours."""
        super().run_maintenance_tasks()  # type: ignore[no-untyped-call]
        self._sweep.run()

    def maintain_heartbeats(self, job: Job) -> None:
        """On every tick of a running job: tell, look for a cancel, look for lost jobs."""
        super().maintain_heartbeats(job)
        self._enforce_cancel(job.id)
        if self._sweep.due():
            self._sweep.run()

    def _enforce_cancel(self, job_id: str) -> None:
        """Kill the process if it was asked to stop and has not; no message can be lost here."""
        try:
            wanted = self._store.jobs.get(job_id).status is JobStatus.CANCELLING
        except UnknownJob:
            wanted = True
        now = time.monotonic()
        if not wanted:
            self._cancel_seen = None
        elif self._cancel_seen is None:
            self._cancel_seen = now
        elif now - self._cancel_seen >= self._settings.kill_after and self.horse_pid:
            self._stopped_job_id = job_id
            self.kill_horse()

    # One job.

    def execute_job(self, job: Job, queue: Queue) -> None:
        """Fork, wait, and settle what the process left undone."""
        self._on_job, self._signal, self._cancel_seen = job.id, 0, None
        self._presence.tell(job.id)
        super().execute_job(job, queue)
        self._settle(_TOLD_TO_END if self._leaving else self._loss())
        self._on_job = ""

    def _loss(self) -> Loss:
        how = f"its process was killed by signal {self._signal}" if self._signal else ""
        return Loss(how=how or "its process ended early", killed=True)

    def request_force_stop(self, signum: int, frame: FrameType | None) -> None:
        """A second signal: the job is handed back without blame.

        The death of its process may be seen before the exit that RQ raises here.
        """
        self._leaving = True
        super().request_force_stop(signum, frame)

    def handle_work_horse_killed(self, job: Job, retpid: int, ret_val: int, rusage: Any) -> None:
        """Remember the signal; RQ calls this for a process that ended by itself."""
        self._signal = os.WTERMSIG(ret_val) if os.WIFSIGNALED(ret_val) else 0
        super().handle_work_horse_killed(job, retpid, ret_val, rusage)  # type: ignore[no-untyped-call]

    def main_work_horse(self, job: Job, queue: Queue) -> None:
        """The forked process begins."""
        limits.die_with(self.pid or 0)
        limits.offer_to_oom_killer()
        super().main_work_horse(job, queue)

    def teardown(self) -> None:
        """The worker ends: hand back the job that a second signal or a fault has cut off."""
        if not self.is_horse:
            if self.horse_pid:
                self.kill_horse()
            if not self._server_answers():
                logger.warning("the queue server is away; another worker will settle what is left")
                return
            self._settle(_TOLD_TO_END)
            self._store.queue.retire(self.name)
        super().teardown()  # type: ignore[no-untyped-call]

    def _server_answers(self) -> bool:
        """Whether there is anybody to say good-bye to; patience would only delay the end."""
        try:
            self._glance.ping()
        except StoreUnavailable:
            return False
        return True

    def _settle(self, loss: Loss) -> None:
        """Decide on this worker's job if its process has not."""
        if not self._on_job:
            return
        try:
            record = self._store.jobs.get(self._on_job)
        except UnknownJob:
            return
        if record.status in WORKED_ON and record.worker == self.name:
            settle(self._store, record, loss, self._settings)

"""Prometheus metrics, in a registry of each app's own. No label comes from a user's text."""

from collections.abc import Iterator

from prometheus_client import CollectorRegistry, Counter, Histogram, generate_latest
from prometheus_client.core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from schemas.errors import StoreUnavailable
from schemas.jobs import TERMINAL, JobStatus
from store.ports import Store


class Metrics:
    """What one app counts. ``route`` is always the template, never the path."""

    def __init__(self, store: Store) -> None:
        self._registry = CollectorRegistry()
        self._requests = Counter(
            "footfall_requests",
            "Requests answered.",
            ["method", "route", "status"],
            registry=self._registry,
        )
        self._seconds = Histogram(
            "footfall_request_seconds",
            "Time to the last byte of an answer; streams and long polls included.",
            ["route"],
            registry=self._registry,
        )
        self._jobs = Counter("footfall_jobs_accepted", "Jobs accepted.", registry=self._registry)
        self._registry.register(_StoreState(store))

    def answered(self, method: str, route: str, status: int, seconds: float) -> None:
        """Count one request."""
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(route).observe(seconds)

    def accepted(self) -> None:
        """Count one new job."""
        self._jobs.inc()

    def page(self) -> bytes:
        """The exposition text."""
        return generate_latest(self._registry)


class _StoreState(Collector):
    """Reads the live jobs and the workers at each scrape."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def describe(self) -> Iterator[Metric]:
        """Nothing ahead of time: registering must not open a connection."""
        return iter(())

    def collect(self) -> Iterator[Metric]:
        """The gauges as they are now; without the store only that it is away."""
        try:
            live, workers = self._store.jobs.live(), self._store.queue.workers()
        except StoreUnavailable:
            yield GaugeMetricFamily("footfall_store_up", "Whether the queue server answers.", 0)
            return
        yield GaugeMetricFamily("footfall_store_up", "Whether the queue server answers.", 1)
        jobs = GaugeMetricFamily("footfall_jobs", "Jobs that have not ended.", labels=["status"])
        for status in set(JobStatus) - TERMINAL:
            jobs.add_metric([status], sum(job.status is status for job in live))
        yield jobs
        yield GaugeMetricFamily("footfall_workers", "Live workers.", len(workers))

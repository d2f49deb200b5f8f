# A worker with the engine. Build from the repository's root:
#   docker build -f docker/worker.Dockerfile -t footfall-worker .
FROM python:3.12-slim AS build
WORKDIR /build
RUN python -m venv /opt/footfall
COPY pyproject.toml requirements.lock ./
COPY sdk/ sdk/
COPY schemas/ schemas/
COPY store/ store/
COPY solver/ solver/
COPY worker/ worker/
RUN /opt/footfall/bin/pip install --no-cache-dir -c requirements.lock ./sdk '.[worker]'

FROM python:3.12-slim
RUN useradd --system --uid 10001 --no-create-home --shell /usr/sbin/nologin footfall
COPY --from=build /opt/footfall /opt/footfall
ENV PATH=/opt/footfall/bin:$PATH PYTHONUNBUFFERED=1
USER footfall
HEALTHCHECK --interval=15s --timeout=10s --start-period=20s --retries=3 \
    CMD ["python", "-m", "worker", "--check"]
CMD ["python", "-m", "worker"]

# The HTTP side alone: no casadi, no scipy, no solver. Build from the repository's root:
#   docker build -f docker/api.Dockerfile -t footfall-api .
FROM python:3.12-slim AS build
WORKDIR /build
RUN python -m venv /opt/footfall
COPY pyproject.toml requirements.lock ./
COPY sdk/ sdk/
COPY schemas/ schemas/
COPY store/ store/
COPY examples/ examples/
COPY api/ api/
RUN /opt/footfall/bin/pip install --no-cache-dir -c requirements.lock ./sdk '.[api]'

FROM python:3.12-slim
RUN useradd --system --uid 10001 --no-create-home --shell /usr/sbin/nologin footfall
COPY --from=build /opt/footfall /opt/footfall
ENV PATH=/opt/footfall/bin:$PATH PYTHONUNBUFFERED=1 FOOTFALL_HOST=0.0.0.0 FOOTFALL_PORT=8000
USER footfall
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=5s --start-period=20s --retries=3 \
    CMD ["python", "-c", "from urllib.request import urlopen; urlopen('http://127.0.0.1:8000/livez')"]
CMD ["python", "-m", "api"]

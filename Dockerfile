# The image runs `teamformer`: docker run --rm -v "$PWD:/work" teamformer run mission.yaml --out out/
# `make wheel` compiles the kernels in the first stage, so that a first run compiles nothing.
FROM python:3.13-bookworm AS build
WORKDIR /src
COPY . .
RUN make wheel PYTHONS=python3.13 \
    && python3.13 -m venv /opt/teamformer \
    && /opt/teamformer/bin/pip install --no-cache-dir --no-compile dist/*.whl \
    && /opt/teamformer/bin/pip uninstall --yes pip

FROM python:3.13-slim-bookworm
COPY --from=build /opt/teamformer /opt/teamformer
ENV PATH=/opt/teamformer/bin:$PATH HOME=/tmp NUMBA_CACHE_DIR=/tmp/teamformer PYTHONDONTWRITEBYTECODE=1
USER 1000:1000
WORKDIR /work
ENTRYPOINT ["teamformer"]
CMD ["--help"]

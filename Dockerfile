# as2fm-lsp with the compiled kernel:  docker build -t as2fm-lsp . && docker run --rm -v "$PWD:/models" as2fm-lsp --check .
FROM python:3.12-slim AS build
RUN apt-get update && apt-get install --yes --no-install-recommends gcc libc6-dev && rm -rf /var/lib/apt/lists/*
COPY pyproject.toml setup.py MANIFEST.in README.md LICENSE /source/
COPY server /source/server
COPY schemas /source/schemas
RUN python -m venv /opt/as2fm && /opt/as2fm/bin/pip install --no-cache-dir /source

FROM python:3.12-slim
COPY --from=build /opt/as2fm /opt/as2fm
RUN useradd --create-home robot
USER robot
WORKDIR /models
ENTRYPOINT ["/opt/as2fm/bin/as2fm-lsp"]
CMD ["--check", "."]

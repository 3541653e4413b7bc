# Two images: `docker build --tag moseg .` runs the program; `docker build --target cluster --tag moseg-cluster .` has no
# entry point, because Dask and Kubernetes give the whole command.
ARG PYTHON=3.11.14-slim-bookworm

FROM python:${PYTHON} AS build
# The extras to install, for instance cluster,models for networks.
ARG EXTRAS=cluster
# pip applies these versions to the build requirements too.
ENV PIP_CONSTRAINT=/source/constraints.txt \
    PIP_DISABLE_PIP_VERSION_CHECK=1 \
    PIP_NO_CACHE_DIR=1
RUN python -m venv /opt/moseg
WORKDIR /source
COPY . .
RUN /opt/moseg/bin/pip install ".[${EXTRAS}]"

FROM python:${PYTHON} AS cluster
COPY --from=build /opt/moseg /opt/moseg
# Any user can run the program, also one that has no name here: `--user "$(id -u):$(id -g)"`.
RUN useradd --uid 1000 --create-home moseg \
    && mkdir /work \
    && chmod 1777 /home/moseg /work
# The store outlives the container, because it lies in the folder that is mounted.
ENV HOME=/home/moseg \
    MOSEG_STORE=/work/.moseg/store \
    PATH=/opt/moseg/bin:$PATH \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1
USER 1000:1000
WORKDIR /work

FROM cluster AS moseg
ENTRYPOINT ["moseg"]
CMD ["--help"]

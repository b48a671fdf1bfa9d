# projdyn with library and headers in /usr/local, on Debian 12. Without `projdyn view`, whose server answers its own
# machine only.
#
#     docker build -t projdyn .
#     docker run --rm -v "$PWD:/work" --user "$(id -u):$(id -g)" projdyn run scenes/dam_break.json
FROM debian:bookworm-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends \
    gcc libc6-dev meson pkg-config python3 libsuitesparse-dev libjansson-dev zlib1g-dev
COPY . /source
WORKDIR /source
RUN meson setup /build --libdir=lib -Dview=disabled -Dtests=false -Dbench=false -Dexamples=false \
    && ninja -C /build \
    && DESTDIR=/installed meson install -C /build --no-rebuild

FROM debian:bookworm-slim
RUN apt-get update \
    && apt-get install -y --no-install-recommends libcholmod3 libjansson4 zlib1g \
    && rm -rf /var/lib/apt/lists/*
COPY --from=build /installed /
RUN ldconfig
WORKDIR /work
ENTRYPOINT ["projdyn"]

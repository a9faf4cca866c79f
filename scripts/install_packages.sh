#!/usr/bin/env bash
# Installs the Debian or Ubuntu packages that are missing; needs neither network nor root when all are there.
#   scripts/install_packages.sh build   what building and running needs
#   scripts/install_packages.sh test    and what the tests need
#   scripts/install_packages.sh publish   and emscripten for the engine of a page, and Firefox
#   scripts/install_packages.sh qgis    and QGIS, for the tests of its plugin
set -euo pipefail

packages=(g++ cmake ninja-build pkg-config git libgdal-dev gdal-bin libtbb-dev libhwy-dev libpng-dev libtomlplusplus-dev libcli11-dev
          nlohmann-json3-dev libfmt-dev libgtest-dev libgmock-dev libboost-dev libssl-dev zlib1g-dev
          libopenmpi-dev openmpi-bin libnlopt-dev libkainjow-mustache-dev libmosquitto-dev)
# Node.js builds the page; like the browser of the tests, it also comes from elsewhere than the distribution's packages.
node_version=$(node --version 2>/dev/null || echo v0)
node_version=${node_version#v}
if ((${node_version%%.*} < 18)); then packages+=(nodejs); fi
command -v npm >/dev/null || packages+=(npm)
if [[ ${1:-build} == publish ]]; then
    packages+=(emscripten)
    # Ubuntu has Firefox as a snap alone.
    if grep -qs '^ID=debian' /etc/os-release; then packages+=(firefox-esr xvfb libegl1 libgl1 libgl1-mesa-dri libpci3); fi
fi
if [[ ${1:-build} == qgis ]]; then packages+=(qgis python3-qgis python3-gdal python3-numpy); fi
if [[ ${1:-build} == test ]]; then
    packages+=(libbenchmark-dev clang-format clang-tidy python3 python3-gdal python3-numpy python3-pip mypy poppler-utils
               python3-matplotlib python3-xarray python3-geopandas mosquitto mosquitto-clients)
    command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null ||
        packages+=(chromium)
fi

if ! command -v dpkg-query >/dev/null; then
    echo "This is not Debian or Ubuntu. Make sure that the equivalents of these packages are installed:" >&2
    echo "  ${packages[*]}" >&2
    exit 0
fi

missing=()
for package in "${packages[@]}"; do
    if [[ $(dpkg-query --show --showformat '${db:Status-Status}' "$package" 2>/dev/null) != installed ]]; then
        missing+=("$package")
    fi
done
if ((${#missing[@]} == 0)); then exit 0; fi

echo "Installing: ${missing[*]}"
as_root=(env DEBIAN_FRONTEND=noninteractive)
if ((EUID != 0)); then as_root=(sudo "${as_root[@]}"); fi
"${as_root[@]}" apt-get update
"${as_root[@]}" apt-get install --yes --no-install-recommends "${missing[@]}"

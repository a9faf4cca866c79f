#!/usr/bin/env bash
# Installs what building needs, builds the program, and makes a package for Debian and a relocatable archive of it:
# build/package/talus_<version>_<architecture>.deb and build/package/talus-<version>-Linux.tar.gz
#   scripts/package.sh          makes them
#   scripts/package.sh --test   installs the package into a fresh Debian 12 in a temporary folder, as root, and runs what it holds
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install_packages.sh build
cmake --preset release
cmake --build --preset release --target talus libtalus manuals --parallel "$(nproc)"
rm -rf build/package
for kind in DEB TGZ; do
    cpack --config build/release/CPackConfig.cmake -G "$kind" -B build/package
done
rm -rf build/package/_CPack_Packages
ls -l build/package
[[ ${1:-} == --test ]] || exit 0

package=$(realpath build/package/*.deb)
if ! command -v debootstrap >/dev/null; then apt-get install --yes --no-install-recommends debootstrap; fi
root=$(mktemp --directory)
leave() {
    umount "$root/proc" 2>/dev/null || true
    rm -rf "$root"
}
trap leave EXIT
# From where this machine takes its own packages.
mirror=$(apt-cache policy base-files | awk '/ https?:/ && !found { print $2; found = 1 }')
debootstrap --variant=minbase bookworm "$root" "$mirror"
mount -t proc proc "$root/proc"
cp "$package" "$root/talus.deb"
cp examples/embed.c "$root/embed.c"
inside() {
    chroot "$root" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"
}
inside apt-get install --yes --no-install-recommends /talus.deb
inside talus --version
inside talus run --quiet -o /result --set solver.target_particle_count=1000 --set solver.end_time_s=5
inside test -s /result/report.html
inside talus scene check /usr/share/talus/scenes/sham_tseng/scene.toml >/dev/null
inside test -s /usr/share/qgis/python/plugins/talus_processing/icon.svg
inside test -s /usr/share/man/man1/talus-run.1.gz -o -s /usr/share/man/man1/talus-run.1
# The library, for a program in C.
inside apt-get install --yes --no-install-recommends gcc libc6-dev pkg-config
inside sh -c 'gcc -std=c11 -o /embed /embed.c $(pkg-config --cflags --libs talus) -lm && /embed'
inside apt-get install --yes --no-install-recommends python3-numpy
inside python3 -c 'import talus; s = talus.Simulation(settings={"solver.target_particle_count": 500}); s.advance(2); print("Python:", talus.__version__, s.hash)'
inside apt-get remove --yes talus
if inside sh -c 'command -v talus'; then
    echo "scripts/package.sh: the package leaves talus behind when it is removed" >&2
    exit 1
fi
echo "the package installs, runs and goes in a fresh Debian 12"

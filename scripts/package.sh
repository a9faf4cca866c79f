#!/usr/bin/env bash
# Installs what building needs, builds the engine of published twins and the program, and makes packages for Debian and a relocatable archive in build/package:
# talus, libtalus<version>, libtalus-dev, python3-talus and talus-doc as .deb, talus-<version>-Linux.tar.gz, and talus-engine-<version>.tgz for npm
#   scripts/package.sh          makes them
#   scripts/package.sh --test   checks the packages with lintian, installs them into a fresh Debian 12 in a temporary folder, as
#                               root, and runs what they hold
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install_packages.sh publish
apps/web_engine/build.sh build/web_engine # before the program, which takes it in
cmake --preset release
cmake --build --preset release --target talus libtalus manuals --parallel "$(nproc)"
rm -rf build/package
# Debian wants libraries in a folder of the architecture; the archive, last, leaves the build folder as it was.
for kind in DEB TGZ; do
    if [[ $kind == DEB ]]; then libraries=lib/$(g++ -print-multiarch); else libraries=lib; fi
    cmake --preset release -D CMAKE_INSTALL_LIBDIR="$libraries"
    cpack --config build/release/CPackConfig.cmake -G "$kind" -B build/package
done
rm -rf build/package/_CPack_Packages
if command -v python3 >/dev/null; then
    python3 python/make_wheel.py build/release/apps/embed/libtalus.so build/release/bin/talus build/package
else
    echo "scripts/package.sh: no wheel is made: python3 is not installed" >&2
fi
if [[ -s build/web_engine/talus_engine.wasm ]] && command -v npm >/dev/null; then
    web/engine_package/pack.sh build/web_engine build/package
else
    echo "scripts/package.sh: no package for npm is made: npm or build/web_engine/talus_engine.wasm is not there" >&2
fi
ls -l build/package
[[ ${1:-} == --test ]] || exit 0

if ! command -v lintian >/dev/null; then apt-get install --yes --no-install-recommends lintian; fi
lintian --fail-on error,warning build/package/*.deb
archive=$(realpath build/package/*.tar.gz)
if ! command -v debootstrap >/dev/null; then apt-get install --yes --no-install-recommends debootstrap; fi
root=$(mktemp --directory)
leave() {
    umount "$root/proc" "$root/dev/pts" 2>/dev/null || true
    rm -rf "$root"
}
trap leave EXIT
# From where this machine takes its own packages.
mirror=$(apt-cache policy base-files | awk '/ https?:/ && !found { print $2; found = 1 }')
debootstrap --variant=minbase bookworm "$root" "$mirror"
mount -t proc proc "$root/proc"
mount --bind /dev/pts "$root/dev/pts" # zsh completes in a terminal
# minbase leaves out the manual pages and documentation of packages only where it is told to; here they are looked at.
rm -f "$root"/etc/dpkg/dpkg.cfg.d/*doc*
inside() {
    # Nothing of this machine's environment: a compiler launcher of the caller is not in there.
    chroot "$root" env --ignore-environment PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/root TERM=xterm "$@"
}
install_inside() {
    inside apt-get install --yes --no-install-recommends "$@"
}
# $1 says what must hold: a command inside the fresh Debian.
check() {
    local what=$1
    shift
    if ! inside "$@"; then
        echo "scripts/package.sh: $what: failed" >&2
        exit 1
    fi
    echo "ok: $what"
}

# The archive first, where nothing else of talus is: unpacked, then moved.
mkdir "$root/unpacked"
tar --extract --file "$archive" --directory "$root/unpacked"
mv "$root"/unpacked/talus-* "$root/opt/moved"
mkdir "$root/packages"
for package in build/package/*.deb; do
    name=$(basename "$package")
    cp "$package" "$root/packages/${name%%_*}.deb"
done
library=$(basename "$root"/packages/libtalus[0-9]*.deb .deb)
# What the package depends on, without the package.
inside sh -c 'apt-get install --yes --no-install-recommends $(dpkg --field /packages/talus.deb Depends | tr "," "\n" | sed "s/(.*//; s/|.*//")'
check "the archive runs where it was unpacked" /opt/moved/bin/talus --version
check "the archive runs a scene" /opt/moved/bin/talus run --quiet -o /result_of_archive \
    --set solver.target_particle_count=500 --set solver.end_time_s=5
install_inside python3-numpy
check "the archive's Python package" env PYTHONPATH=/opt/moved/lib/python3/dist-packages python3 -c '
import talus
assert talus.__file__.startswith("/opt/moved/"), talus.__file__
simulation = talus.Simulation(settings={"solver.target_particle_count": 500})
simulation.advance(1)'
inside apt-get purge --yes python3-numpy >/dev/null

install_inside /packages/talus.deb
check "talus --version says version, commit, instruction set, backends" sh -c \
    'talus --version | tr "\n" " " | grep -E "^talus [0-9.]+ commit [0-9a-f]+ instruction set [A-Z0-9]+, of .* backends cpu"'
check "talus -V says the same" sh -c '[ "$(talus -V)" = "$(talus --version)" ]'
check "talus run" talus run --quiet -o /result --set solver.target_particle_count=1000 --set solver.end_time_s=5
check "its report" test -s /result/report.html
check "a scene that was installed" talus scene check /usr/share/talus/scenes/sham_tseng/scene.toml
check "neither library nor Python package came with it" sh -c '! ls /usr/lib/*/libtalus* /usr/lib/python3/dist-packages/talus 2>/dev/null'
check "talus publish, with the engine" sh -c \
    'talus publish --quiet -o /twin.html --set solver.target_particle_count=500 --set solver.end_time_s=5 && grep -q wasm-unsafe-eval /twin.html'
check "the plugin for QGIS" test -s /usr/share/qgis/python/plugins/talus_processing/icon.svg

# Manual pages, completion, menu entry: in what reads them.
install_inside man-db bash-completion zsh desktop-file-utils libfile-mimeinfo-perl
inside mandb --quiet
check "man talus" sh -c 'man talus | grep -q "talus run"'
check "man talus-run" sh -c 'man talus-run | grep -q -e --convergence'
check "apropos" sh -c 'apropos talus-run | grep -q "talus-run (1)"'
check "bash completes commands" bash -c '
    . /usr/share/bash-completion/bash_completion
    _completion_loader talus
    COMP_WORDS=(talus ense) COMP_CWORD=1 COMP_LINE="talus ense" COMP_POINT=10
    $(complete -p talus | sed "s/.* -F \([^ ]*\).*/\1/") talus ense talus
    [[ " ${COMPREPLY[*]} " == *" ensemble"* ]]'
# zsh completes in a terminal only: one of its own, in which the tab key is pressed.
zsh_completes() {
    check "zsh completes $1" env BEGUN="$1" ENDED="$2" zsh -f -c '
    zmodload zsh/zpty
    zpty shell "zsh -f -i"
    zpty -w shell "PS1=; autoload -Uz compinit; compinit -u -D; print rea\"\"dy"
    zpty -r -t shell seen "*ready*" || { sleep 2; zpty -r -t shell seen "*ready*"; }
    zpty -w -n shell "$BEGUN"$'"'\t'"'
    for try in {1..50}; do
        zpty -r -t shell more && seen+=$more
        [[ $seen == *${~ENDED}* ]] && exit 0
        sleep 0.1
    done
    print -r -- "$seen"; exit 1'
}
zsh_completes "talus ense" "ense*mble" # the bell rings between them
zsh_completes "talus run --set material.friction_co" "friction_co*efficient="
zsh_completes "talus run --set solver.model=dep" "model=dep*th_averaged"
check "the menu entry" desktop-file-validate /usr/share/applications/talus.desktop
check "a scene is known as one" sh -c '[ "$(mimetype --brief /usr/share/talus/scenes/sham_tseng/scene.toml)" = application/x-talus-scene ]'
check "its icon" test -s /usr/share/icons/hicolor/scalable/apps/talus.svg

install_inside /packages/talus-doc.deb
check "what manual pages name" sh -c '
    zcat /usr/share/man/man1/talus*.gz | tr -d "\\\\" | grep -o "docs/[a-z-]*\.md" | sort -u >/named && test -s /named
    while read -r page; do test -s "/usr/share/doc/talus/$page" || { echo "$page"; exit 1; }; done </named'

# The library, for a program in C.
install_inside "/packages/$library.deb" /packages/libtalus-dev.deb
check "the loader knows the library" sh -c 'ldconfig -p | grep -q libtalus.so'
install_inside gcc g++ make libc6-dev pkg-config cmake
mkdir "$root/embed"
inside cp /usr/share/doc/talus/examples/embed.c /embed/
check "a program in C with pkg-config" sh -c 'cd /embed && gcc -std=c11 -o with_pkg_config embed.c $(pkg-config --cflags --libs talus) -lm && ./with_pkg_config'
cat >"$root/embed/CMakeLists.txt" <<'PROJECT'
cmake_minimum_required(VERSION 3.20)
project(embed C)
find_package(talus 0.1 REQUIRED)
add_executable(with_cmake embed.c)
target_link_libraries(with_cmake PRIVATE talus::talus m)
PROJECT
check "a program in C with CMake" sh -c 'cd /embed && cmake -S . -B build >/dev/null && cmake --build build >/dev/null && build/with_cmake'
check "a program in C with CMake, on the archive" sh -c \
    'cd /embed && cmake -S . -B moved -D CMAKE_PREFIX_PATH=/opt/moved >/dev/null && grep -q "talus_DIR:PATH=/opt/moved" moved/CMakeCache.txt && cmake --build moved >/dev/null && moved/with_cmake'
check "only talus.h is visible in the library" sh -c \
    'nm --dynamic --defined-only /usr/lib/*/libtalus.so >/exported && grep -q " T talus_" /exported && ! grep -v -E " [TA] (talus_|TALUS_)" /exported'

install_inside /packages/python3-talus.deb
check "import talus" python3 -c '
import talus
simulation = talus.Simulation(settings={"solver.target_particle_count": 500})
simulation.advance(2)
print("Python:", talus.__version__, simulation.hash)'
# The tests of the Python package, on the one that is installed, with the notebooks that are.
mkdir -p "$root/python/tests" "$root/python/examples"
cp -r tests/python "$root/python/tests/"
inside ln -s /usr/share/doc/talus/examples/notebooks /python/examples/notebooks
mkdir -p "$root/python/scenes"
cp -r examples/risk "$root/python/examples/"
cp -r scenes/sham_tseng "$root/python/scenes/"
check "the tests of the Python package" python3 -m unittest discover --start-directory /python/tests/python

inside apt-get remove --yes talus talus-doc "$library"
if inside sh -c 'command -v talus || ls -d /usr/share/talus /usr/lib/*/libtalus* /usr/lib/python3/dist-packages/talus /usr/share/doc/*talus*' 2>/dev/null; then
    echo "scripts/package.sh: the packages leave files behind when they are removed" >&2
    exit 1
fi
echo "the packages install, run and go in a fresh Debian 12"

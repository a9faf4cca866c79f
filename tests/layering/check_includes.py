"""Rejects includes that point the wrong way through the layers of src/ and apps/, and namespaces that are not their folder.

    check_includes.py ROOT        checks the sources, prints every offence
    check_includes.py --self-test checks that the rules below reject what they should
"""

import pathlib
import re
import sys

# A layer may include those named here and itself; terrain and simd, sim and geo, observe and scene do
# not know each other, nor do ensemble, validate, bench and twin, which stand beside each other on products.
BELOW = {
    "core": [],
    "params": ["core"],
    "terrain": ["core", "params"],
    "simd": ["core"],
    "sim": ["core", "params", "terrain", "simd"],
    "depth": ["core", "params", "terrain", "simd", "sim"],
    "geo": ["core", "params", "terrain"],
    "observe": ["core", "params", "terrain", "simd", "sim", "depth", "geo"],
    "scene": ["core", "params", "terrain", "simd", "sim", "geo"],
    "pack": ["core", "params", "terrain", "simd", "sim", "geo", "scene"],
    "run": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene"],
    "report": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run"],
    "products": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report"],
    "stats": ["core"],
    "ensemble": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products", "stats"],
    "calibrate": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products", "stats", "ensemble"],
    "design": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products", "stats", "ensemble"],
    "risk": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products", "stats", "ensemble"],
    "validate": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products"],
    "bench": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products"],
    "messages": [],
    "twin": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products", "messages"],
    "session": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products", "stats", "ensemble",
                "messages", "twin"],
    "publish": ["core"],
    "serve": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products", "stats", "ensemble",
              "calibrate", "design", "risk", "validate", "messages", "twin", "session", "publish", "pack"],
    "apps": ["core", "params", "terrain", "simd", "sim", "depth", "geo", "observe", "scene", "run", "report", "products", "stats", "ensemble",
             "calibrate", "design", "risk", "validate", "bench", "messages", "twin", "session", "publish", "serve", "pack"],
}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
NAMESPACE = re.compile(r"^namespace (talus\b[\w:]*) \{")
OWN_NAMESPACE = {"sim/cpu", "sim/device", "sim/reference", "sim/stages", "observe/device"}  # folders within a module
GDAL = re.compile(r"^(gdal|ogr|cpl_|proj\b|proj\.h)")
TESTING = re.compile(r"^(tests|support|gtest|gmock)/")
BOOST = re.compile(r"^boost/")
ALONE = re.compile(r"^(thread|mutex|shared_mutex|condition_variable|future|filesystem|fstream|tbb/|oneapi/|netinet/|sys/socket)")
THIRD_PARTY = re.compile(r"^(fmt|spdlog|nlohmann|toml\+\+|CLI|tbb|oneapi|boost)/|^toml\.hpp")


def offence(layer, name):
    """Why a file of `layer` may not include `name`; None if it may."""
    if TESTING.match(name):
        return "only tests include tests"
    if GDAL.match(name) and layer != "geo":
        return "only src/geo includes GDAL and PROJ"
    if BOOST.match(name) and layer != "serve" and not (layer == "stats" and name.startswith(("boost/random/", "boost/math/"))):
        return "only src/serve includes Boost, and src/stats its random sequences and distributions"
    if ALONE.match(name) and layer == "session":
        return "a session knows no thread, socket or file: time and work are given to it"
    if THIRD_PARTY.match(name) and layer == "core":
        return "core uses the standard library only"
    if name.startswith("../"):
        return "write the path from src/, without .."
    target = name.split("/")[0]
    if "/" in name and target in BELOW and target != layer and target not in BELOW[layer]:
        return f"{layer} lies below {target} or beside it"
    return None


def layer_of(path):
    """The layer of a source file, given relative to the root; None outside the layers."""
    parts = path.parts
    if parts[0] == "apps":
        return "apps"
    return parts[1] if parts[0] == "src" and parts[1] in BELOW else None


def misplaced(path, name):
    """Whether a file, given relative to the root, may not open the namespace `name`."""
    folder = "/".join(path.parent.parts[1:])
    if path.parts[0] == "src":
        folder = folder if folder in OWN_NAMESPACE else path.parts[1]
    if folder == "core":
        return name != "talus"
    if name == "talus" and path.as_posix() == "src/simd/lanes.hpp":
        return False  # adds to a formula of core
    return not (name + "::").startswith("talus::" + folder.replace("/", "::") + "::")


def reached(root, path, seen):
    """GDAL, PROJ or Boost among all that a file, given relative to the root, includes; None if none."""
    for line in (root / path).read_text().splitlines():
        match = INCLUDE.match(line)
        if match is None:
            continue
        if GDAL.match(match[2]) or BOOST.match(match[2]):
            return f"{path} includes {match[2]}"
        below = pathlib.Path("src") / match[2]
        if below not in seen and (root / below).is_file():
            seen.add(below)
            found = reached(root, below, seen)
            if found:
                return found
    return None


def check(root):
    offences = []
    files = [f for top in ("src", "apps") for f in (root / top).rglob("*") if f.suffix in (".hpp", ".cpp", ".cu")]
    for file in sorted(files):
        path = file.relative_to(root)
        layer = layer_of(path)
        if layer is None:
            offences.append(f"{path}: this folder is in no layer; name it in tests/layering/check_includes.py")
            continue
        found = layer == "session" and reached(root, path, set())
        if found:
            offences.append(f"{path}: a session is for a page, too, but {found}")
        for number, line in enumerate(file.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            reason = match and offence(layer, match[2])
            if reason:
                offences.append(f"{path}:{number}: includes {match[2]}: {reason}")
            match = NAMESPACE.match(line)
            if match and misplaced(path, match[1]):
                offences.append(f"{path}:{number}: {match[1]} is not the namespace of this folder")
    if not files:
        offences.append(f"{root}: no sources found")
    return offences


def self_test():
    rejected = [("core", "params/spec.hpp"), ("core", "fmt/format.h"), ("sim", "geo/raster.hpp"),
                ("geo", "sim/state.hpp"), ("core", "simd/lanes.hpp"), ("terrain", "simd/lanes.hpp"), ("observe", "run/run.hpp"), ("scene", "run/run.hpp"), ("scene", "observe/observer.hpp"),
                ("run", "products/products.hpp"), ("scene", "products/products.hpp"), ("report", "products/products.hpp"),
                ("products", "gdal_priv.h"), ("apps", "ogrsf_frmts.h"), ("scene", "cpl_conv.h"), ("products", "proj.h"),
                ("sim", "gtest/gtest.h"), ("scene", "support/fixtures.hpp"), ("sim", "../core/grid.hpp"),
                ("products", "ensemble/plan.hpp"), ("calibrate", "validate/suite.hpp"),
                ("products", "validate/suite.hpp"), ("validate", "calibrate/misfit.hpp"),
                ("bench", "validate/set_up.hpp"), ("twin", "serve/loop.hpp"), ("apps", "boost/asio.hpp"),
                ("stats", "boost/asio.hpp"), ("serve", "gdal_priv.h"), ("scene", "bench/measure.hpp"), ("products", "twin/scenario.hpp"),
                ("twin", "bench/measure.hpp"), ("sim", "depth/solver.hpp"), ("depth", "observe/observer.hpp"),
                ("depth", "scene/scene.hpp"), ("twin", "session/room.hpp"), ("session", "serve/loop.hpp"),
                ("session", "boost/asio.hpp"), ("session", "mutex"), ("session", "filesystem"), ("messages", "core/result.hpp")]
    accepted = [("params", "core/result.hpp"), ("sim", "sim/model.hpp"), ("sim", "terrain/terrain.hpp"),
                ("geo", "gdal_priv.h"), ("geo", "proj.h"), ("scene", "geo/raster.hpp"), ("apps", "products/products.hpp"),
                ("scene", "fmt/format.h"), ("core", "vector"), ("depth", "sim/physics/resistance.hpp"), ("run", "depth/solver.hpp"), ("apps", "progress.hpp"),
                ("calibrate", "report/hazard_map.hpp"), ("apps", "validate/suite.hpp"), ("validate", "report/chart.hpp"),
                ("apps", "bench/measure.hpp"), ("run", "scene/scene.hpp"), ("bench", "scene/scene.hpp"), ("apps", "twin/scenario.hpp"),
                ("twin", "products/products.hpp"), ("twin", "zlib.h"), ("stats", "boost/random/sobol.hpp"),
                ("session", "twin/scenario.hpp"), ("session", "atomic"), ("serve", "session/room.hpp"), ("serve", "mutex")]
    wrong = [f"{layer} <- {name} passes" for layer, name in rejected if offence(layer, name) is None]
    wrong += [f"{layer} <- {name} is rejected" for layer, name in accepted if offence(layer, name) is not None]
    for file, name, is_wrong in [("src/geo/raster.hpp", "talus", True), ("src/geo/raster.hpp", "talus::geometry", True),
                                 ("src/geo/raster.hpp", "talus::geo", False), ("src/core/grid.hpp", "talus", False),
                                 ("src/core/grid.hpp", "talus::core", True), ("src/sim/cpu/work.hpp", "talus::sim", True),
                                 ("src/sim/cpu/work.hpp", "talus::sim::cpu", False), ("apps/cli/run.cpp", "talus", True),
                                 ("src/sim/physics/net.hpp", "talus::sim", False), ("apps/cli/run.cpp", "talus::cli", False)]:
        if misplaced(pathlib.Path(file), name) != is_wrong:
            wrong.append(f"{file}: {name} {'passes' if is_wrong else 'is rejected'}")
    return wrong


def main():
    offences = self_test() if sys.argv[1:] == ["--self-test"] else check(pathlib.Path(sys.argv[1]).resolve())
    for line in offences:
        print(line)
    return 1 if offences else 0


if __name__ == "__main__":
    sys.exit(main())

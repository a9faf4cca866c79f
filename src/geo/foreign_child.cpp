// The child process: its limits, and the one file that it reads.
#include "geo/foreign_child.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <glob.h>
#include <new>
#include <string_view>
#include <sys/resource.h>
#include <unistd.h>
#include <vector>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "core/isolation.hpp"
#include "geo/foreign.hpp"
#include "geo/gdal.hpp"

namespace talus::geo {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 20> plain_formats = {
    "GTiff", "COG", "AAIGrid", "GPKG",    "GeoJSON", "GeoJSONSeq", "ESRI Shapefile", "FlatGeobuf", "CSV",   "PNG",
    "JPEG",  "XYZ", "SRTMHGT", "USGSDEM", "EHdr",    "SAGA",       "GSAG",           "GSBG",       "GS7BG", "ENVI"};
constexpr std::array<std::string_view, 6> isolated_formats = {"HFA", "netCDF", "HDF5", "JP2OpenJPEG", "KML", "LIBKML"};

template <class List>
bool holds(const List& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
}

/// What the readers of GDAL, PROJ and the C library open beside the file: tables that are installed with them.
std::vector<fs::path> installed_tables() {
    std::vector<fs::path> tables;
    const CPLStringList proj(OSRGetPROJSearchPaths());
    tables.assign(proj.List(), proj.List() + proj.size());
    if (const char* file = CPLFindFile("gdal", "gdalvrt.xsd")) tables.push_back(fs::path(file).parent_path());
    for (const char* pattern : {"/usr/lib/*/gconv", "/usr/lib64/gconv", "/usr/lib/gconv"}) {
        glob_t found{};
        if (glob(pattern, 0, nullptr, &found) == 0) {
            for (std::size_t k = 0; k < found.gl_pathc; ++k) tables.emplace_back(found.gl_pathv[k]);
        }
        globfree(&found);
    }
    return tables;
}

/// Nothing that the file says leads elsewhere, even where the kernel does not see to it.
void harden_gdal() {
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");  // no .aux.xml, which may name overviews elsewhere
    CPLSetConfigOption("CPL_VSIL_CURL_ALLOWED_FILENAME", "/vsicurl/nothing");
    CPLSetConfigOption("OGR_SQLITE_ALLOW_EXTERNAL_ACCESS", "NO");
    CPLSetConfigOption("OGR_SQLITE_LOAD_EXTENSIONS", "");
    CPLSetConfigOption("OGR_SQLITE_PRAGMA", "temp_store=2");  // in memory
    CPLSetConfigOption("GDAL_NUM_THREADS", "1");
    CPLSetConfigOption("GDAL_CACHEMAX", "64");
    CPLSetConfigOption("NUM_THREADS", "1");
    OSRSetPROJEnableNetwork(0);
}

/// The rest of standard output goes to standard error: nothing that a library prints comes between.
std::FILE* take_output() {
    const int own = dup(STDOUT_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    return own >= 0 ? fdopen(own, "wb") : nullptr;
}

/// Arguments: the word, file, kinds, bands, cells, purpose, "isolated" or "plain".
int run_child_part(const char* const* argv) {
    std::FILE* file = take_output();
    if (file == nullptr) return 1;
    ForeignOutput out(file);
    try {
        const std::string_view kinds = argv[3];
        ForeignWanted wanted;
        wanted.raster = kinds.find('r') != std::string_view::npos;
        wanted.vector = kinds.find('v') != std::string_view::npos;
        wanted.mesh = kinds.find('m') != std::string_view::npos;
        wanted.picture = kinds.find('p') != std::string_view::npos;
        wanted.styles = kinds.find('s') != std::string_view::npos;
        wanted.bands = std::atoi(argv[4]);
        wanted.cells = std::atof(argv[5]);
        wanted.purpose = argv[6];
        const rlimit nothing{0, 0}, few{256, 256};
        signal(SIGXFSZ, SIG_DFL);  // the program ignores it
        setrlimit(RLIMIT_CORE, &nothing);
        setrlimit(RLIMIT_NOFILE, &few);
        prepare_gdal();
        harden_gdal();
        Isolation isolation;
        if (std::string_view(argv[7]) == "isolated") {
            std::vector<fs::path> readable = installed_tables();
            readable.push_back(fs::absolute(argv[2]).parent_path());
            isolation = isolate(readable);
        }
        const Status done = read_foreign_file(argv[2], wanted, isolation.complete(), out);
        if (done) return out.complete() ? 0 : 1;
        // Nothing of a header that may have gone out already counts then.
        if (std::fflush(file) != 0 || std::fseek(file, 0, SEEK_SET) != 0 || ftruncate(fileno(file), 0) != 0) return 1;
        out.error(done.error().message);
    } catch (const std::bad_alloc&) {
        return 3;
    } catch (const std::exception&) {
        return 1;
    }
    return out.complete() ? 0 : 1;
}

}  // namespace

bool is_plain_format(const std::string& name) {
    return holds(plain_formats, name);
}

bool is_isolated_format(const std::string& name) {
    return holds(isolated_formats, name);
}

void forget_other_formats(bool isolated) {
    GDALDriverManager& manager = *GetGDALDriverManager();
    for (int k = manager.GetDriverCount() - 1; k >= 0; --k) {
        GDALDriver* driver = manager.GetDriver(k);
        const std::string name = driver->GetDescription();
        const bool memory = name == "MEM" || name == "Memory" || name == "HDF5Image";
        if (!memory && !is_plain_format(name) && !(isolated && is_isolated_format(name))) {
            manager.DeregisterDriver(driver);
        }
    }
}

void read_foreign(int argc, const char* const* argv) {
    if (argc != 8 || std::string_view(argv[1]) != foreign_word) return;
    _exit(run_child_part(argv));
}

}  // namespace talus::geo

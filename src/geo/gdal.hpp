#pragma once

#include <string>
#include <vector>

#include <gdal_priv.h>

#include "core/result.hpp"

/// Shared by the readers and writers of this module. Not for other modules.
namespace talus::geo {

/// Registers the drivers and prevents GDAL from writing to stderr, in any thread. Repeated calls cost nothing.
void prepare_gdal();

/// Collects GDAL's messages in this thread during its lifetime, instead of printing them to stderr.
class GdalMessages {
  public:
    GdalMessages();
    ~GdalMessages();
    GdalMessages(const GdalMessages&) = delete;
    GdalMessages& operator=(const GdalMessages&) = delete;

    [[nodiscard]] bool has_failure() const { return !failure_.empty(); }
    /// The first failure in one line (later ones are its consequences), or `otherwise`.
    [[nodiscard]] std::string failure_or(const std::string& otherwise) const;
    /// The latest warning in one line, or `otherwise`.
    [[nodiscard]] std::string warning_or(const std::string& otherwise) const;
    void clear();

  private:
    static void collect(CPLErr level, CPLErrorNum number, const char* message);

    std::string failure_, warning_;
};

/// Opens a data set with the driver whose format it is found to have, and no other: otherwise the next driver would try
/// what the first one refuses, and a text can look like several formats. Null: cannot be opened.
[[nodiscard]] GDALDatasetUniquePtr open_as_identified(const std::string& file, unsigned flags);

/// A raster of a container of several.
struct Subdataset {
    std::string name;   ///< by which GDAL opens it
    std::string layer;  ///< that of it alone, the end of the name
};
[[nodiscard]] std::vector<Subdataset> subdatasets(GDALDataset& data);

/// Opens a data set for reading, from archives too, and with FILE|layername=NAME that raster of a container
/// (file_name.hpp). `flags`: GDAL_OF_RASTER or GDAL_OF_VECTOR; `kind`: "raster", for the messages. Errors: missing, no
/// permission, a folder, empty, not recognised, no such raster.
[[nodiscard]] Result<GDALDatasetUniquePtr> open_dataset(const std::string& name, unsigned flags,
                                                        const std::string& kind);

/// What a layer of a GeoPackage says of itself that convert_foreign() wrote from GeoJSON.
inline constexpr const char* geojson_mark = "written again from GeoJSON";
/// Whether a layer is or was GeoJSON, where WGS 84 may only mean that no reference system is stated.
[[nodiscard]] bool was_geojson(GDALDataset& data, OGRLayer& layer);

/// The file name for a shell, quoted where necessary.
[[nodiscard]] std::string shell_quoted(const std::string& file);

/// A name for the corrected copy of a file, quoted for a shell: "dem.tif", "_utm", ".tif" gives "dem_utm.tif".
[[nodiscard]] std::string mended_name(const std::string& file, const std::string& suffix, const std::string& extension);

}  // namespace talus::geo

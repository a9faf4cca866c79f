#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>

#include "core/nodata.hpp"
#include "geo/cog.hpp"
#include "geo/gdal.hpp"
#include "geo/raster.hpp"
#include "geo/spatial_reference.hpp"

namespace talus::geo {

namespace {

/// A dataset in memory: north first, nodata instead of NaN.
GDALDatasetUniquePtr to_dataset(const RasterBand& band, const Crs& crs) {
    const GridGeometry& geometry = band.grid->geometry;
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("MEM");
    GDALDatasetUniquePtr data(driver->Create("", geometry.columns, geometry.rows, 1, GDT_Float32, nullptr));
    if (!data) return data;
    double transform[6] = {geometry.x_min, geometry.cell, 0, geometry.y_min + geometry.rows * geometry.cell, 0,
                           -geometry.cell};
    data->SetGeoTransform(transform);
    OGRSpatialReference reference = to_spatial_reference(crs);
    if (reference.IsEmpty() == 0) data->SetSpatialRef(&reference);
    data->SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_AREA);
    for (const auto& [key, value] : band.metadata) data->SetMetadataItem(key.c_str(), value.c_str());
    GDALRasterBand* target = data->GetRasterBand(1);
    target->SetNoDataValue(nodata_in_files);
    target->SetDescription(band.description.c_str());
    target->SetUnitType(band.unit.c_str());

    std::vector<float> line(static_cast<std::size_t>(geometry.columns));
    for (int row = 0; row < geometry.rows; ++row) {
        for (int column = 0; column < geometry.columns; ++column) {
            const float value = band.grid->at(column, row);
            line[static_cast<std::size_t>(column)] = std::isnan(value) ? nodata_in_files : value;
        }
        const CPLErr status = target->RasterIO(GF_Write, 0, geometry.rows - 1 - row, geometry.columns, 1, line.data(),
                                               geometry.columns, 1, GDT_Float32, 0, 0, nullptr);
        if (status != CE_None) return nullptr;
    }
    return data;
}

/// Writes bytes and checks every return value: a full disk is often reported only when the file is closed.
Status write_bytes(const std::string& file, const GByte* bytes, std::size_t count) {
    errno = 0;
    VSILFILE* out = VSIFOpenL(file.c_str(), "wb");
    if (out == nullptr) return Error{fmt::format("{}: cannot be written: {}", file, std::strerror(errno))};
    bool written = VSIFWriteL(bytes, 1, count, out) == count && VSIFFlushL(out) == 0;
    int cause = errno;
    if (VSIFCloseL(out) != 0) {
        if (written) cause = errno;
        written = false;
    }
    if (written) return {};
    // Removes an incomplete file, if it is a file at all.
    VSIStatBufL stat;
    if (VSIStatL(file.c_str(), &stat) == 0 && VSI_ISREG(stat.st_mode)) VSIUnlink(file.c_str());
    return Error{fmt::format("{}: cannot be written: {}", file, cause != 0 ? std::strerror(cause) : "write failed")};
}

}  // namespace

Status copy_to_cog(const std::string& file, GDALDataset& source, GdalMessages& messages, int block) {
    // The file is made in memory and written at once: GDAL's TIFF writer does not report a full disk reliably.
    static std::atomic<unsigned> serial = 0;
    const std::string memory_file = fmt::format("/vsimem/talus_cog_{}.tif", serial++);
    CPLStringList options;
    options.SetNameValue("COMPRESS", "DEFLATE");
    options.SetNameValue("PREDICTOR", "YES");
    // Cubic, the default, would put values into the overviews that no run produced.
    options.SetNameValue("OVERVIEW_RESAMPLING", "AVERAGE");
    options.SetNameValue("BLOCKSIZE", std::to_string(block).c_str());
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("COG");
    if (driver == nullptr) return Error{fmt::format("{}: this GDAL has no COG driver (3.1 or later needed)", file)};
    GDALDatasetUniquePtr made(
        driver->CreateCopy(memory_file.c_str(), &source, FALSE, options.List(), nullptr, nullptr));
    const bool created = made != nullptr;
    made.reset();  // the last bytes are written here
    const bool complete = created && !messages.has_failure();
    vsi_l_offset size = 0;
    GByte* bytes = complete ? VSIGetMemFileBuffer(memory_file.c_str(), &size, FALSE) : nullptr;
    Status status;
    if (bytes == nullptr) {
        status = Error{fmt::format("{}: cannot be made: {}", file, messages.failure_or("GDAL gave no reason"))};
    } else {
        status = write_bytes(file, bytes, static_cast<std::size_t>(size));
    }
    VSIUnlink(memory_file.c_str());
    return status;
}

Status write_cog(const std::string& file, const RasterBand& band, const Crs& crs) {
    if (band.grid->values.empty()) return Error{fmt::format("{}: cannot be made: the map has no cells", file)};
    GdalMessages messages;
    const GDALDatasetUniquePtr source = to_dataset(band, crs);
    if (!source) return Error{fmt::format("{}: cannot be made: {}", file, messages.failure_or("out of memory"))};
    return copy_to_cog(file, *source, messages);
}

}  // namespace talus::geo

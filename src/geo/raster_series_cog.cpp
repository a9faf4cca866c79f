#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "core/nodata.hpp"
#include "geo/cog.hpp"
#include "geo/raster_series.hpp"
#include "geo/spatial_reference.hpp"

namespace talus::geo {
namespace {

/// A frame as a band whose blocks are rows.
class FrameBand final : public GDALRasterBand {
  public:
    FrameBand(GDALDataset& owner, const SeriesFile& series, const RasterSeries& quantity, std::size_t frame)
        : quantity_(quantity), frame_(frame) {
        poDS = &owner;
        nBand = static_cast<int>(frame) + 1;
        eDataType = GDT_Float32;
        nRasterXSize = nBlockXSize = series.geometry.columns;
        nRasterYSize = series.geometry.rows;
        nBlockYSize = 1;
        SetDescription(fmt::format("{} at {:.6g} s", quantity.description, series.times[frame]).c_str());
    }

    double GetNoDataValue(int* known) override {
        if (known != nullptr) *known = TRUE;
        return nodata_in_files;
    }
    const char* GetUnitType() override { return quantity_.unit.c_str(); }

  protected:
    CPLErr IReadBlock(int, int row, void* data) override {
        auto* values = static_cast<float*>(data);
        const Status status = quantity_.read(frame_, nRasterYSize - 1 - row, values);
        if (!status) {
            CPLError(CE_Failure, CPLE_FileIO, "%s", status.error().message.c_str());
            return CE_Failure;
        }
        for (int column = 0; column < nRasterXSize; ++column) {
            if (std::isnan(values[column])) values[column] = nodata_in_files;
        }
        return CE_None;
    }

  private:
    const RasterSeries& quantity_;
    std::size_t frame_;
};

/// The frames as the bands of a data set.
class FrameBands final : public GDALDataset {
  public:
    FrameBands(const SeriesFile& series, const RasterSeries& quantity)
        : geometry_(series.geometry), reference_(to_spatial_reference(series.crs)) {
        nRasterXSize = geometry_.columns;
        nRasterYSize = geometry_.rows;
        for (std::size_t frame = 0; frame < series.times.size(); ++frame) {
            auto band = std::make_unique<FrameBand>(*this, series, quantity, frame);
            band->SetMetadataItem("TIME_S", fmt::format("{:.9g}", series.times[frame]).c_str());
            SetBand(static_cast<int>(frame) + 1, band.release());
        }
        SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_AREA);
        for (const auto& [key, value] : series.metadata) SetMetadataItem(key.c_str(), value.c_str());
    }

    CPLErr GetGeoTransform(double* transform) override {
        const double north = geometry_.y_min + geometry_.rows * geometry_.cell;
        const double values[6] = {geometry_.x_min, geometry_.cell, 0, north, 0, -geometry_.cell};
        std::copy(values, values + 6, transform);
        return CE_None;
    }
    const OGRSpatialReference* GetSpatialRef() const override {
        return reference_.IsEmpty() != 0 ? nullptr : &reference_;
    }

  private:
    GridGeometry geometry_;
    OGRSpatialReference reference_;
};

/// A tile holds all bands: with many of them it is small, so that reading one does not unpack half of the file.
int block_for(std::size_t bands) {
    constexpr std::size_t bytes = std::size_t{16} << 20;
    int block = 512;
    while (block > 64 && bands * static_cast<std::size_t>(block) * static_cast<std::size_t>(block) * 4 > bytes)
        block /= 2;
    return block;
}

}  // namespace

Status write_cog_series(const std::string& file, const SeriesFile& series, const RasterSeries& quantity) {
    if (series.times.empty() || series.geometry.size() == 0) {
        return Error{fmt::format("{}: cannot be made: there are no frames", file)};
    }
    GdalMessages messages;
    FrameBands source(series, quantity);
    return copy_to_cog(file, source, messages, block_for(series.times.size()));
}

}  // namespace talus::geo

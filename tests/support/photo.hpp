#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

namespace talus::test {

struct PhotoOptions {
    int epsg = 2326;  ///< 0: none
    double x_min = 0, y_max = 0, pixel = 1;
    int columns = 100, rows = 80;
    int bands = 3;
    GDALDataType type = GDT_Byte;
    const char* driver = "GTiff";
    bool placed = true;
};

/// A picture whose north-western quarter is red, the north-eastern green, the southern half blue. One band: 200,
/// 100, 50.
inline std::string write_photo(const std::string& path, const PhotoOptions& options) {
    GDALAllRegister();
    GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
    GDALDatasetUniquePtr data(memory->Create("", options.columns, options.rows, options.bands, options.type, nullptr));
    if (options.placed) {
        std::array<double, 6> place{options.x_min, options.pixel, 0, options.y_max, 0, -options.pixel};
        data->SetGeoTransform(place.data());
    }
    if (options.epsg != 0) {
        OGRSpatialReference reference;
        reference.importFromEPSG(options.epsg);
        reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        data->SetSpatialRef(&reference);
    }
    for (int band = 1; band <= options.bands; ++band) {
        std::vector<int> values;
        for (int row = 0; row < options.rows; ++row) {
            for (int column = 0; column < options.columns; ++column) {
                const int part = row >= options.rows / 2 ? 3 : column >= options.columns / 2 ? 2 : 1;
                const int grey = part == 1 ? 200 : part == 2 ? 100 : 50;
                values.push_back(options.bands == 1 ? grey : part == band ? 255 : 0);
            }
        }
        if (data->GetRasterBand(band)->RasterIO(GF_Write, 0, 0, options.columns, options.rows, values.data(),
                                                options.columns, options.rows, GDT_Int32, 0, 0, nullptr) != CE_None) {
            throw std::runtime_error("cannot make a picture");
        }
    }
    char world_file[] = "WORLDFILE=YES";
    std::array<char*, 2> settings{world_file, nullptr};
    const bool as_picture = std::string(options.driver) != "GTiff";
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(options.driver);
    if (!GDALDatasetUniquePtr(driver->CreateCopy(path.c_str(), data.get(), 0, as_picture ? settings.data() : nullptr,
                                                 nullptr, nullptr))) {
        throw std::runtime_error("cannot write " + path);
    }
    if (as_picture && options.epsg == 0) VSIUnlink((path + ".aux.xml").c_str());  // the world file alone says where
    return path;
}

/// A picture as it is told to a browser, read back: red, green, blue, alpha at a share of its width and height from the
/// north-western corner.
class ReadPhoto {
  public:
    explicit ReadPhoto(const std::string& bytes) : name_("/vsimem/read_photo") {
        VSIFCloseL(VSIFileFromMemBuffer(name_.c_str(), reinterpret_cast<GByte*>(const_cast<char*>(bytes.data())),
                                        bytes.size(), 0));
        data_.reset(GDALDataset::Open(name_.c_str(), GDAL_OF_RASTER));
        if (!data_) throw std::runtime_error("not a picture");
    }
    ~ReadPhoto() {
        data_.reset();
        VSIUnlink(name_.c_str());
    }
    ReadPhoto(const ReadPhoto&) = delete;
    ReadPhoto& operator=(const ReadPhoto&) = delete;

    [[nodiscard]] int columns() const { return data_->GetRasterXSize(); }
    [[nodiscard]] int rows() const { return data_->GetRasterYSize(); }
    [[nodiscard]] std::array<int, 4> at(double u, double v) const {
        std::array<int, 4> pixel{0, 0, 0, 255};
        for (int band = 1; band <= std::min(4, data_->GetRasterCount()); ++band) {
            if (data_->GetRasterBand(band)->RasterIO(
                    GF_Read, static_cast<int>(u * columns()), static_cast<int>(v * rows()), 1, 1,
                    &pixel[static_cast<std::size_t>(band - 1)], 1, 1, GDT_Int32, 0, 0, nullptr) != CE_None) {
                throw std::runtime_error("cannot read a pixel");
            }
        }
        return pixel;
    }

  private:
    std::string name_;
    GDALDatasetUniquePtr data_;
};

}  // namespace talus::test

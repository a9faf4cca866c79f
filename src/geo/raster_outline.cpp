#include "geo/raster_outline.hpp"

#include <cstdint>

#include <gdal_alg.h>
#include <ogrsf_frmts.h>

#include "core/try.hpp"
#include "geo/gdal.hpp"

namespace talus::geo {
namespace {

/// Without the repeated last point.
Ring ring_of(const OGRLinearRing& line, const GridGeometry& g) {
    Ring ring;
    for (int i = 0; i + 1 < line.getNumPoints(); ++i) {
        ring.push_back({g.x_min + line.getX(i) * g.cell, g.y_min + line.getY(i) * g.cell});
    }
    return ring;
}

}  // namespace

Result<std::vector<Polygon>> outlines_above_zero(const Grid<float>& values) {
    prepare_gdal();
    const GdalMessages messages;
    const GridGeometry& g = values.geometry;
    const auto failed = [&] { return Error{"no outline could be drawn: " + messages.failure_or("GDAL says no more")}; };

    // Columns and rows as coordinates, row 0 in the south as in a grid.
    std::vector<std::uint8_t> above(values.values.size());
    for (std::size_t k = 0; k < above.size(); ++k) above[k] = values.values[k] > 0 ? 1 : 0;
    GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
    if (memory == nullptr) return failed();
    const GDALDatasetUniquePtr raster(memory->Create("", g.columns, g.rows, 1, GDT_Byte, nullptr));
    if (!raster) return failed();
    GDALRasterBand* band = raster->GetRasterBand(1);
    if (band->RasterIO(GF_Write, 0, 0, g.columns, g.rows, above.data(), g.columns, g.rows, GDT_Byte, 0, 0) != CE_None) {
        return failed();
    }
    GDALDriver* vectors = GetGDALDriverManager()->GetDriverByName("Memory");
    if (vectors == nullptr) return failed();
    const GDALDatasetUniquePtr drawn(vectors->Create("", 0, 0, 0, GDT_Unknown, nullptr));
    OGRLayer* layer = drawn ? drawn->CreateLayer("outline", nullptr, wkbPolygon) : nullptr;
    if (layer == nullptr || GDALPolygonize(band, band, layer, -1, nullptr, nullptr, nullptr) != CE_None)
        return failed();

    std::vector<Polygon> outlines;
    for (const auto& feature : *layer) {
        const OGRGeometry* geometry = feature->GetGeometryRef();
        if (geometry == nullptr || wkbFlatten(geometry->getGeometryType()) != wkbPolygon) continue;
        const OGRPolygon* polygon = geometry->toPolygon();
        Polygon outline{ring_of(*polygon->getExteriorRing(), g), {}};
        for (int k = 0; k < polygon->getNumInteriorRings(); ++k) {
            outline.holes.push_back(ring_of(*polygon->getInteriorRing(k), g));
        }
        outlines.push_back(std::move(outline));
    }
    return outlines;
}

Result<std::vector<ClassOutline>> class_outlines(const Grid<float>& classes, std::size_t count) {
    std::vector<ClassOutline> outlines;
    for (std::size_t number = 1; number <= count; ++number) {
        Grid<float> in_class(classes.geometry);
        std::size_t cells = 0;
        for (std::size_t i = 0; i < classes.values.size(); ++i) {
            if (classes.values[i] != static_cast<float>(number)) continue;
            in_class.values[i] = 1;
            ++cells;
        }
        if (cells == 0) continue;
        TALUS_ASSIGN(auto polygons, outlines_above_zero(in_class));
        const double cell = classes.geometry.cell;
        outlines.push_back({number, std::move(polygons), static_cast<double>(cells) * cell * cell});
    }
    return outlines;
}

}  // namespace talus::geo

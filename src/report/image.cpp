#include "report/image.hpp"

#include <png.h>
#include <string_view>

namespace talus::report {
namespace {

std::string base64(const std::vector<std::uint8_t>& bytes) {
    static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t k) { return k < bytes.size() ? std::uint32_t{bytes[k]} : 0U; };
        const std::uint32_t group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        for (int shift = 18; shift >= 0; shift -= 6) out += digits[group >> shift & 63];
    }
    if (bytes.size() % 3 != 0) out.replace(out.size() - (3 - bytes.size() % 3), 3, 3 - bytes.size() % 3, '=');
    return out;
}

Result<std::string> encode(int width, int height, png_uint_32 format, const void* pixels,
                           const std::vector<std::uint8_t>& colour_map) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = format;
    image.colormap_entries = static_cast<png_uint_32>(colour_map.size() / 4);
    const void* colours = colour_map.empty() ? nullptr : colour_map.data();
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::vector<std::uint8_t> memory(size);
    const int done = png_image_write_to_memory(&image, memory.data(), &size, 0, pixels, 0, colours);
    if (done == 0) return Error{std::string("report.html: a map could not be encoded as PNG: ") + image.message};
    memory.resize(size);
    return "data:image/png;base64," + base64(memory);
}

}  // namespace

Result<std::string> png_uri(const GreyImage& image) {
    return encode(image.width, image.height, PNG_FORMAT_GA, image.pixels.data(), {});
}

Result<std::string> png_uri(const ClassImage& image) {
    std::vector<std::uint8_t> colour_map = {255, 255, 255, 0};
    for (const Colour& c : image.colours) colour_map.insert(colour_map.end(), {c.red, c.green, c.blue, 255});
    return encode(image.width, image.height, PNG_FORMAT_RGBA_COLORMAP, image.pixels.data(), colour_map);
}

Result<std::string> png_uri(const ValueImage& image) {
    return encode(image.width, image.height, PNG_FORMAT_RGB, image.pixels.data(), {});
}

}  // namespace talus::report

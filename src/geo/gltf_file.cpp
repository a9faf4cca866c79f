#include "geo/gltf_file.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/json_text.hpp"
#include "geo/mesh_faces.hpp"

namespace talus::geo {
namespace {

using nlohmann::json;

constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

/// Component types: bytes of one, and the greatest value of a whole number (0: a float).
struct ComponentType {
    std::int64_t number;
    std::size_t bytes;
    double greatest;
};
constexpr ComponentType component_types[] = {{5120, 1, 127},   {5121, 1, 255},          {5122, 2, 32767},
                                             {5123, 2, 65535}, {5125, 4, 4294967295.0}, {5126, 4, 0}};

const ComponentType* component_type(std::int64_t number) {
    for (const ComponentType& type : component_types) {
        if (type.number == number) return &type;
    }
    return nullptr;
}

std::uint32_t word_at(const std::string& text, std::size_t place) {
    std::uint32_t word = 0;
    for (std::size_t k = 4; k-- > 0;) word = word << 8U | static_cast<unsigned char>(text[place + k]);
    return word;
}

template <class Number>
double read_as(const char* data) {
    Number value;
    std::memcpy(&value, data, sizeof value);
    return static_cast<double>(value);
}

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;
    if (c == '/' || c == '_') return 63;
    return -1;
}

std::optional<std::string> decode_base64(std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0, held = 0;
    for (const char c : text) {
        const int digit = base64_digit(c);
        if (digit < 0) return std::nullopt;
        bits = bits << 6U | static_cast<std::uint32_t>(digit);
        held += 6;
        if (held < 8) continue;
        held -= 8;
        bytes.push_back(static_cast<char>(bits >> held & 0xFFU));
    }
    return bytes;
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/// `%20` and the like.
std::string decode_percent(const std::string& uri) {
    std::string text;
    for (std::size_t k = 0; k < uri.size(); ++k) {
        const int high = k + 2 < uri.size() ? hex_digit(uri[k + 1]) : -1, low = high < 0 ? -1 : hex_digit(uri[k + 2]);
        const bool coded = uri[k] == '%' && low >= 0;
        text.push_back(coded ? static_cast<char>(high * 16 + low) : uri[k]);
        if (coded) k += 2;
    }
    return text;
}

std::string quoted(const std::string& text) {
    return json(text.substr(0, 60)).dump(-1, ' ', true, json::error_handler_t::replace);
}

/// Extensions that only change the appearance of a mesh.
bool is_about_looks(const std::string& extension) {
    for (const char* begin : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_"}) {
        if (extension.rfind(begin, 0) == 0) return true;
    }
    return false;
}

}  // namespace

const json& gltf_member(const json& object, const char* key) {
    static const json nothing;
    if (!object.is_object()) return nothing;
    const auto found = object.find(key);
    return found == object.end() ? nothing : *found;
}

bool gltf_size(const json& value, std::size_t& size) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= std::uint64_t{1} << 40U) return false;
    size = value.get<std::size_t>();
    return true;
}

double GltfAccessor::at(std::size_t element, std::size_t k) const {
    const ComponentType& type = *component_type(component);
    const char* place = data + element * stride + k * type.bytes;
    double value = 0;
    switch (component) {
        case 5120:
            value = read_as<std::int8_t>(place);
            break;
        case 5121:
            value = read_as<std::uint8_t>(place);
            break;
        case 5122:
            value = read_as<std::int16_t>(place);
            break;
        case 5123:
            value = read_as<std::uint16_t>(place);
            break;
        case 5125:
            value = read_as<std::uint32_t>(place);
            break;
        default:
            return read_as<float>(place);
    }
    return normalized ? std::max(value / type.greatest, -1.0) : value;
}

bool GltfAccessor::holds_indices() const {
    return width == 1 && !normalized && (component == 5121 || component == 5123 || component == 5125);
}

Result<GltfFile> GltfFile::open(const std::string& file) {
    GltfFile gltf;
    gltf.file_ = file;
    TALUS_ASSIGN(gltf.text_, read_mesh_text(file));
    TALUS_TRY(gltf.split_container());
    Result<json> root = parse_json(std::string_view(gltf.text_).substr(gltf.json_begin_, gltf.json_size_));
    if (!root) return Error{file + ": is no glTF file; what it says " + root.error().message};
    gltf.root_ = std::make_unique<const json>(*std::move(root));
    TALUS_TRY(gltf.check_version());
    TALUS_TRY(gltf.check_extensions());
    TALUS_TRY(gltf.read_buffers());
    return Result<GltfFile>(std::move(gltf));
}

/// Finds the JSON and the binary part.
Status GltfFile::split_container() {
    json_size_ = text_.size();
    if (text_.compare(0, 4, "glTF") != 0) return {};
    const auto damaged = [&](const std::string& what) { return Error{file_ + ": is a damaged .glb file: " + what}; };
    if (text_.size() < 20) return damaged("it ends within its header");
    if (word_at(text_, 4) != 2) {
        return Error{fmt::format("{}: is of glTF container version {}; it must be 2", file_, word_at(text_, 4))};
    }
    if (word_at(text_, 8) > text_.size()) {
        return damaged(fmt::format("it says that it has {} bytes and has {}", word_at(text_, 8), text_.size()));
    }
    const std::size_t end = word_at(text_, 8);
    for (std::size_t place = 12, number = 0; place + 8 <= end; ++number) {
        const std::size_t size = word_at(text_, place), begin = place + 8;
        const std::uint32_t type = word_at(text_, place + 4);
        if (size > end - begin) {
            return damaged(fmt::format("chunk {} says that it has {} bytes; there are {}", number, size, end - begin));
        }
        if (number == 0) {
            if (type != json_chunk) return damaged("its first chunk is not JSON");
            json_begin_ = begin;
            json_size_ = size;
        } else if (number == 1 && type == binary_chunk) {
            chunk_begin_ = begin;
            chunk_size_ = size;
        }
        place = begin + size;
    }
    if (json_begin_ == 0) return damaged("it has no chunks");
    return {};
}

Status GltfFile::check_version() const {
    const json& version = gltf_member(gltf_member(*root_, "asset"), "version");
    if (!version.is_string()) return Error{file_ + ": is no glTF file: it has no asset.version"};
    const std::string said = version;
    if (said.rfind("2.", 0) == 0) return {};
    return Error{fmt::format("{}: asset.version is {}; it must be 2.0", file_, quoted(said))};
}

Status GltfFile::check_extensions() const {
    const json& required = gltf_member(*root_, "extensionsRequired");
    if (!required.is_array()) return {};
    for (const json& entry : required) {
        if (!entry.is_string()) continue;
        const std::string name = entry;
        if (is_about_looks(name) || name == "KHR_mesh_quantization") continue;
        if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression") {
            return Error{fmt::format("{}: is compressed with {} ({}), which is not supported; write it without", file_,
                                     name[0] == 'K' ? "Draco" : "meshopt", name)};
        }
        return Error{fmt::format("{}: needs the extension {}, which is not supported", file_, quoted(name))};
    }
    return {};
}

Status GltfFile::read_buffers() {
    const json& list = gltf_member(*root_, "buffers");
    for (std::size_t index = 0; list.is_array() && index < list.size(); ++index) {
        const std::string at = fmt::format("{}: buffers[{}]", file_, index);
        TALUS_TRY(read_buffer(list[index], index, at));
    }
    return {};
}

Status GltfFile::read_buffer(const json& entry, std::size_t index, const std::string& at) {
    Buffer buffer;
    if (!gltf_size(gltf_member(entry, "byteLength"), buffer.size)) {
        return Error{at + ": its byteLength must be a whole number of bytes"};
    }
    const json& uri = gltf_member(entry, "uri");
    if (uri.is_string()) {
        const std::string& where = uri.get_ref<const std::string&>();
        if (where.rfind("data:", 0) == 0) {
            const std::size_t comma = where.find(";base64,");
            const auto bytes =
                comma == std::string::npos ? std::nullopt : decode_base64(std::string_view(where).substr(comma + 8));
            if (!bytes) return Error{at + ": its data are not written as base64"};
            buffer.own = *bytes;
        } else
            TALUS_TRY(read_external(where, buffer, at));
    } else if (index == 0 && chunk_begin_ > 0) {
        buffer.binary_chunk = true;
    } else {
        return Error{at + ": has no uri, and there is no binary chunk for it"};
    }
    const std::size_t there = bytes_of(buffer).size();
    if (there < buffer.size) {
        return Error{fmt::format("{}: should have {} bytes and has {}", at, buffer.size, there)};
    }
    buffers_.push_back(std::move(buffer));
    return {};
}

Status GltfFile::read_external(const std::string& uri, Buffer& buffer, const std::string& at) {
    const std::filesystem::path relative = decode_percent(uri);
    bool outside = relative.is_absolute() || uri.find(':') != std::string::npos || uri.find('\\') != std::string::npos;
    for (const auto& part : relative) outside = outside || part == "..";
    if (outside || decode_percent(uri).find('\0') != std::string::npos) {
        return Error{fmt::format("{}: uri = {} is refused; it must be a file in the folder of the glTF file or below",
                                 at, quoted(uri))};
    }
    const std::string path = (std::filesystem::path(file_).parent_path() / relative).string();
    std::error_code code;
    const std::uintmax_t size = std::filesystem::file_size(path, code);
    if (!code && external_bytes_ + size > max_mesh_bytes) {  // the same one may be named repeatedly
        return Error{fmt::format("{}: with it the buffers are larger than {} MB", at, max_mesh_bytes >> 20U)};
    }
    Result<std::string> bytes = read_mesh_text(path);
    if (!bytes) return Error{at + ": " + bytes.error().message};
    external_bytes_ += bytes->size();
    buffer.own = std::move(*bytes);
    buffer_files_.push_back(path);
    return {};
}

std::string_view GltfFile::bytes_of(const Buffer& buffer) const {
    return buffer.binary_chunk ? std::string_view(text_).substr(chunk_begin_, chunk_size_) : buffer.own;
}

const json* GltfFile::entry(const char* list, std::size_t index) const {
    const json& entries = gltf_member(*root_, list);
    return entries.is_array() && index < entries.size() ? &entries[index] : nullptr;
}

Result<std::string_view> GltfFile::view(std::size_t index, std::size_t& stride) const {
    const std::string at = fmt::format("{}: bufferViews[{}]", file_, index);
    const json* entry = this->entry("bufferViews", index);
    if (entry == nullptr) return Error{at + " is named but not there"};
    if (!gltf_member(gltf_member(*entry, "extensions"), "EXT_meshopt_compression").is_null()) {
        return Error{at + ": is compressed with meshopt (EXT_meshopt_compression), which is not supported"};
    }
    std::size_t buffer = 0, offset = 0, length = 0;
    if (!gltf_size(gltf_member(*entry, "buffer"), buffer) || buffer >= buffers_.size()) {
        return Error{fmt::format("{}: names a buffer that is not there; there are {}", at, buffers_.size())};
    }
    const json &offset_value = gltf_member(*entry, "byteOffset"), &stride_value = gltf_member(*entry, "byteStride");
    if ((!offset_value.is_null() && !gltf_size(offset_value, offset)) ||
        !gltf_size(gltf_member(*entry, "byteLength"), length) || offset + length > buffers_[buffer].size) {
        return Error{
            fmt::format("{}: does not lie within the {} bytes of buffers[{}]", at, buffers_[buffer].size, buffer)};
    }
    stride = 0;
    if (!stride_value.is_null() && (!gltf_size(stride_value, stride) || stride > 252 || stride < 4)) {
        return Error{at + ": its byteStride must be 4 to 252"};
    }
    return bytes_of(buffers_[buffer]).substr(offset, length);
}

Result<GltfAccessor> GltfFile::accessor(std::size_t index) const {
    const std::string at = fmt::format("{}: accessors[{}]", file_, index);
    const json* entry = this->entry("accessors", index);
    if (entry == nullptr) return Error{at + " is named but not there"};
    if (!gltf_member(*entry, "sparse").is_null()) return Error{at + ": is sparse, which is not supported"};
    GltfAccessor numbers;
    const json& type = gltf_member(*entry, "type");
    numbers.width = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
    std::size_t number = 0, view_index = 0, offset = 0;
    const ComponentType* component = gltf_size(gltf_member(*entry, "componentType"), number)
                                         ? component_type(static_cast<std::int64_t>(number))
                                         : nullptr;
    if (numbers.width == 0 || component == nullptr) {
        return Error{at + ": must be scalars or vectors of a component type that glTF knows"};
    }
    if (!gltf_size(gltf_member(*entry, "bufferView"), view_index)) return Error{at + ": has no bufferView"};
    TALUS_ASSIGN(const std::string_view bytes, view(view_index, numbers.stride));
    const std::size_t element = numbers.width * component->bytes;
    if (numbers.stride == 0) numbers.stride = element;
    const json& offset_value = gltf_member(*entry, "byteOffset");
    const bool sizes =
        (offset_value.is_null() || gltf_size(offset_value, offset)) && gltf_size(gltf_member(*entry, "count"), number);
    if (!sizes || number == 0 || numbers.stride < element ||
        offset + (number - 1) * numbers.stride + element > bytes.size()) {
        return Error{
            fmt::format("{}: does not lie within the {} bytes of bufferViews[{}]", at, bytes.size(), view_index)};
    }
    numbers.count = number;
    numbers.data = bytes.data() + offset;
    numbers.component = component->number;
    numbers.normalized = gltf_member(*entry, "normalized") == true && component->greatest > 0;
    return numbers;
}

}  // namespace talus::geo

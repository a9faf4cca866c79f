#include "publish/tape.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <utility>
#include <zlib.h>

namespace talus::publish {
namespace {

using nlohmann::json;

constexpr std::string_view mark = "TLST";
constexpr std::uint32_t version = 1;

/// Frames and grids of docs/protocol.md are deflated already, and so are pictures.
bool shrinks(std::string_view type, std::string_view body) {
    if (type.starts_with("image/") && type != "image/tiff") return false;
    return !(body.starts_with("TLSF") || body.starts_with("TLSG"));
}

void put(std::string& bytes, std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xff);
}

}  // namespace

std::string deflated(std::string_view bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    // zlib takes a pointer to const here.
    const int code = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_COMPRESSION);
    if (code != Z_OK) throw std::bad_alloc();  // the room was enough
    packed.resize(size);
    return packed;
}

json Tape::keep(const std::string& type, std::string_view body) {
    const std::string packed = shrinks(type, body) ? deflated(body) : std::string(body);
    // The answer for now often equals the last one in time.
    const auto [known, is_new] = places_.try_emplace(std::hash<std::string>{}(packed), bodies_.size());
    const bool kept = !is_new && std::string_view(bodies_).substr(known->second).starts_with(packed);
    const std::size_t at = kept ? known->second : bodies_.size();
    if (!kept) bodies_ += packed;
    json place = {{"type", type}, {"at", at}, {"size", packed.size()}};
    if (packed.size() != body.size() || shrinks(type, body)) place["whole"] = body.size();
    return place;
}

void Tape::add(const std::string& address, const std::string& type, std::string_view body) {
    answers_[address] = keep(type, body);
}

void Tape::add_at(const std::string& address, double time, const std::string& type, std::string_view body) {
    auto last = std::find_if(last_.begin(), last_.end(), [&](const Last& one) { return one.address == address; });
    if (last == last_.end()) {
        last = last_.insert(last_.end(), Last{address, {}});
        times_[address] = json::array();
    } else if (last->body == body) {
        return;
    }
    last->body = body;
    json place = keep(type, body);
    place["time_s"] = time;
    times_[address].push_back(std::move(place));
}

std::string Tape::pack() const {
    const std::string head = json{{"messages", messages_}, {"answers", answers_}, {"times", times_}}.dump(
        -1, ' ', false, json::error_handler_t::replace);
    const std::string packed = deflated(head);
    std::string bytes(mark);
    put(bytes, version);
    put(bytes, packed.size());
    put(bytes, head.size());
    return bytes + packed + bodies_;
}

}  // namespace talus::publish

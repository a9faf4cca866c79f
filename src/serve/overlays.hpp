#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "geo/foreign.hpp"
#include "serve/executor.hpp"
#include "serve/overlay.hpp"
#include "serve/router.hpp"
#include "serve/session.hpp"
#include "serve/tile_addresses.hpp"

namespace talus::serve {

/// The overlays of a session, from bottom to top: everybody sees the same. For the server's thread; files are read on a
/// lane, each by a process of its own.
class Overlays {
  public:
    /// `folder`: for files on their way. `tiles`: addresses of map tiles that the program was started with.
    Overlays(Session& session, std::filesystem::path folder, geo::ForeignReader reader,
             const std::vector<std::string>& tiles, OverlayQuota quota = {});
    ~Overlays() { close(); }
    Overlays(const Overlays&) = delete;
    Overlays& operator=(const Overlays&) = delete;
    void close();

    /// Of a saved session; before anybody joins.
    void open(std::vector<Overlay> overlays, const std::vector<TileAddress>& tiles = {});
    [[nodiscard]] const OverlayQuota& quota() const { return quota_; }
    /// As `GET /api/overlays`.
    [[nodiscard]] messages::Overlays describe() const;
    /// For a saved session: its keys overlays and tiles.
    [[nodiscard]] nlohmann::json saved() const;
    /// A file that comes piece by piece, of which overlays are made.
    [[nodiscard]] std::shared_ptr<Intake> intake(const Request& request);
    /// Points, lines and areas as JSON; or a picture.
    void data(const Request& request, bool picture, const Respond& respond) const;
    /// Name, whether it is shown, opacity, colour, as the body says.
    void change(const Request& request, const Respond& respond);
    void remove(const Request& request, const Respond& respond);
    /// The layer or the address of map tiles that was removed last.
    void restore(const Request& request, const Respond& respond);
    /// Addresses of map tiles, and longitudes and latitudes of places of the terrain.
    void tiles(const Respond& respond) const;
    void add_tiles(const Request& request, const Respond& respond);
    void remove_tiles(const Request& request, const Respond& respond);
    [[nodiscard]] std::vector<std::string> tile_addresses() const { return tiles_.addresses(); }

  private:
    class Taking;
    /// On the lane: what lies in `folder` as it came.
    [[nodiscard]] Result<std::vector<Overlay>> read(const std::string& name, const std::filesystem::path& folder) const;
    /// Of what was read; answers.
    void add(std::vector<Overlay> overlays, const Respond& respond);
    [[nodiscard]] std::vector<Overlay>::iterator find(const std::string& id);
    [[nodiscard]] std::size_t bytes() const;
    [[nodiscard]] Status has_room(const std::vector<Overlay>& more) const;
    void give_id(Overlay& overlay);
    /// Adds it; answers.
    void lay_tiles(const TileAddress& tile, const Respond& respond);
    void tell();

    Session& session_;
    const std::filesystem::path folder_;
    const geo::ForeignReader reader_;
    const OverlayQuota quota_;
    std::vector<Overlay> list_;
    TileAddresses tiles_;
    std::variant<std::monostate, Overlay, TileAddress> removed_;
    int numbers_ = 0;
    std::atomic<int> uploads_ = 0;
    const std::shared_ptr<std::atomic<bool>> stop_ = std::make_shared<std::atomic<bool>>(false);
    Lane lane_{session_.executor(), "overlays"};
};

}  // namespace talus::serve

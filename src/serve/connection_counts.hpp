#pragma once

#include <array>
#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <map>

namespace talus::serve {

/// The open connections, in all and by the address of the other side: nobody can take all of them.
class ConnectionCounts {
  public:
    ConnectionCounts(std::size_t limit, std::size_t limit_per_address)
        : limit_(limit), limit_per_address_(limit_per_address) {}

    [[nodiscard]] bool has_room(const boost::asio::ip::address& from) const {
        const auto found = by_network_.find(network_of(from));
        return total_ < limit_ && (found == by_network_.end() || found->second < limit_per_address_);
    }
    [[nodiscard]] std::size_t limit() const { return limit_; }

    /// Counts a connection for as long as it lives.
    class Counted {
      public:
        Counted(ConnectionCounts& counts, const boost::asio::ip::address& from)
            : counts_(counts), place_(counts.by_network_.try_emplace(network_of(from), 0).first) {
            ++counts_.total_;
            ++place_->second;
        }
        ~Counted() {
            --counts_.total_;
            if (--place_->second == 0) counts_.by_network_.erase(place_);
        }
        Counted(const Counted&) = delete;
        Counted& operator=(const Counted&) = delete;

      private:
        ConnectionCounts& counts_;
        std::map<std::array<unsigned char, 8>, std::size_t>::iterator place_;
    };

  private:
    /// Whoever has an IPv6 address has all that share its first 64 bits.
    static std::array<unsigned char, 8> network_of(const boost::asio::ip::address& address) {
        namespace ip = boost::asio::ip;
        std::array<unsigned char, 8> network{};
        if (address.is_v6() && !address.to_v6().is_v4_mapped()) {
            const auto bytes = address.to_v6().to_bytes();
            for (std::size_t i = 0; i < network.size(); ++i) network[i] = bytes[i];
            network[0] |= network[0] == 0 ? 1 : 0;  // no address of version 4
        } else {
            const auto bytes =
                (address.is_v4() ? address.to_v4() : ip::make_address_v4(ip::v4_mapped, address.to_v6())).to_bytes();
            for (std::size_t i = 0; i < bytes.size(); ++i) network[i + 4] = bytes[i];
        }
        return network;
    }

    std::size_t limit_, limit_per_address_, total_ = 0;
    std::map<std::array<unsigned char, 8>, std::size_t> by_network_;
};

}  // namespace talus::serve

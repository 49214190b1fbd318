// Places for requests whose body may occupy a thread for long: uploads and long JSON bodies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace hairbake {

/// Longer bodies take a place. nginx forwards shorter ones whole, and they fit into memory.
inline constexpr std::uint64_t long_body = 64 << 10;

/// Thread-safe. A request takes a place when it is let in, after the check of its token, and keeps it until it is
/// answered. So a request that is refused holds no place, and one address cannot take all of them.
class BodyPlaces {
public:
    /// `places` in all, `per_address` for each address that nginx names; requests that nginx did not forward have no
    /// address, and only `places` counts for them.
    BodyPlaces(int places, int per_address) : places_(places), per_address_(per_address) {}

    /// Its destructor frees the place. The BodyPlaces outlive it.
    class Place {
    public:
        ~Place();
        Place(Place&& other) noexcept;
        Place& operator=(Place&& other) = delete;

    private:
        friend class BodyPlaces;
        Place(BodyPlaces& places, std::string client) : places_(&places), client_(std::move(client)) {}

        BodyPlaces* places_;
        std::string client_;
    };

    /// `address` is an IP address as text, or empty. Of an IPv6 address the first 64 bits count: a client has all
    /// others. Nothing when all places, or all of this address, are taken.
    ///
    /// An address gets another place only while more are free than it has. So the last places are kept for addresses
    /// that have none: of 48 places with 16 for an address, three addresses can take 40, and five 46.
    std::optional<Place> take(const std::string& address);

    /// Why take() gave nothing: how many places are taken, how many are allowed, by which setting.
    std::string refusal(const std::string& address);

private:
    void free(const std::string& client);

    const int places_, per_address_;
    std::mutex mutex_;  ///< guards the members below
    int taken_ = 0;
    std::map<std::string, int> taken_by_;  ///< only clients that have places
};

}  // namespace hairbake

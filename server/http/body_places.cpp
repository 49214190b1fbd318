#include "server/http/body_places.h"

#include <arpa/inet.h>

#include <array>
#include <utility>

namespace hairbake {
namespace {

/// The part of the address that one client cannot choose.
std::string client_of(const std::string& address) {
    std::array<char, sizeof(in6_addr)> bytes{};
    if (::inet_pton(AF_INET6, address.c_str(), bytes.data()) != 1) return address;
    return {bytes.data(), 8};
}

}  // namespace

BodyPlaces::Place::~Place() {
    if (places_) places_->free(client_);
}

BodyPlaces::Place::Place(Place&& other) noexcept
    : places_(std::exchange(other.places_, nullptr)), client_(std::move(other.client_)) {}

std::optional<BodyPlaces::Place> BodyPlaces::take(const std::string& address) {
    std::string client = client_of(address);
    const std::lock_guard lock(mutex_);
    if (taken_ == places_) return std::nullopt;
    if (!client.empty()) {
        const auto found = taken_by_.find(client);
        const int own = found == taken_by_.end() ? 0 : found->second;
        if (own >= per_address_ || own >= places_ - taken_) return std::nullopt;
        ++taken_by_[client];
    }
    ++taken_;
    return Place(*this, std::move(client));
}

std::string BodyPlaces::refusal(const std::string& address) {
    const std::lock_guard lock(mutex_);
    const auto found = taken_by_.find(client_of(address));
    const int own = found == taken_by_.end() ? 0 : found->second;
    const std::string bodies = " uploads and long bodies are under way";
    if (own >= per_address_)
        return std::to_string(own) + bodies + " from your address; allowed are up to " + std::to_string(per_address_) +
               " at once ([listen] bodies_per_address)";
    if (const int left = places_ - taken_; left > 0)
        return std::to_string(own) + bodies + " from your address, and " + std::to_string(left) + " of " +
               std::to_string(places_) +
               " places are free; an address may take one more only while more are free than it has ([listen] bodies)";
    return std::to_string(taken_) + bodies + "; allowed are up to " + std::to_string(places_) +
           " at once ([listen] bodies)";
}

void BodyPlaces::free(const std::string& client) {
    const std::lock_guard lock(mutex_);
    --taken_;
    if (const auto found = taken_by_.find(client); found != taken_by_.end() && --found->second == 0)
        taken_by_.erase(found);
}

}  // namespace hairbake

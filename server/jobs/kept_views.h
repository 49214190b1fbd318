// What was made of the database, kept while that does not change.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "server/store/database.h"

namespace hairbake {

/// Thread-safe. Views by the id of what they show: they are polled again and again.
template <class View>
class KeptViews {
public:
    explicit KeptViews(const Database& database) : database_(database) {}

    std::optional<View> find(const std::string& id) {
        const std::lock_guard lock(mutex_);
        if (version_ != database_.version()) return std::nullopt;
        const auto found = views_.find(id);
        return found == views_.end() ? std::nullopt : std::optional(found->second);
    }

    /// `version` is the Database::version_read() of the reading that the view was made in.
    void keep(std::uint64_t version, const std::string& id, const View& view) {
        const std::lock_guard lock(mutex_);
        if (version < version_) return;
        if (version > version_ || views_.size() >= most_views) views_.clear();
        version_ = version;
        views_[id] = view;
    }

private:
    static constexpr std::size_t most_views = 1000;

    const Database& database_;
    std::mutex mutex_;  ///< of what follows
    std::uint64_t version_ = 0;
    std::unordered_map<std::string, View> views_;
};

}  // namespace hairbake

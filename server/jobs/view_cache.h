// A cache of replies that depend on the database alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

namespace hairbake {

/// Thread-safe. Views by the id of the object that they show. All belong to one version of the database: a later
/// version drops them.
template <class View>
class ViewCache {
public:
    /// `version` is Database::version() now.
    std::optional<View> find(std::uint64_t version, const std::string& id) {
        const std::lock_guard lock(mutex_);
        if (version_ != version) return std::nullopt;
        const auto found = views_.find(id);
        return found == views_.end() ? std::nullopt : std::optional(found->second);
    }

    /// `version` is the Database::version_read() of the read() that made the view.
    /// `bytes` is the view's size in memory.
    void keep(std::uint64_t version, const std::string& id, const View& view, std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        if (version < version_ || bytes > most_bytes / 8) return;
        if (version > version_ || views_.size() >= most_views || bytes_ + bytes > most_bytes) {
            views_.clear();
            bytes_ = 0;
        }
        version_ = version;
        if (views_.emplace(id, view).second) bytes_ += bytes;
    }

private:
    static constexpr std::size_t most_views = 1000, most_bytes = 8 << 20;

    std::mutex mutex_;  ///< guards the members below
    std::uint64_t version_ = 0;
    std::size_t bytes_ = 0;  ///< of all views
    std::unordered_map<std::string, View> views_;
};

}  // namespace hairbake

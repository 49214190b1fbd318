// A cache of replies that depend on the database alone.
#pragma once

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
    void keep(std::uint64_t version, const std::string& id, const View& view) {
        const std::lock_guard lock(mutex_);
        if (version < version_) return;
        if (version > version_ || views_.size() >= most_views) views_.clear();
        version_ = version;
        views_[id] = view;
    }

private:
    static constexpr std::size_t most_views = 1000;

    std::mutex mutex_;  ///< guards the members below
    std::uint64_t version_ = 0;
    std::unordered_map<std::string, View> views_;
};

}  // namespace hairbake

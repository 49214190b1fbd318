#include "server/jobs/maintenance.h"

#include <spdlog/spdlog.h>

#include <chrono>

#include "server/jobs/uploads.h"
#include "server/store/blob_store.h"
#include "server/store/disk_reserve.h"
#include "server/store/file_system.h"
#include "server/store/pruning.h"
#include "server/store/room.h"
#include "server/store/store_identity.h"

namespace hairbake {

Maintenance::Maintenance(Database& database, StoreIdentity& identity, BlobStore& store, Room& room, Uploads& uploads,
                         DiskReserve& reserve, double keep_failed_s)
    : database_(database),
      identity_(identity),
      store_(store),
      room_(room),
      uploads_(uploads),
      reserve_(reserve),
      keep_failed_s_(keep_failed_s) {
    prune_bakes();
    thread_ = std::jthread([this] { run(); });
}

Maintenance::~Maintenance() { stop(); }

void Maintenance::stop() {
    {
        const std::lock_guard lock(mutex_);
        is_stopping_ = true;
    }
    changed_.notify_all();
}

void Maintenance::prune_bakes() { prune(database_, now() - keep_failed_s_); }

void Maintenance::run() {
    for (;;) try {
            {
                std::unique_lock lock(mutex_);
                if (changed_.wait_for(lock, std::chrono::minutes(1), [this] { return is_stopping_; })) return;
            }
            store_.flush_uses();
            uploads_.expire();
            prune_bakes();
            room_.trim();
            reserve_.fill();
            identity_.advance_if_changed();
        } catch (const std::exception& error) {
            spdlog::error("maintenance: {}", error_text(error));
        }
}

}  // namespace hairbake

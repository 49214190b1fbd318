#include "server/store/room.h"

#include <sys/statvfs.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/base/assert.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/disk_reserve.h"
#include "server/store/eviction.h"
#include "server/store/file_system.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

/// A body of unknown length is promised so many bytes at a time, as long as there is so much room.
constexpr std::uint64_t step = 1 << 20;

std::string mb(std::uint64_t bytes) { return std::to_string(bytes >> 20); }

}  // namespace

Room::Room(Database& database, BlobStore& store, DiskReserve& reserve, std::filesystem::path folder,
           const RoomLimits& limits)
    : database_(database), store_(store), reserve_(reserve), folder_(std::move(folder)), limits_(limits) {}

Room::Share::Share(Share&& other) noexcept
    : room_(std::exchange(other.room_, nullptr)),
      counts_(other.counts_),
      promised_(other.promised_),
      received_(other.received_) {}

void Room::Share::promise(std::uint64_t bytes) {
    room_->promise(bytes, counts_, own());
    promised_ += bytes;
}

void Room::Share::grow(std::uint64_t bytes) {
    HAIRBAKE_ASSERT(room_);  // before give_back()
    if (received_ + bytes > promised_) {
        const std::uint64_t lacking = received_ + bytes - promised_;
        try {
            promise(std::max(lacking, step));
        } catch (const Refusal&) {
            if (lacking >= step) throw;
            promise(lacking);
        }
    }
    room_->arrive(bytes, counts_);
    received_ += bytes;
    if (counts_) room_->make_room(0, own());
}

void Room::Share::count() {
    if (counts_) return;
    const auto held = room_->database_.lock();
    room_->admit(promised_, own(), [this](Counters& counters) {
        counters.promised += promised_;
        counters.received += received_;
    });
    counts_ = true;
    room_->make_room(0, own());
}

void Room::Share::give_back() {
    if (!room_) return;
    const std::lock_guard lock(room_->mutex_);
    forget();
}

void Room::Share::become_kept(const std::string& upload, std::uint64_t total) {
    const std::lock_guard lock(room_->mutex_);
    room_->set_kept(upload, total);
    forget();
}

/// With the room's mutex held.
void Room::Share::forget() {
    Counters& counters = room_->counters_;
    counters.unwritten -= promised_ - received_;
    if (counts_) {
        counters.promised -= promised_;
        counters.received -= received_;
    }
    room_ = nullptr;
}

/// What this share adds to the room's counters.
Room::Counters Room::Share::own() const {
    Counters own;
    if (counts_) {
        own.promised = promised_;
        own.received = received_;
    }
    own.unwritten = promised_ - received_;
    return own;
}

Room::Share Room::reserve(std::optional<std::uint64_t> announced, bool is_stored) {
    Share share(*this, !is_stored);
    share.promise(announced.value_or(0));
    return share;
}

/// Promises `bytes` more of a body, which has `own` already.
void Room::promise(std::uint64_t bytes, bool counts, const Counters& own) {
    if (bytes == 0) return;
    const auto add = [&](Counters& counters) {
        if (counts) counters.promised += bytes;
        counters.unwritten += bytes;
    };
    {
        const std::lock_guard lock(mutex_);
        const std::uint64_t others = counters_.unwritten + counters_.received - own.unwritten - own.received;
        require_disk(counters_.unwritten + bytes, others);
        if (!counts || excess(counters_.promised + counters_.kept + bytes) == 0) return add(counters_);
    }
    admit(bytes, own, add);
}

/// Calls `add` when `bytes` more fit into the budget after evictions. Holds the database's lock, so that bytes that
/// have just become a blob are not counted twice, and what can be evicted stays the same.
void Room::admit(std::uint64_t bytes, const Counters& own, const std::function<void(Counters&)>& add) {
    const auto held = database_.lock();
    const std::lock_guard lock(mutex_);
    require_evictable(excess(counters_.promised + counters_.kept + bytes), bytes, counters_.promised - own.promised);
    add(counters_);
}

void Room::arrive(std::uint64_t bytes, bool counts) {
    const std::lock_guard lock(mutex_);
    require_disk(bytes, 0);
    counters_.unwritten -= bytes;
    if (counts) counters_.received += bytes;
}

void Room::keep(const std::string& upload, std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    set_kept(upload, bytes);
}

void Room::set_kept(const std::string& upload, std::uint64_t bytes) {
    const auto known = kept_.find(upload);
    if (known != kept_.end()) {
        counters_.kept -= known->second;
        kept_.erase(known);
    }
    if (bytes == 0) return;
    kept_[upload] = bytes;
    counters_.kept += bytes;
}

std::uint64_t Room::others() const {
    const std::lock_guard lock(mutex_);
    return counters_.received + counters_.kept;
}

void Room::make_room(std::uint64_t bytes) { make_room(bytes, {}); }

void Room::make_room(std::uint64_t bytes, const Counters& own) {
    if (fits(bytes)) return;
    const auto held = database_.lock();
    const std::uint64_t more = require_room(bytes, own);
    evict_beside(more);
}

void Room::require_room(std::uint64_t bytes) {
    if (fits(bytes)) return;
    const auto held = database_.lock();
    require_room(bytes, {});
}

std::uint64_t Room::lacking(std::uint64_t bytes) {
    const std::uint64_t more = excess(others() + bytes);
    return more == 0 ? 0 : more - std::min(more, evictable_bytes(database_, more));
}

/// With database_.lock() held. Returns what counts beside blobs: `bytes`, bodies under way and unfinished uploads.
std::uint64_t Room::require_room(std::uint64_t bytes, const Counters& own) {
    std::uint64_t more = bytes, under_way = 0;
    {
        const std::lock_guard lock(mutex_);
        more += counters_.received + counters_.kept;
        under_way = counters_.received - own.received;
    }
    require_evictable(excess(more), bytes, under_way);
    return more;
}

void Room::trim() { evict_beside(others()); }

/// Also on a full disk. What one transaction of an eviction did stays done when the next one fails.
void Room::evict_beside(std::uint64_t others) {
    if (excess(others) > 0) reserve_.run([&] { evict(database_, store_, limits_.budget, others); });
}

/// By how much the store's blobs and `more` pass the budget.
std::uint64_t Room::excess(std::uint64_t more) const {
    const std::uint64_t all = store_.total_bytes() + more;
    return all - std::min(all, limits_.budget);
}

/// `excess` must be evictable; `bytes` are wanted. Other bodies have `under_way` bytes of the budget.
void Room::require_evictable(std::uint64_t excess, std::uint64_t bytes, std::uint64_t under_way) const {
    if (excess == 0) return;
    const std::uint64_t evictable = evictable_bytes(database_, excess);
    if (evictable >= excess) return;
    const std::string wanted = bytes > 0 ? std::to_string(bytes) + " more bytes exceed" : "the bytes received exceed";
    const std::string found = wanted + " the store's budget of " + std::to_string(limits_.budget) + " bytes by " +
                              std::to_string(excess) + ", and results of at most " + std::to_string(evictable) +
                              " bytes can be evicted; ";
    if (evictable + under_way >= excess)
        throw Refusal(Refused::busy, found + std::to_string(under_way) +
                                         " bytes are reserved for other bodies under way: try again when they have "
                                         "ended, or raise budget_mb");
    throw Refusal(Refused::full, found +
                                     "inputs and what is being received are never evicted: delete inputs (GET "
                                     "/v1/blobs lists them), or raise budget_mb");
}

/// `bytes` and those of keep_free must be free on the disk. Other bodies have `under_way` bytes of it.
void Room::require_disk(std::uint64_t bytes, std::uint64_t under_way) const {
    const std::uint64_t free = free_bytes();
    if (free >= limits_.keep_free && free - limits_.keep_free >= bytes) return;
    const std::string found = "the disk of " + folder_.string() + " has " + std::to_string(free) +
                              " bytes free; needed are " + std::to_string(bytes) +
                              " for bodies under way, and keep_free_mb keeps " + std::to_string(limits_.keep_free) +
                              " free: ";
    if (free + under_way >= limits_.keep_free + bytes)
        throw Refusal(Refused::busy, found + std::to_string(under_way) +
                                         " bytes are of other bodies: try again when they have ended, or make room "
                                         "on the disk");
    throw Refusal(Refused::full, found + "make room on the disk");
}

std::uint64_t Room::free_bytes() const {
    struct statvfs disk {};
    if (::statvfs(folder_.c_str(), &disk) != 0) throw_store_error(folder_, errno);
    return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

std::vector<std::string> Room::warnings() {
    std::vector<std::string> found;
    for (std::optional<std::string> warning : {disk_warning(), input_warning()})
        if (warning) found.push_back(std::move(*warning));
    return found;
}

std::optional<std::string> Room::disk_warning() {
    const std::uint64_t disk = free_bytes() + store_.total_bytes() + others();
    const std::uint64_t usable = disk - std::min(disk, limits_.keep_free);
    if (usable >= limits_.budget) return std::nullopt;
    return "budget_mb is " + mb(limits_.budget) + "; the disk of " + folder_.string() + " has room for " + mb(usable) +
           " MB of the store, with keep_free_mb = " + mb(limits_.keep_free) +
           ". The disk fills up before results are evicted, and uploads are refused then. Lower budget_mb, or use a "
           "larger disk";
}

std::optional<std::string> Room::input_warning() {
    if (store_.total_bytes() <= limits_.budget) return std::nullopt;  // then inputs fit, too; the sum below is slow
    std::uint64_t inputs = 0;
    database_.read([&](Sql& sql) {
        inputs = static_cast<std::uint64_t>(
            sql.rows("SELECT sum(bytes) FROM sent_blobs JOIN blobs USING(sha256)").at(0).integer(0));
    });
    if (inputs <= limits_.budget) return std::nullopt;
    constexpr std::uint64_t one_mb = 1 << 20;
    return "inputs have " + std::to_string(inputs) + " bytes; budget_mb is " + mb(limits_.budget) + ", which are " +
           std::to_string(limits_.budget) +
           " bytes: inputs are never evicted, so uploads are refused and no result can be stored. Delete inputs (GET "
           "/v1/blobs lists them), or raise budget_mb to more than " +
           mb(inputs + one_mb - 1);
}

}  // namespace hairbake

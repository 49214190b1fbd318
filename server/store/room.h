// The room for more bytes in the store: its budget and its disk, shared by all bodies that are under way.
//
// The budget counts bytes that are on the disk: blobs, unfinished uploads, and what arrived of the bodies under way. A
// length that a client announces removes nothing. It is promised to the body: others cannot have the same room, and a
// body that cannot fit is refused before it is read. Results are evicted when bytes arrive that need their room.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace hairbake {

class BlobStore;
class Database;
class DiskReserve;

struct RoomLimits {
    std::uint64_t budget = 0;     ///< bytes of blobs, unfinished uploads and bodies under way
    std::uint64_t keep_free = 0;  ///< bytes of the disk that bodies must leave free
};

/// Refusal(full) means that stored files leave no room; Refusal(busy), that other bodies under way have it, which may
/// be cut or refused: the client tries again. Thread-safe. May be called with database.lock() held, but not inside
/// database.read() or write().
class Room {
    struct Counters {
        std::uint64_t promised = 0;   ///< to counting bodies under way, with what they received
        std::uint64_t received = 0;   ///< of counting bodies
        std::uint64_t unwritten = 0;  ///< promised to all bodies and not received yet
        std::uint64_t kept = 0;       ///< of unfinished uploads
    };

public:
    /// `folder` is the store's. The others must outlive this object. Evictions use `reserve` on a full disk.
    Room(Database& database, BlobStore& store, DiskReserve& reserve, std::filesystem::path folder,
         const RoomLimits& limits);

    /// In bytes.
    std::uint64_t budget() const { return limits_.budget; }

    /// The room of one body under way; it is given back at the end. Not thread-safe.
    class Share {
    public:
        Share(Share&& other) noexcept;
        Share& operator=(Share&&) = delete;
        ~Share() { give_back(); }

        /// Call it before `bytes` more are written. Evicts results when these bytes need their room.
        /// Throws Refusal(full or busy) when there is no room. A body whose length was announced gets here only if the
        /// room was lost meanwhile: a result was stored, or another program filled the disk.
        void grow(std::uint64_t bytes);

        /// The body's bytes are of a blob that is stored no longer: they count from now on.
        /// Throws Refusal(full or busy).
        void count();

        /// Call it with database.lock() held when the bytes have become a blob, or are gone.
        void give_back();

        /// The bytes stay on the disk, as those of an unfinished upload that now has `total` bytes; see Room::keep().
        void become_kept(const std::string& upload, std::uint64_t total);

    private:
        friend class Room;
        Share(Room& room, bool counts) : room_(&room), counts_(counts) {}
        void promise(std::uint64_t bytes);
        void forget();
        Counters own() const;

        Room* room_;                                 ///< nullptr when it was given back
        bool counts_;                                ///< against the budget
        std::uint64_t promised_ = 0, received_ = 0;  ///< received_ <= promised_
    };

    /// For a body of `announced` bytes, or of unknown length (chunks).
    ///
    /// `is_stored`: the blob is stored already, so the bytes need room on the disk alone, and only until they are
    /// checked.
    /// Throws Refusal(full or busy) when the announced bytes have no room, also if all results were evicted.
    Share reserve(std::optional<std::uint64_t> announced, bool is_stored = false);

    /// Notes how many bytes an unfinished upload has on the disk; 0 when it is gone.
    void keep(const std::string& upload, std::uint64_t bytes);

    /// Evicts results so that `bytes` more fit, which the caller stores before it gives database.lock() back. Evicts
    /// nothing when that is not enough.
    /// Throws Refusal(full or busy).
    void make_room(std::uint64_t bytes);

    /// Brings the store back into its budget as far as evictions can.
    void trim();

    /// Throws as make_room(), and evicts nothing.
    void require_room(std::uint64_t bytes);

    /// Bytes that `bytes` more lack also after all evictions; 0 where they fit.
    std::uint64_t lacking(std::uint64_t bytes);

    /// Bytes that the disk has free.
    std::uint64_t disk_free() const { return free_bytes(); }

    /// Whether `bytes` more fit without an eviction.
    bool fits(std::uint64_t bytes) const { return excess(others() + bytes) == 0; }

    /// What an operator should know: the disk is smaller than the budget, or inputs alone exceed it.
    std::vector<std::string> warnings();

private:
    void promise(std::uint64_t bytes, bool counts, const Counters& own);
    void admit(std::uint64_t bytes, const Counters& own, const std::function<void(Counters&)>& add);
    void make_room(std::uint64_t bytes, const Counters& own);
    std::uint64_t require_room(std::uint64_t bytes, const Counters& own);
    std::optional<std::string> disk_warning();
    std::optional<std::string> input_warning();
    void evict_beside(std::uint64_t others);
    void arrive(std::uint64_t bytes, bool counts);
    void set_kept(const std::string& upload, std::uint64_t bytes);
    std::uint64_t others() const;
    std::uint64_t excess(std::uint64_t more) const;
    void require_evictable(std::uint64_t excess, std::uint64_t bytes, std::uint64_t under_way) const;
    void require_disk(std::uint64_t bytes, std::uint64_t under_way) const;
    std::uint64_t free_bytes() const;

    Database& database_;
    BlobStore& store_;
    DiskReserve& reserve_;
    const std::filesystem::path folder_;
    const RoomLimits limits_;
    mutable std::mutex mutex_;  ///< guards the members below; taken after database.lock(), never before
    Counters counters_;
    std::map<std::string, std::uint64_t> kept_;  ///< by upload
};

}  // namespace hairbake

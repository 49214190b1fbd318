#include "core/hair/strand_warnings.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "core/base/parallel.h"

namespace hairbake {
namespace {

constexpr double farthest = 1e5;  // from the origin, in sizes of the model

std::span<const Vec3f> points_of(const StrandGeometry& strands, std::size_t strand) {
    const std::uint32_t begin = strands.strand_begin[strand], end = strands.strand_begin[strand + 1];
    return std::span(strands.positions).subspan(begin, end - begin);
}

/// FNV-1a over the bytes of the strand's points.
std::uint64_t hash_of(std::span<const Vec3f> points) {
    std::uint64_t hash = 14695981039346656037ull;
    for (const std::byte byte : std::as_bytes(points))
        hash = (hash ^ static_cast<std::uint64_t>(byte)) * 1099511628211ull;
    return hash;
}

struct HashedStrand {
    std::uint64_t hash;
    std::uint32_t strand;
    auto operator<=>(const HashedStrand&) const = default;
};

/// The number of strands whose points another strand has too, without one of each kind; `first` is the first of them.
std::size_t count_duplicates(const StrandGeometry& strands, std::uint32_t& first) {
    std::vector<HashedStrand> hashed(strands.strand_count());
    parallel_for(hashed.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s)
            hashed[s] = {hash_of(points_of(strands, s)), static_cast<std::uint32_t>(s)};
    });
    std::sort(hashed.begin(), hashed.end());
    std::size_t count = 0;
    for (std::size_t k = 1; k < hashed.size(); ++k) {
        if (hashed[k].hash != hashed[k - 1].hash) continue;
        const auto a = points_of(strands, hashed[k - 1].strand), b = points_of(strands, hashed[k].strand);
        if (a.size() < 2 || !std::equal(a.begin(), a.end(), b.begin(), b.end())) continue;
        first = count == 0 ? hashed[k].strand : std::min(first, hashed[k].strand);
        ++count;
    }
    return count;
}

double largest_coordinate(const StrandGeometry& strands) {
    double largest = 0;
    for (const Vec3f& corner : {strands.bounds_min, strands.bounds_max})
        for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(double(corner[axis])));
    return largest;
}

double size_of(const StrandGeometry& strands) {
    const Vec3d side = Vec3d(strands.bounds_max) - Vec3d(strands.bounds_min);
    return std::max({side.x, side.y, side.z});
}

}  // namespace

std::vector<std::string> strand_warnings(const StrandGeometry& strands) {
    if (strands.vertex_count() == 0) return {"the hair model has no vertex"};
    std::vector<std::string> warnings;
    std::uint32_t first = 0;
    if (const std::size_t count = count_duplicates(strands, first); count > 0)
        warnings.push_back(std::to_string(count) + (count == 1 ? " strand has" : " strands have") +
                           " the same points as another strand, the first of them strand " + std::to_string(first) +
                           ": strands inside each other are black; remove the duplicates");
    const double size = size_of(strands), far = largest_coordinate(strands);
    if (size > 0 && far > farthest * size)
        warnings.push_back("the hair lies " + std::to_string(static_cast<long long>(far / size)) +
                           " times its own size from the origin, where single precision loses the places of strands; "
                           "move the model to the origin");
    return warnings;
}

}  // namespace hairbake

#include "core/volume/strand_pieces.h"

#include <atomic>
#include <memory>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace hairbake {
namespace {

/// The model is walked in this many chunks whatever the thread count; each counts and then writes for itself.
constexpr std::size_t kChunks = 32;

/// Calls visit(segment, part, i, j, k) for every piece of the segments in [begin, end).
template <class Visit>
void for_each_piece(const StrandGeometry& strands, const GridFrame& frame, std::size_t begin, std::size_t end,
                    const Visit& visit) {
    for (std::size_t i = begin; i < end; ++i) {
        if (strands.segments[i] != Segment::solid) continue;
        const auto segment = static_cast<std::uint32_t>(i);
        const CutSegment cut = cut_segment(strands, frame, segment);
        for (int part = 0; part < cut.parts; ++part) {
            const Vec3f c = cut.centre(part);
            visit(segment, part, static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z));
        }
    }
}

template <class Visit>
void for_each_vertex(const StrandGeometry& strands, const GridFrame& frame, std::size_t begin, std::size_t end,
                     const Visit& visit) {
    for (std::size_t v = begin; v < end; ++v) {
        const Vec3f g = frame.to_grid(strands.positions[v]);
        visit(static_cast<std::uint32_t>(v), frame.brick_of(static_cast<int>(g.x), static_cast<int>(g.y), static_cast<int>(g.z)));
    }
}

/// Runs body(chunk, begin, end) for the kChunks chunks of the model's points.
template <class Body>
void for_each_chunk(const StrandGeometry& strands, const Body& body) {
    const std::size_t count = strands.vertex_count(), grain = (count + kChunks - 1) / kChunks;
    parallel_for(count, grain, [&](std::size_t begin, std::size_t end) { body(begin / grain, begin, end); });
}

void find_occupied_bricks(const StrandGeometry& strands, const GridFrame& frame, SortedStrands& sorted) {
    const std::uint32_t count = frame.brick_count();
    const auto occupied = std::make_unique<std::atomic<std::uint8_t>[]>(count);
    const auto mark = [&](std::uint32_t brick) {
        if (!occupied[brick].load(std::memory_order_relaxed)) occupied[brick].store(1, std::memory_order_relaxed);
    };
    for_each_chunk(strands, [&](std::size_t, std::size_t begin, std::size_t end) {
        for_each_piece(strands, frame, begin, end,
                       [&](std::uint32_t, int, int i, int j, int k) { mark(frame.brick_of(i, j, k)); });
        for_each_vertex(strands, frame, begin, end, [&](std::uint32_t, std::uint32_t brick) { mark(brick); });
    });
    sorted.slot_of_brick.assign(count, -1);
    for (std::uint32_t brick = 0; brick < count; ++brick)
        if (occupied[brick]) {
            sorted.slot_of_brick[brick] = static_cast<std::int32_t>(sorted.bricks.size());
            sorted.bricks.push_back(brick);
        }
}

/// Turns counts[chunk][brick] into the place where each chunk writes its first item of each brick, and returns the
/// beginnings of the bricks.
template <class Index>
std::vector<Index> counts_to_places(std::vector<std::vector<Index>>& counts, std::size_t bricks) {
    std::vector<Index> begin(bricks + 1);
    Index sum = 0;
    for (std::size_t b = 0; b < bricks; ++b) {
        begin[b] = sum;
        for (auto& chunk : counts) {
            const Index n = chunk[b];
            chunk[b] = sum;
            sum += n;
        }
    }
    begin[bricks] = sum;
    return begin;
}

void sort_pieces(const StrandGeometry& strands, const GridFrame& frame, SortedStrands& sorted) {
    std::vector<std::vector<std::size_t>> places(kChunks, std::vector<std::size_t>(sorted.brick_count()));
    const auto slot = [&](int i, int j, int k) {
        return static_cast<std::size_t>(sorted.slot_of_brick[frame.brick_of(i, j, k)]);
    };
    for_each_chunk(strands, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        for_each_piece(strands, frame, begin, end,
                       [&](std::uint32_t, int, int i, int j, int k) { ++places[chunk][slot(i, j, k)]; });
    });
    sorted.piece_begin = counts_to_places(places, sorted.brick_count());
    sorted.pieces.resize(sorted.piece_begin.back());
    for_each_chunk(strands, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        for_each_piece(strands, frame, begin, end, [&](std::uint32_t segment, int part, int i, int j, int k) {
            sorted.pieces[places[chunk][slot(i, j, k)]++] = {
                segment, static_cast<std::uint16_t>(part),
                static_cast<std::uint16_t>(GridFrame::voxel_in_brick(i, j, k))};
        });
    });
}

void sort_vertices(const StrandGeometry& strands, const GridFrame& frame, SortedStrands& sorted) {
    std::vector<std::vector<std::uint32_t>> places(kChunks, std::vector<std::uint32_t>(sorted.brick_count()));
    const auto slot = [&](std::uint32_t brick) { return static_cast<std::size_t>(sorted.slot_of_brick[brick]); };
    for_each_chunk(strands, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        for_each_vertex(strands, frame, begin, end,
                        [&](std::uint32_t, std::uint32_t brick) { ++places[chunk][slot(brick)]; });
    });
    sorted.vertex_begin = counts_to_places(places, sorted.brick_count());
    sorted.vertices.resize(strands.vertex_count());
    for_each_chunk(strands, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        for_each_vertex(strands, frame, begin, end, [&](std::uint32_t v, std::uint32_t brick) {
            sorted.vertices[places[chunk][slot(brick)]++] = v;
        });
    });
}

}  // namespace

SortedStrands sort_strands(const StrandGeometry& strands, const GridFrame& frame, Progress& progress) {
    SortedStrands sorted;
    find_occupied_bricks(strands, frame, sorted);
    progress.check();
    sort_pieces(strands, frame, sorted);
    progress.check();
    sort_vertices(strands, frame, sorted);
    return sorted;
}

}  // namespace hairbake

#include "core/volume/strand_pieces.h"

#include <array>
#include <string>
#include <utility>

#include "core/base/assert.h"
#include "core/base/error.h"
#include "core/base/parallel.h"

namespace hairbake {
namespace {

/// The model is walked in this many chunks for any thread count; each chunk counts and then writes by itself.
constexpr std::size_t kChunks = 16;

using Counts = std::vector<std::vector<std::uint32_t>>;  ///< [chunk][brick]

/// Calls visit(piece, brick) for every piece of the segments in [begin, end).
template <class Visit>
void for_each_piece(const StrandGeometry& strands, const GridFrame& frame, std::size_t begin, std::size_t end,
                    const Visit& visit) {
    const auto inverse_h = static_cast<float>(1 / frame.voxel_size);
    for (std::size_t i = begin; i < end; ++i) {
        if (strands.segments[i] != Segment::solid) continue;
        const float opacity = 0.5f * (strands.opacities[i] + strands.opacities[i + 1]);
        if (!(opacity > 0)) continue;
        const float width = 0.5f * (strands.widths[i] + strands.widths[i + 1]);
        const Vec3f start = frame.to_grid(strands.positions[i]);
        const Vec3f whole = frame.to_grid(strands.positions[i + 1]) - start;
        const int parts = std::max(1, static_cast<int>(std::ceil(length(whole))));
        StrandPiece piece;
        piece.step = whole / static_cast<float>(parts);
        piece.weight = opacity * width * inverse_h;
        piece.segment = static_cast<std::uint32_t>(i);
        for (int part = 0; part < parts; ++part) {
            piece.centre = start + (static_cast<float>(part) + 0.5f) * piece.step;
            visit(piece, frame.brick_at(piece.centre));
        }
    }
}

/// Calls visit(vertex, position in grid space) for every vertex in [begin, end).
template <class Visit>
void for_each_vertex(const StrandGeometry& strands, const GridFrame& frame, std::size_t begin, std::size_t end,
                     const Visit& visit) {
    for (std::size_t v = begin; v < end; ++v) visit(static_cast<std::uint32_t>(v), frame.to_grid(strands.positions[v]));
}

/// Runs body(chunk, begin, end) for the chunks of the model's points.
template <class Body>
void for_each_chunk(const StrandGeometry& strands, const Body& body) {
    const std::size_t count = strands.vertex_count(), grain = (count + kChunks - 1) / kChunks;
    parallel_for(count, grain, [&](std::size_t begin, std::size_t end) { body(begin / grain, begin, end); });
}

/// Counts the pieces and vertices of each chunk in each brick of the frame.
void count_items(const StrandGeometry& strands, const GridFrame& frame, Counts& pieces, Counts& vertices) {
    pieces.resize(kChunks);
    vertices.resize(kChunks);
    for_each_chunk(strands, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        auto& piece_count = pieces[chunk];
        auto& vertex_count = vertices[chunk];
        piece_count.assign(frame.brick_count(), 0);
        vertex_count.assign(frame.brick_count(), 0);
        for_each_piece(strands, frame, begin, end,
                       [&](const StrandPiece&, std::uint32_t brick) { ++piece_count[brick]; });
        for_each_vertex(strands, frame, begin, end,
                        [&](std::uint32_t, const Vec3f& position) { ++vertex_count[frame.brick_at(position)]; });
    });
    for (Counts* counts : {&pieces, &vertices}) std::erase_if(*counts, [](const auto& chunk) { return chunk.empty(); });
}

void find_occupied_bricks(const Counts& pieces, const Counts& vertices, SortedStrands& sorted) {
    const std::size_t count = pieces.front().size();
    sorted.slot_of_brick.assign(count, -1);
    for (std::size_t brick = 0; brick < count; ++brick) {
        bool occupied = false;
        for (std::size_t chunk = 0; chunk < pieces.size() && !occupied; ++chunk)
            occupied = pieces[chunk][brick] > 0 || vertices[chunk][brick] > 0;
        if (!occupied) continue;
        sorted.slot_of_brick[brick] = static_cast<std::int32_t>(sorted.bricks.size());
        sorted.bricks.push_back(static_cast<std::uint32_t>(brick));
    }
}

/// Turns each count into the place where the chunk writes its first item of the brick. Returns the place where each
/// occupied brick begins.
/// Throws Error(out_of_resources).
std::vector<std::uint32_t> counts_to_places(Counts& counts, const std::vector<std::uint32_t>& bricks) {
    std::vector<std::uint32_t> begin;
    std::uint64_t sum = 0;
    for (const std::uint32_t brick : bricks) {
        begin.push_back(static_cast<std::uint32_t>(sum));
        for (auto& chunk : counts) sum += std::exchange(chunk[brick], static_cast<std::uint32_t>(sum));
    }
    if (sum >= std::uint64_t{1} << 32)
        throw Error(ErrorKind::out_of_resources,
                    "the strands cross " + std::to_string(sum) +
                        " voxels; allowed are at most 4294967295. Ask for fewer voxels (transmittance.voxels)",
                    "transmittance.voxels");
    begin.push_back(static_cast<std::uint32_t>(sum));
    return begin;
}

void place_items(const StrandGeometry& strands, const GridFrame& frame, Counts& piece_places, Counts& vertex_places,
                 SortedStrands& sorted) {
    sorted.pieces.resize(sorted.piece_begin.back());
    sorted.vertices.resize(sorted.vertex_begin.back());
    sorted.vertex_positions.resize(sorted.vertex_begin.back());
    for_each_chunk(strands, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        auto& piece_place = piece_places[chunk];
        auto& vertex_place = vertex_places[chunk];
        for_each_piece(strands, frame, begin, end, [&](const StrandPiece& piece, std::uint32_t brick) {
            sorted.pieces[piece_place[brick]++] = piece;
        });
        for_each_vertex(strands, frame, begin, end, [&](std::uint32_t v, const Vec3f& position) {
            const std::uint32_t place = vertex_place[frame.brick_at(position)]++;
            sorted.vertices[place] = v;
            sorted.vertex_positions[place] = position;
        });
    });
}

/// Sorts the pieces of every brick by voxel.
void sort_within_bricks(SortedStrands& sorted) {
    sorted.voxel_end.resize(sorted.brick_count() * 512);
    parallel_for(sorted.brick_count(), 64, [&](std::size_t begin, std::size_t end) {
        std::vector<StrandPiece> unsorted;
        for (std::size_t b = begin; b < end; ++b) {
            unsorted.assign(sorted.pieces.data() + sorted.piece_begin[b],
                            sorted.pieces.data() + sorted.piece_begin[b + 1]);
            std::array<std::uint32_t, 512> place{};
            for (const StrandPiece& piece : unsorted) ++place[static_cast<std::size_t>(piece.voxel_in_brick())];
            std::uint32_t sum = sorted.piece_begin[b];
            for (auto& p : place) sum += std::exchange(p, sum);
            for (const StrandPiece& piece : unsorted)
                sorted.pieces[place[static_cast<std::size_t>(piece.voxel_in_brick())]++] = piece;
            std::copy(place.begin(), place.end(), sorted.voxel_end.begin() + static_cast<std::ptrdiff_t>(b * 512));
        }
    });
}

}  // namespace

SortedStrands sort_strands(const StrandGeometry& strands, const GridFrame& frame, Progress& progress) {
    HAIRBAKE_ASSERT(strands.vertex_count() > 0);
    SortedStrands sorted;
    Counts pieces, vertices;
    count_items(strands, frame, pieces, vertices);
    progress.check();
    find_occupied_bricks(pieces, vertices, sorted);
    sorted.piece_begin = counts_to_places(pieces, sorted.bricks);
    sorted.vertex_begin = counts_to_places(vertices, sorted.bricks);
    place_items(strands, frame, pieces, vertices, sorted);
    progress.check();
    sort_within_bricks(sorted);
    return sorted;
}

}  // namespace hairbake

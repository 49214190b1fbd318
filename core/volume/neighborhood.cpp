#include "core/volume/neighborhood.h"

#include <Imath/half.h>

#include <algorithm>

namespace hairbake {
namespace {

constexpr std::size_t kVectorPadding = 16;

/// The brick (-1, 0 or 1 from the middle one) that holds local voxel coordinate 0 to 9, and the voxel inside it.
int brick_step(int local) { return local == 0 ? -1 : local == 9 ? 1 : 0; }
int inner(int local) { return (local + 7) & 7; }

/// A piece that is longer than half a voxel is stored as two halves.
bool is_halved(const StrandPiece& piece) { return dot(piece.step, piece.step) > 0.25f; }

}  // namespace

void Neighborhood::collect(const HairVolume& volume, std::size_t brick, std::span<const float> opacities) {
    const std::array<int, 3> place = volume.frame.brick_coordinates(volume.sorted.bricks[brick]);
    corner = Vec3f(float(8 * place[0] - 1), float(8 * place[1] - 1), float(8 * place[2] - 1));
    find_places(volume, place);
    collect_pieces(volume.sorted, opacities);
    collect_tensors(volume.bricks);
}

void Neighborhood::find_places(const HairVolume& volume, const std::array<int, 3>& brick) {
    const SortedStrands& sorted = volume.sorted;
    places_.clear();
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            std::array<std::int32_t, 3> slots{};
            for (int k = -1; k <= 1; ++k)
                slots[static_cast<std::size_t>(k + 1)] =
                    sorted.slot_at(volume.frame, brick[0] + brick_step(i), brick[1] + brick_step(j), brick[2] + k);
            for (int k = 0; k < side; ++k) {
                const std::int32_t slot = slots[static_cast<std::size_t>(brick_step(k) + 1)];
                if (slot < 0) continue;
                const auto inside = static_cast<std::uint32_t>(inner(i) << 6 | inner(j) << 3 | inner(k));
                if (sorted.pieces_in(static_cast<std::size_t>(slot), inside).empty()) continue;
                places_.push_back(
                    {static_cast<std::uint32_t>(slot), inside, static_cast<std::uint32_t>(voxel(i, j, k))});
            }
        }
}

template <class Visit>
void Neighborhood::for_each_half(const StrandPiece& piece, const Visit& visit) const {
    const auto offer = [&](const Vec3f& local) {
        const int i = cell_of(local.x), j = cell_of(local.y), k = cell_of(local.z);
        if (i < 0 || j < 0 || k < 0 || i >= cell_side || j >= cell_side || k >= cell_side) return;
        visit(local, static_cast<std::size_t>(cell(i, j, k)));
    };
    const Vec3f local = piece.centre - corner, quarter = 0.25f * piece.step;
    if (!is_halved(piece)) return offer(local);
    offer(local - quarter);
    offer(local + quarter);
}

/// Sorts by counting: one pass over the pieces counts the cells, a second one stores.
void Neighborhood::collect_pieces(const SortedStrands& sorted, std::span<const float> opacities) {
    begin.fill(0);
    for (const Place& place : places_)
        for (const StrandPiece& piece : sorted.pieces_in(place.slot, place.voxel))
            for_each_half(piece, [&](const Vec3f&, std::size_t cell) { ++begin[cell + 1]; });
    for (std::size_t c = 0; c < cells; ++c) begin[c + 1] += begin[c];
    reserve(begin[cells]);
    // Storing moves begin[c] to the end of cell c, which is the beginning of the next.
    for (const Place& place : places_)
        for (const StrandPiece& piece : sorted.pieces_in(place.slot, place.voxel)) {
            const float step_length = length(piece.step);
            const Vec3f axis = piece.step / step_length;
            const float half = step_length * (is_halved(piece) ? 0.25f : 0.5f);
            const float opacity = 0.5f * (opacities[piece.segment] + opacities[piece.segment + 1]);
            for_each_half(piece, [&](const Vec3f& local, std::size_t cell) {
                store(piece, local, axis, half, opacity, begin[cell]++);
            });
        }
    std::copy_backward(begin.begin(), begin.end() - 1, begin.end());
    begin[0] = 0;
}

void Neighborhood::reserve(std::size_t count) {
    const std::size_t size = count + kVectorPadding;
    if (segment.size() >= size) return;
    for (auto* array : {&centre_x, &centre_y, &centre_z, &axis_x, &axis_y, &axis_z, &half_length, &weight, &least})
        array->resize(size + size / 2);
    segment.resize(size + size / 2);
}

void Neighborhood::store(const StrandPiece& piece, const Vec3f& local, const Vec3f& axis, float half, float opacity,
                         std::uint32_t at) {
    centre_x[at] = local.x;
    centre_y[at] = local.y;
    centre_z[at] = local.z;
    axis_x[at] = axis.x;
    axis_y[at] = axis.y;
    axis_z[at] = axis.z;
    half_length[at] = half;
    weight[at] = piece.weight;
    least[at] = 0.5f * piece.weight / opacity;
    segment[at] = static_cast<std::int32_t>(piece.segment);
}

void Neighborhood::collect_tensors(const ExtinctionBricks& bricks) {
    for (auto& component : tensor) component.assign(side * side * side, 0);
    for (const Place& place : places_) {
        float trace = 0;
        for (int c = 0; c < ExtinctionBricks::components; ++c) {
            Imath::half half;
            half.setBits(bricks.component(place.slot, c)[place.voxel]);
            tensor[static_cast<std::size_t>(c)][place.local] = half;
            if (c < 3) trace += half;
        }
        tensor.back()[place.local] = trace;
    }
}

}  // namespace hairbake

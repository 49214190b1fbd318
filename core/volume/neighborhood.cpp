#include "core/volume/neighborhood.h"

#include <Imath/half.h>

#include <algorithm>

namespace hairbake {
namespace {

constexpr std::size_t kVectorPadding = 16;

/// Of local voxel coordinate 0..9: which of the three bricks on that axis, and the voxel inside it.
int brick_step(int local) { return local == 0 ? -1 : local == 9 ? 1 : 0; }
int inner(int local) { return (local + 7) & 7; }

}  // namespace

void Neighborhood::collect(const GridFrame& frame, const SortedStrands& sorted, const ExtinctionBricks& bricks,
                           std::size_t brick) {
    const std::array<int, 3> place = frame.brick_coordinates(sorted.bricks[brick]);
    corner = Vec3f(float(8 * place[0] - 1), float(8 * place[1] - 1), float(8 * place[2] - 1));
    find_places(frame, sorted, place);
    collect_pieces(sorted);
    collect_tensors(bricks);
}

void Neighborhood::find_places(const GridFrame& frame, const SortedStrands& sorted, const std::array<int, 3>& brick) {
    places_.clear();
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            std::array<std::int32_t, 3> slots{};
            for (int k = -1; k <= 1; ++k)
                slots[static_cast<std::size_t>(k + 1)] =
                    sorted.slot_at(frame, brick[0] + brick_step(i), brick[1] + brick_step(j), brick[2] + k);
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

void Neighborhood::collect_pieces(const SortedStrands& sorted) {
    halves_.clear();
    for (const Place& place : places_)
        for (const StrandPiece& piece : sorted.pieces_in(place.slot, place.voxel)) add_halves(piece);
    sort_halves();
}

void Neighborhood::add_halves(const StrandPiece& piece) {
    const auto add = [&](const Vec3f& centre, const Vec3f& step) {
        const Vec3f local = centre - corner;
        const int i = cell_of(local.x), j = cell_of(local.y), k = cell_of(local.z);
        if (i < 0 || j < 0 || k < 0 || i >= cell_side || j >= cell_side || k >= cell_side) return;
        halves_.push_back({{local, step, piece.weight, piece.segment}, cell(i, j, k)});
    };
    if (dot(piece.step, piece.step) <= 0.25f) return add(piece.centre, piece.step);
    add(piece.centre - 0.25f * piece.step, 0.5f * piece.step);
    add(piece.centre + 0.25f * piece.step, 0.5f * piece.step);
}

void Neighborhood::sort_halves() {
    begin.fill(0);
    for (const Half& half : halves_) ++begin[static_cast<std::size_t>(half.cell) + 1];
    for (std::size_t c = 0; c < cells; ++c) begin[c + 1] += begin[c];
    const std::size_t size = halves_.size() + kVectorPadding;
    for (auto* array : {&centre_x, &centre_y, &centre_z, &axis_x, &axis_y, &axis_z, &half_length, &weight})
        if (array->size() < size) array->resize(size);
    if (segment.size() < size) segment.resize(size);
    for (const Half& half : halves_) {  // moves begin[c] to the end of cell c; shifted back below
        const std::uint32_t at = begin[static_cast<std::size_t>(half.cell)]++;
        const float step_length = length(half.piece.step);
        const Vec3f axis = half.piece.step / step_length;
        centre_x[at] = half.piece.centre.x;
        centre_y[at] = half.piece.centre.y;
        centre_z[at] = half.piece.centre.z;
        axis_x[at] = axis.x;
        axis_y[at] = axis.y;
        axis_z[at] = axis.z;
        half_length[at] = 0.5f * step_length;
        weight[at] = half.piece.weight;
        segment[at] = static_cast<std::int32_t>(half.piece.segment);
    }
    std::copy_backward(begin.begin(), begin.end() - 1, begin.end());
    begin[0] = 0;
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

#include "core/volume/neighborhood.h"

#include <Imath/half.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hairbake {
namespace {

constexpr std::size_t kVectorPadding = 16;

/// Of local voxel coordinate 0..9: which of the three bricks on that axis, and the voxel inside it.
int brick_step(int local) { return local == 0 ? 0 : local == 9 ? 2 : 1; }
int inner(int local) { return (local + 7) & 7; }

}  // namespace

void Neighborhood::collect(const StrandGeometry& strands, const GridFrame& frame, const SortedStrands& sorted,
                           const ExtinctionBricks& bricks, const NearFieldWindow& window, std::size_t brick) {
    const std::array<int, 3> place = frame.brick_coordinates(sorted.bricks[brick]);
    corner = Vec3f(float(8 * place[0] - 1), float(8 * place[1] - 1), float(8 * place[2] - 1));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                neighbors_[static_cast<std::size_t>(9 * i + 3 * j + k)] =
                    sorted.slot_at(frame, place[0] + i - 1, place[1] + j - 1, place[2] + k - 1);
    collect_pieces(strands, frame, sorted);
    collect_depths(bricks, window);
}

void Neighborhood::collect_pieces(const StrandGeometry& strands, const GridFrame& frame, const SortedStrands& sorted) {
    for (auto* array : {&centre_x, &centre_y, &centre_z, &axis_x, &axis_y, &axis_z, &half_length, &weight, &radius2})
        array->clear();
    segment.clear();
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            for (int k = 0; k < side; ++k) {
                begin[static_cast<std::size_t>(cell(i, j, k))] = static_cast<std::uint32_t>(segment.size());
                const std::int32_t slot =
                    neighbors_[static_cast<std::size_t>(9 * brick_step(i) + 3 * brick_step(j) + brick_step(k))];
                if (slot < 0) continue;
                const auto voxel = static_cast<std::size_t>(inner(i) << 6 | inner(j) << 3 | inner(k));
                for (const StrandPiece& piece : sorted.pieces_in(static_cast<std::size_t>(slot), voxel))
                    append(strands, frame, piece);
            }
    begin[cells] = static_cast<std::uint32_t>(segment.size());
    for (auto* array : {&centre_x, &centre_y, &centre_z, &axis_x, &axis_y, &axis_z, &half_length, &weight, &radius2})
        array->resize(array->size() + kVectorPadding);
    segment.resize(segment.size() + kVectorPadding);
}

void Neighborhood::append(const StrandGeometry& strands, const GridFrame& frame, const StrandPiece& piece) {
    const CutSegment cut = cut_segment(strands, frame, piece.segment);
    const Vec3f centre = cut.centre(piece.part) - corner;
    const float piece_length = length(cut.step);
    const Vec3f axis = cut.step / piece_length;
    const std::uint32_t s = piece.segment;
    const float width =
        0.5f * (strands.widths[s] + strands.widths[s + 1]) / static_cast<float>(frame.voxel_size);
    centre_x.push_back(centre.x);
    centre_y.push_back(centre.y);
    centre_z.push_back(centre.z);
    axis_x.push_back(axis.x);
    axis_y.push_back(axis.y);
    axis_z.push_back(axis.z);
    half_length.push_back(0.5f * piece_length);
    weight.push_back(0.5f * (strands.opacities[s] + strands.opacities[s + 1]) * width);
    radius2.push_back(0.25f * width * width);
    segment.push_back(static_cast<std::int32_t>(s));
}

void Neighborhood::collect_depths(const ExtinctionBricks& bricks, const NearFieldWindow& window) {
    for (auto& component : tensor_) component.assign(cells, 0);
    trace_.assign(cells, 0);
    depth_.resize(cells * NearFieldWindow::padded);
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            for (int k = 0; k < side; ++k) {
                const std::int32_t slot =
                    neighbors_[static_cast<std::size_t>(9 * brick_step(i) + 3 * brick_step(j) + brick_step(k))];
                const auto voxel = static_cast<std::size_t>(inner(i) << 6 | inner(j) << 3 | inner(k));
                if (slot < 0 || bricks.trace[static_cast<std::size_t>(slot) * 512 + voxel] == 0) continue;
                const auto at = static_cast<std::size_t>(cell(i, j, k));
                for (int c = 0; c < 6; ++c) {
                    Imath::half half;
                    half.setBits(bricks.component(static_cast<std::size_t>(slot), c)[voxel]);
                    tensor_[static_cast<std::size_t>(c)][at] = half;
                }
                trace_[at] = tensor_[0][at] + tensor_[1][at] + tensor_[2][at];
            }
    for (std::size_t o = 0; o < NearFieldWindow::padded; ++o) {
        const float x = window.direction_x[o], y = window.direction_y[o], z = window.direction_z[o];
        const bool own = x == 0 && y == 0 && z == 0;
        const int step = o < NearFieldWindow::offsets ? cell(int(o / 9) - 1, int(o / 3 % 3) - 1, int(o % 3) - 1) : 0;
        for (int i = 1; i <= 8; ++i)
            for (int j = 1; j <= 8; ++j)
                for (int k = 1; k <= 8; ++k) {
                    const auto from = static_cast<std::size_t>(cell(i, j, k) + step);
                    const float trace = trace_[from];
                    const float along = tensor_[0][from] * x * x + tensor_[1][from] * y * y + tensor_[2][from] * z * z +
                                        2 * (tensor_[3][from] * x * y + tensor_[4][from] * x * z + tensor_[5][from] * y * z);
                    const float depth = own ? trace * (std::numbers::pi_v<float> / 4)
                                            : std::sqrt(trace * std::max(0.0f, trace - along));
                    depth_[static_cast<std::size_t>(cell(i, j, k)) * NearFieldWindow::padded + o] =
                        window.weight[o] * depth;
                }
    }
}

}  // namespace hairbake

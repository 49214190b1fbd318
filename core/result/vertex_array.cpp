#include "core/result/vertex_array.h"

#include <algorithm>

namespace hairbake {
namespace {

constexpr ArrayKind table[] = {
    {"transmittance", "average transmittance A of every vertex", "transmittance", ArrayOwner::hair, ArrayLayout::scalar,
     [](const BakeRequest& request) -> std::size_t { return request.hair ? 1 : 0; }, true},
    {"transmittance_sh",
     "spherical harmonics of every vertex's transmittance, order l*l + l + m, z polar; A = c_0 / (2 sqrt(pi))",
     "transmittance", ArrayOwner::hair, ArrayLayout::coefficients,
     [](const BakeRequest& request) {
         const auto bands = static_cast<std::size_t>(request.hair ? request.transmittance.sh_bands : 0);
         return bands * bands;
     },
     false},
    {"bent_cone",
     "bent cone of every vertex: unit axis and half-angle in radians; 0, 0, 0, pi where nothing is blocked",
     "transmittance", ArrayOwner::hair, ArrayLayout::vector,
     [](const BakeRequest& request) -> std::size_t { return request.hair && request.transmittance.bent_cone ? 4 : 0; },
     false},
    {"effective_transmittance",
     "transmittance under the bake's own light: Ad of each channel or of luminance, then As = c_0 + c_1 cos theta' + "
     "...",
     "effective_transmittance", ArrayOwner::hair, ArrayLayout::coefficients,
     [](const BakeRequest& request) {
         const EffectiveSettings& settings = request.effective_transmittance;
         return static_cast<std::size_t>(settings.enabled ? settings.components() : 0);
     },
     false},
    {"receiver",
     "transmittance over the hemisphere about every receiver vertex's normal: mean, and cosine-weighted mean",
     "transmittance", ArrayOwner::receiver, ArrayLayout::vector,
     [](const BakeRequest& request) -> std::size_t { return request.receiver ? 2 : 0; }, true},
};

/// Stops the compiler for a name that is not in the table.
consteval const ArrayKind& row(std::string_view name) {
    for (const ArrayKind& kind : table)
        if (kind.name == name) return kind;
    throw "no such row";
}

}  // namespace

std::span<const ArrayKind> array_kinds() { return table; }

const ArrayKind& average_transmittance_kind() { return row("transmittance"); }
const ArrayKind& transmittance_sh_kind() { return row("transmittance_sh"); }
const ArrayKind& bent_cone_kind() { return row("bent_cone"); }
const ArrayKind& effective_transmittance_kind() { return row("effective_transmittance"); }
const ArrayKind& receiver_kind() { return row("receiver"); }

std::vector<std::size_t> VertexArray::shape() const {
    if (kind->layout == ArrayLayout::scalar) return {rows()};
    return {rows(), components};
}

const ArrayKind* find_array_kind(std::string_view name) {
    for (const ArrayKind& kind : table)
        if (kind.name == name) return &kind;
    return nullptr;
}

const VertexArray* find_array(std::span<const VertexArray> arrays, const ArrayKind& kind) {
    const auto found =
        std::find_if(arrays.begin(), arrays.end(), [&](const VertexArray& array) { return array.kind == &kind; });
    return found == arrays.end() ? nullptr : &*found;
}

std::vector<float> take_values(std::vector<VertexArray>& arrays, const ArrayKind& kind) {
    for (VertexArray& array : arrays)
        if (array.kind == &kind) return std::move(array.values);
    return {};
}

}  // namespace hairbake

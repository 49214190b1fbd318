// Fixed-point addition for the sweep's readers. Include it in a file that Highway compiles once for each SIMD target,
// after <hwy/highway.h>.
#include <cstddef>
#include <cstdint>

#if defined(HAIRBAKE_ADD_FIXED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HAIRBAKE_ADD_FIXED_INL_H
#undef HAIRBAKE_ADD_FIXED_INL_H
#else
#define HAIRBAKE_ADD_FIXED_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace hairbake::HWY_NAMESPACE {

using SlotFloats = hwy::HWY_NAMESPACE::CappedTag<float, 16>;
using SlotIntegers = hwy::HWY_NAMESPACE::RebindToSigned<SlotFloats>;

/// Adds value * scale, rounded to nearest, to the integers at `sum`.
template <class V>
HWY_INLINE void add_fixed(V value, V scale, std::int32_t* sum) {
    namespace hn = hwy::HWY_NAMESPACE;
    const SlotIntegers di;
    hn::StoreU(hn::Add(hn::LoadU(di, sum), hn::NearestInt(hn::Mul(value, scale))), di, sum);
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/floor.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
//
#include <hwy/contrib/math/math-inl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

#include "core/base/parallel.h"
#include "tests/bench/floor.h"

HWY_BEFORE_NAMESPACE();
namespace hairbake::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// `rounds` rounds over a table of `size` depths (a power of two); returns a number that depends on all of them.
float gather_and_exp(const float* table, std::int32_t size, std::size_t rounds) {
    const hn::CappedTag<float, 16> d;
    const hn::RebindToSigned<decltype(d)> di;
    auto at = hn::Mul(hn::Iota(di, 0), hn::Set(di, 37));
    auto a = hn::Zero(d), x = a, y = a, z = a;
    for (std::size_t i = 0; i < rounds; i += hn::Lanes(d)) {
        at = hn::And(hn::Add(at, hn::Set(di, 101)), hn::Set(di, size - 1));
        const auto t = hn::Exp(d, hn::Neg(hn::GatherIndex(d, table, at)));
        a = hn::Add(a, t);
        x = hn::MulAdd(t, hn::Set(d, 0.5f), x);
        y = hn::MulAdd(t, hn::Set(d, 0.6f), y);
        z = hn::MulAdd(t, hn::Set(d, 0.7f), z);
    }
    return hn::GetLane(hn::SumOfLanes(d, hn::Add(hn::Add(a, x), hn::Add(y, z))));
}

}  // namespace hairbake::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hairbake::bench {
namespace {

HWY_EXPORT(gather_and_exp);

template <class Work>
double seconds(const Work& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

double memory_bandwidth() {
    constexpr std::size_t count = 32 << 20;  // 128 MB an array
    std::vector<float> a(count, 1), b(count, 2);
    double best = 1e9;
    for (int run = 0; run < 5; ++run)
        best = std::min(best, seconds([&] {
                            parallel_for(count, 1 << 18, [&](std::size_t begin, std::size_t end) {
                                for (std::size_t i = begin; i < end; ++i) a[i] = 0.5f * a[i] + b[i];
                            });
                        }));
    return 3.0 * count * sizeof(float) / best;
}

double arithmetic_time(std::size_t count) {
    std::array<float, 4096> table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<float>(i) / 1024;
    const std::size_t sample = std::min<std::size_t>(count, 64 << 20), grain = 1 << 20;
    std::vector<float> sink((sample + grain - 1) / grain);
    double best = 1e9;
    for (int run = 0; run < 3; ++run)
        best = std::min(best, seconds([&] {
                            parallel_for(sample, grain, [&](std::size_t begin, std::size_t end) {
                                sink[begin / grain] =
                                    HWY_DYNAMIC_DISPATCH(gather_and_exp)(table.data(), 4096, end - begin);
                            });
                        }));
    return best * static_cast<double>(count) / static_cast<double>(sample);
}

}  // namespace hairbake::bench
#endif

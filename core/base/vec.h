// Three-component vectors. Vec3f holds positions and colours; sums and geometry use Vec3d.
#pragma once

#include <array>
#include <cmath>

#include "core/base/assert.h"

namespace hairbake {

template <class T>
struct Vec3 {
    T x{}, y{}, z{};

    constexpr Vec3() = default;
    constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    explicit constexpr Vec3(T s) : x(s), y(s), z(s) {}
    template <class U>
    explicit constexpr Vec3(const Vec3<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}

    constexpr T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }

    constexpr Vec3& operator+=(const Vec3& b) { return *this = Vec3(x + b.x, y + b.y, z + b.z); }
    constexpr Vec3& operator-=(const Vec3& b) { return *this = Vec3(x - b.x, y - b.y, z - b.z); }
    constexpr Vec3& operator*=(T s) { return *this = Vec3(x * s, y * s, z * s); }

    friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
    friend constexpr Vec3 operator*(const Vec3& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
    friend constexpr Vec3 operator*(T s, const Vec3& a) { return a * s; }
    friend constexpr Vec3 operator*(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
    friend constexpr Vec3 operator/(const Vec3& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
    friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length(const Vec3<T>& a) {
    return std::sqrt(dot(a, a));
}
/// Unit vector along `a`, which must not be zero.
template <class T>
Vec3<T> normalized(const Vec3<T>& a) {
    HAIRBAKE_ASSERT(!(a == Vec3<T>()));
    return a / length(a);
}
/// The components in order; converts to a JSON list.
template <class T>
constexpr std::array<T, 3> as_array(const Vec3<T>& a) {
    return {a.x, a.y, a.z};
}
template <class T>
bool is_finite(const Vec3<T>& a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace hairbake

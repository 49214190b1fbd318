#include "core/mesh/ply_reader.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/base/short_number.h"
#include "core/mesh/ply_header.h"

namespace hairbake {
namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The numbers behind a header, one after another.
class PlyNumbers {
public:
    PlyNumbers(std::string_view data, const PlyHeader& header, const std::string& name)
        : data_(data), at_(header.bytes), line_(header.lines + 1), format_(header.format), name_(name) {}

    double next(PlyType type) { return format_ == PlyFormat::ascii ? next_word() : next_binary(type); }

    /// Bytes that are left; a number takes at least one, and a list of them one for its count.
    std::uint64_t left() const { return data_.size() - at_; }
    /// The fewest bytes that a number of this type takes.
    std::uint64_t fewest(PlyType type) const { return format_ == PlyFormat::ascii ? 1 : size_of(type); }

    [[noreturn]] void refuse(const std::string& where, const std::string& what) const {
        const std::string line = format_ == PlyFormat::ascii ? ", line " + std::to_string(line_) : "";
        refuse_mesh(name_ + line, where + what);
    }

private:
    template <class T>
    static T swapped(T value) {
        auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
        std::reverse(bytes.begin(), bytes.end());
        return std::bit_cast<T>(bytes);
    }
    template <class T>
    double take() {
        if (left() < sizeof(T)) refuse("", "the file ends before the data that its header declares");
        T value;
        std::memcpy(&value, data_.data() + at_, sizeof value);
        at_ += sizeof value;
        static_assert(std::endian::native == std::endian::little);
        return static_cast<double>(format_ == PlyFormat::big_endian ? swapped(value) : value);
    }
    double next_binary(PlyType type) {
        switch (type) {
            case PlyType::int8:
                return take<std::int8_t>();
            case PlyType::uint8:
                return take<std::uint8_t>();
            case PlyType::int16:
                return take<std::int16_t>();
            case PlyType::uint16:
                return take<std::uint16_t>();
            case PlyType::int32:
                return take<std::int32_t>();
            case PlyType::uint32:
                return take<std::uint32_t>();
            case PlyType::float32:
                return take<float>();
            case PlyType::float64:
                break;
        }
        return take<double>();
    }
    static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
    double next_word() {
        for (; at_ < data_.size() && is_space(data_[at_]); ++at_) line_ += data_[at_] == '\n';
        const std::size_t begin = at_;
        while (at_ < data_.size() && !is_space(data_[at_])) ++at_;
        const std::string_view word = data_.substr(begin, at_ - begin);
        if (word.empty()) refuse("", "the file ends before the data that its header declares");
        const char* first = word.data() + (word.front() == '+' ? 1 : 0);
        double value = 0;
        const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size()) refuse("", quoted_word(word) + " is no number");
        return value;
    }

    std::string_view data_;
    std::size_t at_, line_;
    PlyFormat format_;
    const std::string& name_;
};

class PlyParser {
public:
    PlyParser(std::string_view data, const std::string& name)
        : name_(name), header_(read_ply_header(data, name)), numbers_(data, header_, name) {}

    PolygonFile parse() {
        check_elements();
        for (const PlyElement& element : header_.elements) read_element(element);
        check_corners();
        if (mesh_.face_end.empty()) refuse_mesh(name_, "there is no face; at least one is needed");
        constexpr const char* formats[] = {"PLY, ASCII", "PLY, binary little-endian", "PLY, binary big-endian"};
        return {std::move(mesh_), formats[static_cast<int>(header_.format)], {}};
    }

private:
    [[noreturn]] void refuse(const PlyElement& element, std::uint64_t i, const std::string& what) const {
        numbers_.refuse(element.name + " " + std::to_string(i) + ": ", what);
    }

    static bool has(const PlyElement& element, std::string_view property) {
        return std::any_of(element.properties.begin(), element.properties.end(),
                           [&](const PlyProperty& p) { return p.name == property && !p.count_type; });
    }
    static bool is_index_list(const PlyProperty& property) {
        return property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
    }

    /// Before any memory is taken for the elements.
    void check_elements() const {
        bool vertices = false, faces = false;
        for (const PlyElement& element : header_.elements) {
            std::uint64_t fewest = 0;
            for (const PlyProperty& p : element.properties) fewest += numbers_.fewest(p.count_type.value_or(p.type));
            if (fewest > 0 && element.count > numbers_.left() / fewest)
                refuse_mesh(name_, "truncated: the header declares " + std::to_string(element.count) + " of element " +
                                       quoted_word(element.name) + ", which take " + std::to_string(fewest) +
                                       " bytes each or more; the file has " + std::to_string(numbers_.left()) +
                                       " bytes behind its header");
            vertices =
                vertices || (element.name == "vertex" && has(element, "x") && has(element, "y") && has(element, "z"));
            faces = faces || ((element.name == "face" || element.name == "tristrips") &&
                              std::any_of(element.properties.begin(), element.properties.end(), is_index_list));
        }
        if (!vertices) refuse_mesh(name_, "the header has no element vertex with the properties x, y and z");
        if (!faces)
            refuse_mesh(name_,
                        "the header has no element face with a list vertex_indices: the file is a cloud of points, "
                        "no mesh");
    }

    void read_element(const PlyElement& element) {
        if (element.properties.empty()) return;
        if (element.name == "vertex") return read_vertices(element);
        const bool faces = element.name == "face", strips = element.name == "tristrips";
        std::vector<double> items;
        for (std::uint64_t i = 0; i < element.count; ++i)
            for (const PlyProperty& property : element.properties) {
                read_property(element, i, property, items);
                if (faces && is_index_list(property)) add_face(element, i, items);
                if (strips && is_index_list(property)) add_strips(element, i, items);
            }
    }

    void read_property(const PlyElement& element, std::uint64_t i, const PlyProperty& property,
                       std::vector<double>& items) {
        items.clear();
        double count = 1;
        if (property.count_type) count = numbers_.next(*property.count_type);
        const std::uint64_t most = numbers_.left() / numbers_.fewest(property.type);
        if (!(count >= 0) || count != std::floor(count) || count > static_cast<double>(most))
            refuse(element, i,
                   "the list " + property.name + " has " + short_number(count) +
                       " items; that is no number, or more than the file holds");
        for (auto k = static_cast<std::uint64_t>(count); k > 0; --k) items.push_back(numbers_.next(property.type));
    }

    void read_vertices(const PlyElement& element) {
        if (!mesh_.positions.empty()) refuse_mesh(name_, "the header has a second element vertex");
        const bool normals = has(element, "nx") && has(element, "ny") && has(element, "nz");
        constexpr std::string_view names[] = {"x", "y", "z", "nx", "ny", "nz"};
        std::vector<double> items;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            double found[6] = {};
            for (const PlyProperty& property : element.properties) {
                read_property(element, i, property, items);
                const auto* place = std::find(std::begin(names), std::end(names), property.name);
                if (place != std::end(names) && !property.count_type) found[place - names] = items[0];
            }
            for (int axis = 0; axis < 3; ++axis)
                if (!(std::abs(found[axis]) <= farthest_coordinate))
                    refuse(element, i,
                           std::string(names[axis]) + " is " + short_number(found[axis]) +
                               "; allowed are numbers from -1e18 to 1e18");
            mesh_.positions.emplace_back(Vec3d(found[0], found[1], found[2]));
            if (!normals) continue;
            const Vec3f normal(Vec3d(found[3], found[4], found[5]));
            mesh_.normals.push_back(is_finite(normal) ? normal : Vec3f());
        }
    }

    void add_corner(const PlyElement& element, std::uint64_t i, double index) {
        if (!(index >= 0 && index < static_cast<double>(std::numeric_limits<std::uint32_t>::max())) ||
            index != std::floor(index))
            refuse(element, i, short_number(index) + " is no index of a vertex; the first is 0");
        mesh_.corners.push_back(static_cast<std::uint32_t>(index));
    }
    void add_face(const PlyElement& element, std::uint64_t i, const std::vector<double>& indices) {
        if (indices.size() < 3)
            refuse(element, i, std::to_string(indices.size()) + " corners; allowed are three and more");
        for (const double index : indices) add_corner(element, i, index);
        mesh_.end_face();
    }
    /// Every second triangle of a strip runs the other way round.
    void add_strips(const PlyElement& element, std::uint64_t i, const std::vector<double>& indices) {
        std::size_t begin = 0;
        for (std::size_t k = 0; k < indices.size(); ++k) {
            if (indices[k] == -1) begin = k + 1;
            if (k < begin + 2) continue;
            const bool odd = (k - begin) % 2 == 1;
            for (const std::size_t corner : {k - 2, odd ? k : k - 1, odd ? k - 1 : k})
                add_corner(element, i, indices[corner]);
            mesh_.end_face();
        }
    }

    /// At the end, because faces may stand before the vertices.
    void check_corners() const {
        const auto beyond = std::find_if(mesh_.corners.begin(), mesh_.corners.end(),
                                         [&](std::uint32_t i) { return i >= mesh_.positions.size(); });
        if (beyond == mesh_.corners.end()) return;
        const auto corner = static_cast<std::size_t>(beyond - mesh_.corners.begin());
        const auto face = std::upper_bound(mesh_.face_end.begin(), mesh_.face_end.end(), corner);
        refuse_mesh(name_, "face " + std::to_string(face - mesh_.face_end.begin()) + " names vertex " +
                               std::to_string(*beyond) + "; the file has " + std::to_string(mesh_.positions.size()) +
                               " vertices, the first is 0");
    }

    const std::string& name_;
    PlyHeader header_;
    PlyNumbers numbers_;
    PolygonMesh mesh_;
};

bool begins_as_ply(std::span<const std::byte> first) {
    const std::string_view text = text_of(first);
    return text.starts_with("ply\n") || text.starts_with("ply\r");
}

void check_ply(std::span<const std::byte> first, std::uint64_t size, const std::string& name) {
    // A header that does not end within these bytes is left to the reading.
    if (size <= first.size() || text_of(first).find("end_header") != std::string_view::npos)
        read_ply_header(text_of(first), name);
}

PolygonFile read_ply(std::span<const std::byte> bytes, const std::string& name) {
    return PlyParser(text_of(bytes), name).parse();
}

}  // namespace

const MeshReader ply_reader{
    .name = "PLY",
    .beginning = "\"ply\"",
    .recognises = begins_as_ply,
    .check = check_ply,
    .read = read_ply,
};

}  // namespace hairbake

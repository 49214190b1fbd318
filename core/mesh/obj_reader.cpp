#include "core/mesh/obj_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace hairbake {
namespace {

/// The words of a text, line by line. A backslash at a line's end joins it with the next.
class Words {
public:
    Words(std::string_view text, const std::string& name) : text_(text), name_(name) {}

    bool next_line() {
        while (at_ < text_.size() && !is_end(text_[at_])) skip_one();
        if (at_ < text_.size()) {
            if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++at_;
            ++at_;
        }
        ++line_;
        return at_ < text_.size();
    }
    /// The next word of the line, empty at its end.
    std::string_view next() {
        while (at_ < text_.size() && (is_space(text_[at_]) || joins(at_))) skip_one();
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_space(text_[at_]) && !is_end(text_[at_]) && !joins(at_)) ++at_;
        return text_.substr(begin, at_ - begin);
    }
    [[noreturn]] void refuse(const std::string& what) const {
        throw Error(ErrorKind::bad_input, name_ + ", line " + std::to_string(line_) + ": " + what);
    }

private:
    static bool is_space(char c) { return c == ' ' || c == '\t'; }
    static bool is_end(char c) { return c == '\n' || c == '\r'; }
    bool joins(std::size_t at) const { return text_[at] == '\\' && at + 1 < text_.size() && is_end(text_[at + 1]); }
    void skip_one() {
        if (!joins(at_)) {
            ++at_;
            return;
        }
        const bool two = text_[at_ + 1] == '\r' && at_ + 2 < text_.size() && text_[at_ + 2] == '\n';
        at_ += two ? 3 : 2;
        ++line_;
    }

    std::string_view text_;
    const std::string& name_;
    std::size_t at_ = 0, line_ = 1;
};

float read_coordinate(Words& words, const char* of) {
    const std::string_view word = words.next();
    if (word.empty()) words.refuse(std::string("a ") + of + " of fewer than three numbers");
    const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
    double value = 0;
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= farthest_coordinate))
        words.refuse(quoted_word(word) + " is not a " + of + "; allowed are numbers from -1e18 to 1e18");
    return static_cast<float>(value);
}

Vec3f read_triple(Words& words, const char* of) {
    const float x = read_coordinate(words, of), y = read_coordinate(words, of);
    return {x, y, read_coordinate(words, of)};
}

/// Index `text` into `count` lines so far: 1 is the first, -1 the last.
std::uint32_t read_index(const Words& words, std::string_view text, std::size_t count, const char* of) {
    std::int64_t index = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    const auto most = static_cast<std::int64_t>(count);
    if (error != std::errc() || end != text.data() + text.size() || index == 0 || index > most || index < -most)
        words.refuse(quoted_word(text) + " names no " + of + "; allowed are 1 to " + std::to_string(count) +
                     " (the lines so far), or the same negative to count from the last");
    return static_cast<std::uint32_t>(index > 0 ? index - 1 : most + index);
}

struct Corner {
    std::uint32_t position;
    std::int64_t normal;        ///< -1 for none
    bool lacks_normal = false;  ///< it names one, and the file has none at all so far
};

/// i, i/j, i//k or i/j/k; the texture coordinate j is ignored.
Corner read_corner(const Words& words, std::string_view word, std::size_t positions, std::size_t normals) {
    const std::size_t first = word.find('/');
    Corner corner{read_index(words, word.substr(0, first), positions, "position"), -1};
    if (first == std::string_view::npos) return corner;
    const std::size_t second = word.find('/', first + 1);
    if (second == std::string_view::npos || second + 1 == word.size()) return corner;
    corner.lacks_normal = normals == 0;
    if (!corner.lacks_normal) corner.normal = read_index(words, word.substr(second + 1), normals, "normal");
    return corner;
}

class ObjParser {
public:
    ObjParser(std::string_view text, const std::string& name) : words_(text, name) {}

    PolygonFile parse() {
        do {
            const std::string_view key = words_.next();
            if (key == "v") {
                mesh_.positions.push_back(read_triple(words_, "coordinate"));
                normal_of_.push_back(kUnset);
            } else if (key == "vn") {
                normals_.push_back(read_triple(words_, "normal"));
            } else if (key == "f") {
                read_face();
            }
        } while (words_.next_line());
        if (mesh_.face_end.empty()) words_.refuse("the end, and no triangle (f) so far; at least one is needed");
        for (const std::int64_t normal : normal_of_)
            mesh_.normals.push_back(normal < 0 ? Vec3f() : normals_[static_cast<std::size_t>(normal)]);
        PolygonFile file{std::move(mesh_), "OBJ", {}};
        if (faces_without_normals_ > 0)
            file.warnings.push_back(
                std::to_string(faces_without_normals_) +
                " faces name normals (vn) of which the file has none before them; the mean normals of "
                "the triangles are used there");
        return file;
    }

private:
    static constexpr std::int64_t kUnset = -1, kNone = -2;

    /// Records the normal that one corner gives its position.
    void agree(const Corner& corner) {
        std::int64_t& normal = normal_of_[corner.position];
        const auto value = [&](std::int64_t n) { return normals_[static_cast<std::size_t>(n)]; };
        const auto differs = [&] { return normal != corner.normal && value(normal) != value(corner.normal); };
        if (corner.normal >= 0 && normal == kUnset)
            normal = corner.normal;
        else if (corner.normal < 0 || normal == kNone || differs())
            normal = kNone;
    }
    void read_face() {
        std::size_t corners = 0;
        bool lacks_normal = false;
        for (std::string_view word = words_.next(); !word.empty() && word.front() != '#'; word = words_.next()) {
            const Corner corner = read_corner(words_, word, mesh_.positions.size(), normals_.size());
            agree(corner);
            lacks_normal = lacks_normal || corner.lacks_normal;
            mesh_.corners.push_back(corner.position);
            ++corners;
        }
        if (corners < 3) words_.refuse("a face of " + std::to_string(corners) + " corners; allowed are three and more");
        faces_without_normals_ += lacks_normal;
        mesh_.end_face();
    }

    Words words_;
    PolygonMesh mesh_;
    std::vector<Vec3f> normals_;
    std::vector<std::int64_t> normal_of_;  ///< of each position: index of its corners' normal, or why there is none
    std::size_t faces_without_normals_ = 0;
};

bool may_be_obj(std::span<const std::byte> first) {
    return std::find(first.begin(), first.end(), std::byte{0}) == first.end();
}

void check_obj(std::span<const std::byte>, std::uint64_t, const std::string&) {}  // a text without a header

PolygonFile read_obj(std::span<const std::byte> bytes, const std::string& name) {
    return ObjParser({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name).parse();
}

}  // namespace

const MeshReader obj_reader{
    .name = "OBJ",
    .beginning = "a text with v and f lines",
    .recognises = may_be_obj,
    .check = check_obj,
    .read = read_obj,
};

}  // namespace hairbake

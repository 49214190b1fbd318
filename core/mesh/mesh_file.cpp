#include "core/mesh/mesh_file.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/mesh/mesh_normals.h"

namespace hairbake {
namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{256} << 20;
constexpr double kFarthest = 1e18;

[[noreturn]] void refuse_size(const std::string& name, std::uintmax_t bytes) {
    throw Error(ErrorKind::bad_input, name + " has " + std::to_string(bytes) + " bytes; allowed are at most " +
                                          std::to_string(kMostBytes) + " for a mesh");
}

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

/// A word for a message, shortened, with unprintable characters replaced.
std::string quoted(std::string_view word) {
    std::string shown = "\"";
    for (const char c : word.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown + (word.size() > 40 ? "...\"" : "\"");
}

float read_coordinate(Words& words, const char* of) {
    const std::string_view word = words.next();
    if (word.empty()) words.refuse(std::string("a ") + of + " of fewer than three numbers");
    const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
    double value = 0;
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= kFarthest))
        words.refuse(quoted(word) + " is not a " + of + "; allowed are numbers from -1e18 to 1e18");
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
        words.refuse(quoted(text) + " names no " + of + "; allowed are 1 to " + std::to_string(count) +
                     " (the lines so far), or the same negative to count from the last");
    return static_cast<std::uint32_t>(index > 0 ? index - 1 : most + index);
}

struct Corner {
    std::uint32_t position;
    std::int64_t normal;  ///< -1 for none
};

/// i, i/j, i//k or i/j/k; the texture coordinate j is ignored.
Corner read_corner(const Words& words, std::string_view word, std::size_t positions, std::size_t normals) {
    const std::size_t first = word.find('/');
    Corner corner{read_index(words, word.substr(0, first), positions, "position"), -1};
    if (first == std::string_view::npos) return corner;
    const std::size_t second = word.find('/', first + 1);
    if (second == std::string_view::npos || second + 1 == word.size()) return corner;
    corner.normal = read_index(words, word.substr(second + 1), normals, "normal");
    return corner;
}

class MeshParser {
public:
    MeshParser(std::string_view text, const std::string& name) : words_(text, name) {}

    TriangleMesh parse() {
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
        if (mesh_.triangles.empty()) words_.refuse("the end, and no triangle (f) so far; at least one is needed");
        mesh_.normals = normals_of_faces(mesh_);
        for (std::size_t i = 0; i < normal_of_.size(); ++i) take_normal(i);
        return std::move(mesh_);
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
        std::uint32_t first = 0, last = 0;
        for (std::string_view word = words_.next(); !word.empty() && word.front() != '#'; word = words_.next()) {
            const Corner corner = read_corner(words_, word, mesh_.positions.size(), normals_.size());
            agree(corner);
            const std::uint32_t p = corner.position;
            if (corners == 0) first = p;
            if (corners >= 2 && first != last && last != p && p != first) mesh_.triangles.push_back({first, last, p});
            last = p;
            ++corners;
        }
        if (corners < 3) words_.refuse("a face of " + std::to_string(corners) + " corners; allowed are three and more");
    }
    void take_normal(std::size_t position) {
        if (normal_of_[position] < 0) return;
        const Vec3d normal(normals_[static_cast<std::size_t>(normal_of_[position])]);
        const double size = length(normal);
        if (size > 1e-30) mesh_.normals[position] = Vec3f(normal / size);
    }

    Words words_;
    TriangleMesh mesh_;
    std::vector<Vec3f> normals_;
    std::vector<std::int64_t> normal_of_;  ///< of each position: index of its corners' normal, or why there is none
};

[[noreturn]] void refuse_unreadable(const std::filesystem::path& file, int error) {
    const int known = error != 0 ? error : EIO;
    throw Error(ErrorKind::bad_input, file.string() + ": " + std::generic_category().message(known), {}, known);
}

struct OpenMesh {
    std::ifstream stream;
    std::uintmax_t size;  ///< bytes
};

/// Opening comes after the look at the file: a named pipe without a writer would never be open.
OpenMesh open_mesh(const std::filesystem::path& file) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) refuse_unreadable(file, error.value());
    if (size > kMostBytes) refuse_size(file.string(), size);
    std::ifstream stream(file, std::ios::binary);
    if (!stream) refuse_unreadable(file, errno);
    return {std::move(stream), size};
}

}  // namespace

void check_mesh(const std::filesystem::path& file) { open_mesh(file); }

TriangleMesh read_mesh(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.size() > kMostBytes) refuse_size(name, bytes.size());
    return MeshParser({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name).parse();
}

TriangleMesh read_mesh(const std::filesystem::path& file) {
    auto [stream, size] = open_mesh(file);
    std::string text(size, '\0');
    errno = 0;
    stream.read(text.data(), static_cast<std::streamsize>(size));
    if (stream.bad()) refuse_unreadable(file, errno);
    if (static_cast<std::uintmax_t>(stream.gcount()) != size)
        throw Error(ErrorKind::bad_input, file.string() + " ended after " + std::to_string(stream.gcount()) + " of " +
                                              std::to_string(size) + " bytes");
    return read_mesh(std::as_bytes(std::span(text)), file.string());
}

}  // namespace hairbake

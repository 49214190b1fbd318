#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "core/base/error.h"
#include "core/mesh/gltf_reader.h"
#include "core/mesh/mesh_reader.h"
#include "core/mesh/obj_reader.h"
#include "core/mesh/ply_reader.h"

namespace hairbake {
namespace {

/// OBJ comes last: its files begin with any text.
constexpr std::array<const MeshReader*, 4> readers{
    &ply_reader,
    &glb_reader,
    &gltf_reader,
    &obj_reader,
};

/// Formats that are not read, by what their files begin with.
struct OtherFormat {
    std::string_view beginning, name;
};
using namespace std::string_view_literals;
constexpr std::array others{
    OtherFormat{"Kaydara FBX Binary"sv, "FBX"},
    OtherFormat{"; FBX"sv, "FBX"},
    OtherFormat{"PXR-USDC"sv, "USD"},
    OtherFormat{"#usda"sv, "USD"},
    OtherFormat{"Ogawa"sv, "Alembic"},
    OtherFormat{"\x89HDF"sv, "Alembic or HDF5"},
    OtherFormat{"BLENDER"sv, "Blender"},
    OtherFormat{"solid "sv, "STL"},
    OtherFormat{"OFF"sv, "OFF"},
    OtherFormat{"<?xml"sv, "XML (Collada or X3D)"},
    OtherFormat{"PK\x03\x04"sv, "ZIP (3MF or USDZ)"},
    OtherFormat{"HAIR"sv, "HAIR: a groom, no mesh"},
    OtherFormat{"\xff\xfe"sv, "UTF-16 text: save it as UTF-8"},
    OtherFormat{"\xfe\xff"sv, "UTF-16 text: save it as UTF-8"},
};

std::string hexadecimal(std::span<const std::byte> bytes) {
    std::string text = bytes.empty() ? "nothing" : "";
    for (const std::byte byte : bytes) {
        char digits[4];
        std::snprintf(digits, sizeof digits, "%s%02x", text.empty() ? "" : " ", std::to_integer<unsigned>(byte));
        text += digits;
    }
    return text;
}

std::string allowed_beginnings() {
    std::string list;
    for (const MeshReader* reader : readers)
        list += (list.empty() ? "" : ", ") + std::string(reader->name) + " (" + std::string(reader->beginning) + ")";
    return list;
}

}  // namespace

const MeshReader& reader_of_mesh(std::span<const std::byte> first, const std::string& name) {
    for (const MeshReader* reader : readers)
        if (reader != &obj_reader && reader->recognises(first)) return *reader;
    const std::string_view text(reinterpret_cast<const char*>(first.data()), first.size());
    for (const OtherFormat& other : others)
        if (text.starts_with(other.beginning))
            refuse_mesh(name,
                        "the file is " + std::string(other.name) + "; meshes are read from " + allowed_beginnings());
    if (!obj_reader.recognises(first))
        refuse_mesh(name, "this is no mesh: the first bytes are " +
                              hexadecimal(first.first(std::min<std::size_t>(first.size(), 4))) +
                              "; meshes are read from " + allowed_beginnings());
    return obj_reader;
}

void refuse_mesh(const std::string& name, const std::string& what) {
    throw Error(ErrorKind::bad_input, name + ": " + what);
}

std::string quoted_word(std::string_view word) {
    std::string shown = "\"";
    for (const char c : word.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown + (word.size() > 40 ? "...\"" : "\"");
}

}  // namespace hairbake

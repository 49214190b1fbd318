#include "core/mesh/gltf_reader.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/json_nesting.h"
#include "core/base/short_text.h"
#include "core/mesh/gltf_scene.h"

namespace hairbake {
namespace {

constexpr std::size_t glb_header_bytes = 20;  ///< with the header of the first chunk

// ---- parsing -------------------------------------------------------------------------------------------------------

/// tinygltf opens no file: it asks this for each, which remembers the first name.
std::optional<std::string>& wanted(void* data) { return *static_cast<std::optional<std::string>*>(data); }

tinygltf::FsCallbacks no_files(std::optional<std::string>& first) {
    tinygltf::FsCallbacks callbacks{};
    callbacks.FileExists = [](const std::string& file, void* data) {
        if (!wanted(data)) wanted(data) = file;
        return false;
    };
    callbacks.ExpandFilePath = [](const std::string& file, void*) { return file; };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>*, std::string*, const std::string&, void*) {
        return false;
    };
    callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
        return false;
    };
    callbacks.user_data = &first;
    return callbacks;
}

bool leave_picture(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
    return true;
}

using Load = bool (*)(tinygltf::TinyGLTF&, tinygltf::Model&, std::string& error, std::span<const std::byte> bytes);

bool load_glb(tinygltf::TinyGLTF& loader, tinygltf::Model& model, std::string& error,
              std::span<const std::byte> bytes) {
    std::string warning;
    return loader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes.data()),
                                       static_cast<unsigned>(bytes.size()));
}
bool load_json(tinygltf::TinyGLTF& loader, tinygltf::Model& model, std::string& error,
               std::span<const std::byte> bytes) {
    std::string warning;
    return loader.LoadASCIIFromString(&model, &error, &warning, reinterpret_cast<const char*>(bytes.data()),
                                      static_cast<unsigned>(bytes.size()), "");
}

std::string first_line(const std::string& text) { return shortened(text.substr(0, text.find('\n')), 200); }

tinygltf::Model parse(Load load, std::span<const std::byte> bytes, const std::string& name) {
    tinygltf::TinyGLTF loader;
    std::optional<std::string> outside;
    loader.SetFsCallbacks(no_files(outside));
    loader.SetImageLoader(leave_picture, nullptr);
    tinygltf::Model model;
    std::string error;
    bool loaded = false;
    try {
        loaded = load(loader, model, error, bytes);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& exception) {  // of the parser's containers
        error = exception.what();
    }
    if (loaded) return model;
    if (outside && error.find("File not found") != std::string::npos)
        refuse_mesh(name, "its geometry is in another file, " + quoted_word(*outside) +
                              "; read are .glb files, and .gltf files with embedded buffers");
    refuse_mesh(name, "this glTF file cannot be parsed: " + (error.empty() ? "no reason given" : first_line(error)));
}

/// KHR_mesh_quantization is read. The others change nothing of the geometry.
constexpr std::array<std::string_view, 6> read_extensions{
    "KHR_mesh_quantization", "KHR_lights_punctual", "KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_"};

bool is_read(std::string_view extension) {
    return std::any_of(read_extensions.begin(), read_extensions.end(),
                       [&](std::string_view beginning) { return extension.starts_with(beginning); });
}

void check_extensions(const tinygltf::Model& model, const std::string& name) {
    if (!model.asset.version.starts_with("2."))
        refuse_mesh(name, "the glTF version is " + quoted_word(model.asset.version) + "; allowed is 2.x");
    for (const std::string& extension : model.extensionsRequired)
        if (!is_read(extension))
            refuse_mesh(name, "the file needs the extension " + quoted_word(extension) +
                                  ", which is not read; export it without compression and instancing");
}

PolygonFile read_scene(Load load, std::span<const std::byte> bytes, const std::string& name, const char* format) {
    const tinygltf::Model model = parse(load, bytes, name);
    check_extensions(model, name);
    return read_gltf_scene(model, name, format);
}

// ---- the two readers -----------------------------------------------------------------------------------------------

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t at) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes.data() + at, sizeof word);
    return word;
}

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void check_glb(std::span<const std::byte> first, std::uint64_t size, const std::string& name) {
    if (size < glb_header_bytes)
        refuse_mesh(name, "the file has " + std::to_string(size) + " bytes; a GLB file has 20 or more");
    if (const std::uint32_t version = word_at(first, 4); version != 2)
        refuse_mesh(name, "the GLB version is " + std::to_string(version) + "; allowed is 2");
    const std::uint64_t declared = word_at(first, 8), json = word_at(first, 12);
    if (declared > size || glb_header_bytes + json > declared)
        refuse_mesh(name, "truncated: the header declares " + std::to_string(declared) + " bytes, its JSON " +
                              std::to_string(json) + "; the file has " + std::to_string(size));
}

PolygonFile read_glb(std::span<const std::byte> bytes, const std::string& name) {
    check_glb(bytes, bytes.size(), name);
    // tinygltf reads values of `extras` by recursion.
    check_nesting(text_of(bytes).substr(glb_header_bytes, word_at(bytes, 12)), name, ErrorKind::bad_input);
    return read_scene(load_glb, bytes, name, "glTF, binary");
}

bool begins_as_glb(std::span<const std::byte> first) { return text_of(first).starts_with("glTF"); }

bool begins_as_json(std::span<const std::byte> first) {
    const std::string_view text = text_of(first);
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    return begin != std::string_view::npos && text[begin] == '{';
}

void check_gltf(std::span<const std::byte>, std::uint64_t, const std::string&) {}  // JSON has no header

PolygonFile read_gltf(std::span<const std::byte> bytes, const std::string& name) {
    check_nesting(text_of(bytes), name, ErrorKind::bad_input);
    return read_scene(load_json, bytes, name, "glTF, JSON");
}

}  // namespace

const MeshReader glb_reader{
    .name = "GLB",
    .beginning = "\"glTF\"",
    .recognises = begins_as_glb,
    .check = check_glb,
    .read = read_glb,
};

const MeshReader gltf_reader{
    .name = "glTF",
    .beginning = "JSON",
    .recognises = begins_as_json,
    .check = check_gltf,
    .read = read_gltf,
};

}  // namespace hairbake

#include "core/environment/image_layers.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string_view>

namespace hairbake {
namespace {

using Channels = std::array<int, 3>;

struct Layer {
    int part = 0;
    std::string name;                       // "ViewLayer.Combined"; empty for channels without a prefix
    std::vector<int> members;               // channels
    Channels colors{-1, -1, -1};            // red, green, blue
    int luminance = -1;                     // Y
    int red_chroma = -1, blue_chroma = -1;  // RY, BY
    bool has_chroma() const { return red_chroma >= 0 || blue_chroma >= 0; }
    bool is_luminance_chroma() const { return luminance >= 0 && red_chroma >= 0 && blue_chroma >= 0; }
    bool is_color() const {
        return std::all_of(colors.begin(), colors.end(), [](int c) { return c >= 0; });
    }
};

constexpr std::array<std::string_view, 4> preferred{"combined", "beauty", "rgba", ""};
constexpr std::array<std::string_view, 32> data_words{
    "ao",      "occlusion", "depth",  "z",        "zdepth", "mist",   "normal", "normals",  "n",  "nn",      "p",
    "pos",     "position",  "points", "uv",       "st",     "vector", "motion", "velocity", "mv", "speed",   "id",
    "indexob", "indexma",   "object", "material", "mask",   "matte",  "shadow", "alpha",    "a",  "coverage"};

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

std::string last_word(std::string_view name) {
    const std::size_t dot = name.rfind('.');
    return lower(dot == std::string_view::npos ? name : name.substr(dot + 1));
}

std::string prefix_of(const std::string& channel) {
    const std::size_t dot = channel.rfind('.');
    return dot == std::string::npos ? std::string() : channel.substr(0, dot);
}

/// Whether one of the words of the last part of the name tells of data instead of colours.
bool names_data(std::string_view name) {
    const std::string text = last_word(name);
    if (text.starts_with("crypto")) return true;
    std::string word;
    for (std::size_t i = 0; i <= text.size(); ++i) {
        if (i < text.size() && std::isalpha(static_cast<unsigned char>(text[i]))) {
            word += text[i];
            continue;
        }
        if (std::find(data_words.begin(), data_words.end(), word) != data_words.end()) return true;
        word.clear();
    }
    return false;
}

void add_channel(Layer& layer, int index, const std::string& channel) {
    const std::string letter = last_word(channel);
    constexpr std::array<std::array<std::string_view, 2>, 3> names{{{"r", "red"}, {"g", "green"}, {"b", "blue"}}};
    layer.members.push_back(index);
    for (std::size_t k = 0; k < names.size(); ++k)
        if ((letter == names[k][0] || letter == names[k][1]) && layer.colors[k] < 0) layer.colors[k] = index;
    if (letter == "y" && layer.luminance < 0) layer.luminance = index;
    if (letter == "ry" && layer.red_chroma < 0) layer.red_chroma = index;
    if (letter == "by" && layer.blue_chroma < 0) layer.blue_chroma = index;
}

/// A part that is named like its channels' prefix says nothing more; one with a name of its own names the layer.
std::string full_name(const ImagePart& part, const std::string& prefix, bool several_parts) {
    if (!several_parts || part.name.empty() || prefix.starts_with(part.name)) return prefix;
    return prefix.empty() ? part.name : part.name + "." + prefix;
}

Layer new_layer(int part, const std::string& name) {
    Layer layer;
    layer.part = part;
    layer.name = name;
    return layer;
}

std::vector<Layer> layers_of(std::span<const ImagePart> parts) {
    std::vector<Layer> layers;
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (std::size_t c = 0; c < parts[p].channels.size(); ++c) {
            const std::string name = full_name(parts[p], prefix_of(parts[p].channels[c]), parts.size() > 1);
            const auto found = std::find_if(layers.begin(), layers.end(), [&](const Layer& layer) {
                return layer.part == static_cast<int>(p) && layer.name == name;
            });
            Layer& layer = found == layers.end() ? layers.emplace_back(new_layer(static_cast<int>(p), name)) : *found;
            add_channel(layer, static_cast<int>(c), parts[p].channels[c]);
        }
    return layers;
}

std::string shown(const std::string& name) { return name.empty() ? "the layer without a name" : "\"" + name + "\""; }

/// At most twelve names.
std::string list_of(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 12); ++i) text += (i > 0 ? ", " : "") + names[i];
    if (names.size() > 12) text += " and " + std::to_string(names.size() - 12) + " more";
    return text;
}

std::string channel_list(std::span<const ImagePart> parts) {
    std::vector<std::string> names;
    for (const ImagePart& part : parts) names.insert(names.end(), part.channels.begin(), part.channels.end());
    return list_of(names);
}

const Layer& prefer(const std::vector<const Layer*>& layers, std::vector<std::string>& warnings) {
    for (const std::string_view wanted : preferred)
        for (const Layer* layer : layers)
            if (last_word(layer->name) == wanted) return *layer;
    if (layers.size() > 1) {
        std::vector<std::string> others;
        for (std::size_t i = 1; i < layers.size(); ++i) others.push_back(shown(layers[i]->name));
        warnings.push_back("no layer is named Combined, beauty or rgba: the first one was taken, and not " +
                           list_of(others));
    }
    return *layers.front();
}

/// Names the layer and the channels, and those that were left.
void describe(const Layer& layer, std::size_t layer_count, const ImagePart& part, ChosenLayer& chosen) {
    const auto used = [&](int c) { return std::count(chosen.channels.begin(), chosen.channels.end(), c) > 0; };
    std::vector<std::string> taken, left;
    for (const int c : layer.members) {
        if (used(c))
            taken.push_back(part.channels[c]);
        else
            left.push_back(part.channels[c]);
    }
    if (layer_count > 1)
        chosen.warnings.push_back("the file has " + std::to_string(layer_count) + " layers: taken is " +
                                  shown(layer.name) + " (" + list_of(taken) + ")");
    if (!left.empty())
        chosen.warnings.push_back("not used: " + std::string(left.size() == 1 ? "channel " : "channels ") +
                                  list_of(left) + (lower(last_word(left[0])) == "a" ? " (transparency)" : ""));
}

[[noreturn]] void refuse(std::span<const ImagePart> parts, const std::string& reason) {
    throw std::invalid_argument("the file holds no colours of light: its channels are " + channel_list(parts) + reason +
                                "; allowed is a layer with channels R, G and B, or one channel of luminance");
}

/// Grey, or three channels of unknown names.
Channels without_names(std::span<const ImagePart> parts, bool names_are_known, const Layer& layer,
                       std::vector<std::string>& warnings) {
    const std::vector<std::string>& channels = parts[layer.part].channels;
    if (layer.has_chroma())
        refuse(parts, " (luminance and chroma need all of Y, RY and BY: write the file again as RGB)");
    if (layer.luminance >= 0 && layer.members.size() <= 2) {
        warnings.push_back("the image has no colour: it was taken as grey");
        return {layer.luminance, layer.luminance, layer.luminance};
    }
    if (layer.members.size() < 3 && (!names_are_known || !names_data(channels[layer.members[0]]))) {
        warnings.push_back("the image has no colour: it was taken as grey");
        return {layer.members[0], layer.members[0], layer.members[0]};
    }
    if (layer.members.size() < 3 || names_are_known) refuse(parts, "");
    warnings.push_back("no channels are named R, G and B: the first three were taken");
    return {layer.members[0], layer.members[1], layer.members[2]};
}

}  // namespace

ChosenLayer choose_layer(std::span<const ImagePart> parts, bool names_are_known) {
    const std::vector<Layer> layers = layers_of(parts);
    std::vector<const Layer*> colors, others;
    for (const Layer& layer : layers)
        if (!names_are_known || !names_data(layer.name)) (layer.is_color() ? colors : others).push_back(&layer);
    ChosenLayer chosen;
    if (colors.empty() && others.empty()) refuse(parts, " (data, not light)");
    const Layer& layer = prefer(colors.empty() ? others : colors, chosen.warnings);
    chosen.part = layer.part;
    chosen.luminance_chroma = names_are_known && !layer.is_color() && layer.is_luminance_chroma();
    if (chosen.luminance_chroma)
        chosen.channels = {layer.luminance, layer.red_chroma, layer.blue_chroma};
    else
        chosen.channels =
            layer.is_color() ? layer.colors : without_names(parts, names_are_known, layer, chosen.warnings);
    describe(layer, layers.size(), parts[layer.part], chosen);
    return chosen;
}

}  // namespace hairbake

#include "core/environment/image_layers.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace hairbake {
namespace {

using Channels = std::array<int, 3>;

ChosenLayer chosen(const std::vector<ImagePart>& parts) { return choose_layer(parts, true); }

std::string layer_refusal(const std::vector<ImagePart>& parts) {
    try {
        chosen(parts);
    } catch (const std::invalid_argument& e) {
        return e.what();
    }
    return "";
}

std::string joined(const std::vector<std::string>& texts) {
    std::string all;
    for (const std::string& text : texts) all += text + "\n";
    return all;
}

TEST(ImageLayers, CombinedComesBeforeBeautyRgbaAndNoName) {
    const std::vector<std::string> names{"x.Combined.", "beauty.", "rgba.", ""};
    for (std::size_t first = 0; first < names.size(); ++first) {
        ImagePart part;
        for (std::size_t layer = names.size(); layer-- > first;)  // the preferred one comes last
            for (const char* channel : {"R", "G", "B"}) part.channels.push_back(names[layer] + channel);
        const int begin = 3 * int(names.size() - 1 - first);
        EXPECT_EQ(chosen({part}).channels, (Channels{begin, begin + 1, begin + 2})) << names[first];
    }
}

TEST(ImageLayers, OcclusionBeforeTheBeautyIsNotTakenAndTheLayerIsNamed) {
    const ChosenLayer layer =
        chosen({{"", {"V.AO.R", "V.AO.G", "V.AO.B", "V.Combined.R", "V.Combined.G", "V.Combined.B", "V.Combined.A"}}});
    EXPECT_EQ(layer.channels, (Channels{3, 4, 5}));
    const std::string warnings = joined(layer.warnings);
    EXPECT_NE(warnings.find("taken is \"V.Combined\" (V.Combined.R, V.Combined.G, V.Combined.B)"), std::string::npos)
        << warnings;
    EXPECT_NE(warnings.find("not used: channel V.Combined.A (transparency)"), std::string::npos) << warnings;
}

TEST(ImageLayers, OneColourLayerAmongDataIsTakenWhateverItsName) {
    const ChosenLayer layer = chosen({{"", {"normals.R", "normals.G", "normals.B", "sky.G", "sky.R", "sky.B", "Z"}}});
    EXPECT_EQ(layer.channels, (Channels{4, 3, 5}));
    EXPECT_EQ(joined(layer.warnings).find("first one"), std::string::npos);
}

TEST(ImageLayers, SeveralUnknownColourLayersGiveTheFirstAndAWarningThatNamesTheOthers) {
    const ChosenLayer layer = chosen({{"left", {"R", "G", "B"}}, {"right", {"R", "G", "B"}}});
    EXPECT_EQ(layer.part, 0);
    EXPECT_NE(joined(layer.warnings).find("not \"right\""), std::string::npos) << joined(layer.warnings);
    // Blender's files with several parts: part and channels have the same prefix.
    const ChosenLayer blender =
        chosen({{"V.Depth", {"V.Depth.Z"}}, {"V.Combined", {"V.Combined.R", "V.Combined.G", "V.Combined.B"}}});
    EXPECT_EQ(blender.part, 1);
    EXPECT_NE(joined(blender.warnings).find("taken is \"V.Combined\""), std::string::npos);
}

TEST(ImageLayers, FilesWithoutColoursAreRefusedByTheirChannels) {
    EXPECT_NE(layer_refusal({{"", {"Depth.Z"}}}).find("Depth.Z"), std::string::npos);
    EXPECT_NE(layer_refusal({{"", {"Z"}}}), "");
    EXPECT_NE(layer_refusal({{"", {"N.X", "N.Y", "N.Z"}}}), "");
    EXPECT_NE(layer_refusal({{"", {"normal.R", "normal.G", "normal.B"}}}), "");
    EXPECT_NE(layer_refusal({{"", {"CryptoObject00.R", "CryptoObject00.G", "CryptoObject00.B", "CryptoObject00.A"}}}),
              "");
    EXPECT_NE(layer_refusal({{"", {"X", "Y", "Z"}}}), "") << "CIE XYZ, or vectors";
    EXPECT_NE(layer_refusal({{"", {"A"}}}), "");
    EXPECT_NE(layer_refusal({{"", {"BY", "Y"}}}).find("chroma"), std::string::npos);
    EXPECT_NE(layer_refusal({{"depth", {"Z"}}, {"motion", {"u", "v"}}}), "");
}

TEST(ImageLayers, LuminanceAndSingleChannelsAreGrey) {
    EXPECT_EQ(chosen({{"", {"Y"}}}).channels, (Channels{0, 0, 0}));
    EXPECT_EQ(chosen({{"", {"A", "Y"}}}).channels, (Channels{1, 1, 1}));
    EXPECT_EQ(chosen({{"", {"R"}}}).channels, (Channels{0, 0, 0}));
    EXPECT_NE(joined(chosen({{"", {"Y"}}}).warnings).find("grey"), std::string::npos);
}

// Relatives: only one of the two chroma channels, chroma in a layer with a name, chroma beside colours.
TEST(ImageLayers, LuminanceAndChromaAreReadTogether) {
    const ChosenLayer plain = chosen({{"", {"BY", "RY", "Y"}}});
    EXPECT_TRUE(plain.luminance_chroma);
    EXPECT_EQ(plain.channels, (Channels{2, 1, 0}));
    EXPECT_EQ(chosen({{"", {"beauty.BY", "beauty.RY", "beauty.Y", "depth.Z"}}}).channels, (Channels{2, 1, 0}));
    EXPECT_NE(layer_refusal({{"", {"RY", "Y"}}}).find("Y, RY and BY"), std::string::npos);
    EXPECT_FALSE(chosen({{"", {"B", "BY", "G", "R", "RY", "Y"}}}).luminance_chroma);
}

TEST(ImageLayers, WithoutNamesTheFirstThreeChannelsAreColours) {
    const ImagePart part{"", {"channel0", "channel1", "channel2", "channel3"}};
    EXPECT_EQ(choose_layer({&part, 1}, false).channels, (Channels{0, 1, 2}));
    EXPECT_NE(layer_refusal({part}), "") << "OpenEXR names its channels";
}

}  // namespace
}  // namespace hairbake

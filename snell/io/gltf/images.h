// The pictures that a glTF file's textures are made of.
#pragma once

#include "snell/io/gltf/buffers.h"

#include <functional>
#include <map>
#include <optional>
#include <tuple>

namespace snell::gltf {

// What a texture holds: decides how it is decoded and what stands in for one that is missing.
enum class Content
{
    color,     // sRGB; a magenta checkerboard
    alpha,     // of a picture whose colour is or may be looked up as well: decoded as color; white
    data,      // linear; white, so that the factor counts alone
    normal,    // linear; straight up
    anisotropy // linear; along the tangent, full strength
};

// Collects which pictures are wanted, then decodes all of them in parallel.
class Images
{
  public:
    Images(const Document& document, const Buffers& buffers, References& references, Budget& budget);

    // The place in Scene::images that the picture of a texture will have. Throws Error if there is no such texture;
    // one whose picture is missing gets a stand-in.
    Index<Image> of_texture(int texture, Content content, const std::string& who);

    // The roughness that the picture's alpha, as glossiness times a factor, amounts to: 1 - factor * alpha, in green.
    Index<Image> roughness_of_texture(int texture, float factor, const std::string& who);

    // Decodes everything; progress gets the part that is done. Called once, at the end.
    void decode(Scene& scene, Remarks& remarks, const std::function<void(double)>& progress);

    // After decode(): whether every texel's alpha is 1.
    bool is_opaque(Index<Image> image) const { return wanted_[image.value].is_opaque; }

  private:
    struct Wanted
    {
        int source; // index of the document's images, or -1
        Content content;
        std::optional<float> glossiness;
        std::string name;
        std::filesystem::path file; // of an external one
        std::string missing;        // why it cannot be had; empty: it can be tried
        bool is_opaque = false;
    };

    Index<Image> want(int texture, Content content, std::optional<float> glossiness, const std::string& who);
    void locate(Wanted& wanted, int texture);
    Image load(const Wanted& wanted);
    Image decode_bytes(const Wanted& wanted, std::string_view bytes, const std::filesystem::path& name) const;

    const Document& document_;
    const Buffers& buffers_;
    References& references_;
    Budget& budget_;
    std::vector<Wanted> wanted_;
    std::map<std::tuple<int, bool, float>, Index<Image>> known_; // image or -2 - texture, is_color, glossiness
    std::map<int, std::filesystem::path> files_;
};

} // namespace snell::gltf

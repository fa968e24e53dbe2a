// How glTF's materials refer to textures.
#pragma once

#include "snell/io/gltf/images.h"

namespace snell::gltf {

// One textureInfo object of a material, wherever it stands.
struct TextureUse
{
    int texture = -1;
    int set = 0;        // of texture coordinates
    float scale = 1.0f; // of a normal map
    Fields transform{nullptr};

    TextureUse(const tinygltf::TextureInfo& info);
    TextureUse(const tinygltf::NormalTextureInfo& info);
    TextureUse(const Fields& parent, const char* key);

    bool exists() const { return texture >= 0; }
};

// Makes the references of one material.
class TextureRefs
{
  public:
    TextureRefs(const Document& document, Images& images, Remarks& remarks, std::string who)
        : document_(document), images_(images), remarks_(remarks), who_(std::move(who))
    {
    }

    // Not valid if the material has no such texture.
    TextureRef make(const TextureUse& use, Content content, uint channel = 0);
    // The roughness that a glossiness in the alpha channel amounts to.
    TextureRef make_roughness(const TextureUse& use, float glossiness);

  private:
    void set_lookup(TextureRef& ref, const TextureUse& use);

    const Document& document_;
    Images& images_;
    Remarks& remarks_;
    std::string who_;
};

} // namespace snell::gltf

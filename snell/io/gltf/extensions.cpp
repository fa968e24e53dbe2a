// What a document says in extensions: which there are, and how their members are read.
#include "snell/io/gltf/document.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace snell::gltf {

void check_extensions(const Document& document, Remarks& remarks)
{
    static constexpr std::array known = {"KHR_lights_punctual",
                                         "KHR_materials_emissive_strength",
                                         "KHR_texture_transform",
                                         "KHR_materials_transmission",
                                         "KHR_materials_volume",
                                         "KHR_materials_ior",
                                         "KHR_materials_specular",
                                         "KHR_materials_clearcoat",
                                         "KHR_materials_sheen",
                                         "KHR_materials_unlit",
                                         "KHR_materials_variants",
                                         "KHR_mesh_quantization",
                                         "EXT_meshopt_compression",
                                         "KHR_draco_mesh_compression",
                                         "EXT_mesh_gpu_instancing",
                                         "EXT_texture_webp",
                                         "KHR_texture_basisu",
                                         "KHR_materials_anisotropy",
                                         "KHR_materials_iridescence",
                                         "KHR_materials_dispersion",
                                         "KHR_materials_diffuse_transmission",
                                         "KHR_materials_pbrSpecularGlossiness"};
    // About the file, not about the picture.
    static constexpr std::array silent = {"KHR_xmp", "KHR_xmp_json_ld"};
    const auto is_in = [](const auto& names, const std::string& name) {
        return std::any_of(names.begin(), names.end(), [&](const char* other) { return name == other; });
    };
    for (const std::string& name : document.model.extensionsRequired)
        if (!is_in(known, name) && !is_in(silent, name))
            throw Error({document.file.string()}, fmt::format("needs the extension '{}', which is not known", name),
                        "export the scene without it");
    std::string unknown;
    std::vector<std::string> names = document.model.extensionsUsed;
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    for (const std::string& name : names)
        if (!is_in(known, name) && !is_in(silent, name)) unknown += (unknown.empty() ? "" : ", ") + name;
    if (!unknown.empty())
        remarks.warn("extensions", fmt::format("uses extensions that are not known and ignored: {}", unknown));
}

Fields::Fields(const tinygltf::ExtensionMap& extensions, const char* name) : value_(nullptr)
{
    const auto it = extensions.find(name);
    if (it != extensions.end() && it->second.IsObject()) value_ = &it->second;
}

const tinygltf::Value* Fields::find(const char* key) const
{
    return value_ && value_->Has(key) ? &value_->Get(key) : nullptr;
}

double Fields::number(const char* key, double otherwise) const
{
    const tinygltf::Value* const value = find(key);
    return value && value->IsNumber() ? value->GetNumberAsDouble() : otherwise;
}

int Fields::integer(const char* key, int otherwise) const
{
    const tinygltf::Value* const value = find(key);
    if (!value || !value->IsNumber()) return otherwise;
    const double number = value->GetNumberAsDouble();
    return number >= -1.0 && number <= 2147483647.0 ? static_cast<int>(number) : -1;
}

std::size_t Fields::size(const char* key, std::size_t otherwise) const
{
    const tinygltf::Value* const value = find(key);
    if (!value || !value->IsNumber()) return otherwise;
    const double number = value->GetNumberAsDouble();
    if (!(number >= 0.0 && number < 9007199254740992.0) || number != std::floor(number))
        throw Error(fmt::format("{} is no size: {}", key, number), "write the file again");
    return static_cast<std::size_t>(number);
}

std::string Fields::text(const char* key) const
{
    const tinygltf::Value* const value = find(key);
    return value && value->IsString() ? value->Get<std::string>() : std::string();
}

std::vector<double> Fields::numbers(const char* key) const
{
    std::vector<double> out;
    const tinygltf::Value* const value = find(key);
    if (!value || !value->IsArray()) return out;
    for (std::size_t i = 0; i < value->ArrayLen(); ++i) {
        const tinygltf::Value& item = value->Get(static_cast<int>(i));
        out.push_back(item.IsNumber() ? item.GetNumberAsDouble() : 0.0);
    }
    return out;
}

} // namespace snell::gltf

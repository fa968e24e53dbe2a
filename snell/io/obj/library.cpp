#include "snell/io/obj/library.h"

#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/image/read.h"
#include "snell/io/obj/bump.h"
#include "snell/io/stand_in.h"
#include "snell/io/text_cursor.h"
#include "snell/io/text_encoding.h"

#include <algorithm>

namespace fs = std::filesystem;

namespace snell::obj {
namespace {

// The first word of a line, and what follows it.
std::pair<std::string_view, std::string_view> split_keyword(std::string_view line)
{
    line = trim(line);
    std::size_t length = 0;
    while (length < line.size() && !is_space(line[length])) ++length;
    return {line.substr(0, length), trim(line.substr(length))};
}

// Calls use(line, number) for each line, numbers from 1, whatever its end.
template <class Use>
void for_each_line(std::string_view text, const Use& use)
{
    for (int number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        use(text.substr(0, end), number);
        text.remove_prefix(std::min(text.size(), end + (text.substr(end).starts_with("\r\n") ? 2 : 1)));
    }
}

std::string lower(std::string text)
{
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

} // namespace

MaterialLibrary::MaterialLibrary(Scene& scene, const fs::path& obj_file, bool sandbox)
    : scene_(scene), folder_(obj_file.parent_path()), references_(obj_file, sandbox, scene), sandbox_(sandbox)
{
}

void MaterialLibrary::warn(std::string text)
{
    note(scene_, Note::Kind::warning, std::move(text));
}

// The file that a name in an OBJ or MTL file means: relative to the OBJ file's folder, with Windows' separators and
// letter case forgiven; a path from somebody else's disk may have its last part here. Empty if there is none.
fs::path MaterialLibrary::locate(const std::string& name, const std::string& place)
{
    std::string path = name;
    if (path.size() >= 2 && path.front() == '"' && path.back() == '"') path = path.substr(1, path.size() - 2);
    std::replace(path.begin(), path.end(), '\\', '/');
    const std::string last = path.substr(path.rfind('/') + 1);
    if (last.empty() || path.find('\0') != std::string::npos) return {};

    std::error_code error;
    // Whether it leads elsewhere matters where there is something; in a sandbox nobody looks.
    if (sandbox_ || fs::is_regular_file(folder_ / path, error)) {
        fs::path file = references_.resolve(path, place + ": ");
        if (fs::is_regular_file(file, error)) return file;
    }
    if (fs::path file = folder_ / last; fs::is_regular_file(file, error)) return file;

    // Part by part, each as it is written or else in other letters.
    for (const fs::path& wanted : {fs::path(path), fs::path(last)}) {
        fs::path found = folder_;
        for (const fs::path& part : wanted) {
            if (fs::path exact = found / part; fs::exists(exact, error)) {
                found = std::move(exact);
                continue;
            }
            const auto& names = names_in(found);
            const auto entry = names.find(lower(part.string()));
            if (entry == names.end()) break;
            found /= entry->second;
        }
        if (lower(found.filename().string()) == lower(last) && fs::is_regular_file(found, error)) return found;
    }
    return {};
}

// The names in a folder by their lower-case form; read once.
const std::unordered_map<std::string, std::string>& MaterialLibrary::names_in(const fs::path& folder)
{
    const auto [entry, is_new] = folders_.try_emplace(folder.string());
    if (!is_new) return entry->second;
    std::error_code error;
    for (fs::directory_iterator item(folder.empty() ? "." : folder, error), end; !error && item != end;
         item.increment(error)) {
        const std::string name = item->path().filename().string();
        entry->second.emplace(lower(name), name);
    }
    return entry->second;
}

void MaterialLibrary::load(std::string_view names, const std::string& place)
{
    if (!asked_.emplace(names).second) return;
    if (const fs::path whole = locate(std::string(names), place); !whole.empty()) {
        load_file(whole);
        return;
    }
    std::string missing;
    for (auto [name, rest] = split_keyword(names); !name.empty(); std::tie(name, rest) = split_keyword(rest)) {
        const fs::path file = locate(std::string(name), place);
        if (!file.empty())
            load_file(file);
        else if (loaded_.insert(fs::path(name)).second)
            missing += (missing.empty() ? "" : ", ") + show_word(name);
    }
    if (missing.empty()) return;
    misses_library_ = true;
    warn(fmt::format("{}: the material library {} is not there; its materials become grey", place, missing));
}

void MaterialLibrary::load_file(const fs::path& file)
{
    std::error_code error;
    const fs::path canonical = fs::weakly_canonical(file, error);
    if (!loaded_.insert(error ? file : canonical).second) return;

    const std::string text = to_utf8(read_file(file));
    MtlMaterial ignored; // what stands before the first newmtl, or in a second material of one name
    MtlMaterial* material = &ignored;
    for_each_line(text, [&](std::string_view line, int number) {
        const auto [keyword, rest] = split_keyword(line);
        if (keyword == "newmtl") {
            const auto [entry, is_new] = materials_.try_emplace(std::string(rest));
            material = is_new ? &entry->second : &ignored;
            if (!is_new) return;
            material->name = rest;
            material->file = file.string();
            material->line = number;
        } else if (material != &ignored) {
            const std::string wrong = read_statement(line, number, *material);
            // Once for each keyword of a file: a tool that writes one line wrongly writes them all so.
            if (!wrong.empty() && wrong_.insert({file.string(), std::string(keyword)}).second)
                warn(fmt::format("{}:{}: {}", file.string(), number, wrong));
        }
    });
}

Index<MaterialDesc> MaterialLibrary::find(const std::string& name, const std::string& obj_file)
{
    const auto found = materials_.find(name);
    if (found == materials_.end()) {
        // Missing libraries have been noted; one note more for each of their materials would bury the rest.
        if (!name.empty() && !misses_library_)
            warn(fmt::format("{}: no library has the material {}; it becomes grey", obj_file, show_word(name)));
        MaterialDesc grey;
        grey.name = name.empty() ? "default" : name;
        return add(scene_, grey);
    }
    const MtlMaterial& m = found->second;
    MaterialDesc material = to_material(m);
    add_textures(m, material);
    note_unused(m, material);
    return add(scene_, std::move(material));
}

void MaterialLibrary::add_textures(const MtlMaterial& m, MaterialDesc& material)
{
    const bool is_clear = material.kind == material_dielectric || material.kind == material_mirror;
    if (!is_clear) material.base_texture = texture(m, "map_Kd", Use::color);
    if (material.emission != vec3(0.0f)) material.emission_texture = texture(m, "map_Ke", Use::color);
    if (!is_clear && m.has_map("map_d")) {
        material.opacity_texture = texture(m, "map_d", Use::number);
        if (material.opacity_texture.valid()) {
            material.coverage = coverage_blend;
            // A picture with an alpha channel means that one, unless it says otherwise.
            const Image& image = scene_.images[material.opacity_texture.image.value];
            if (m.map("map_d")->channel == 0 && has_alpha(image)) material.opacity_texture.channel = 3;
        } else if (material.opacity < 1.0f) {
            material.coverage = coverage_blend;
        }
    }
    const char* const normal = m.has_map("norm") ? "norm" : "map_bump";
    if (m.has_map(normal)) {
        material.normal_texture = texture(m, normal, Use::normal);
        material.normal_scale = m.map(normal)->strength;
    }
    if (material.kind != material_principled) return;
    PrincipledDesc& p = material.principled;
    p.roughness_texture = texture(m, "map_Pr", Use::number);
    p.metallic_texture = texture(m, "map_Pm", Use::number);
    p.sheen_color_texture = texture(m, "map_Ps", Use::number);
    p.clearcoat_texture = texture(m, "map_Pc", Use::number);
    p.clearcoat_roughness_texture = texture(m, "map_Pcr", Use::number);
}

void MaterialLibrary::note_unused(const MtlMaterial& m, const MaterialDesc& material)
{
    const std::string place = fmt::format("{}:{}", m.file, m.line);
    const bool is_glass = material.kind == material_dielectric;
    if (is_glass && m.number("d", 1.0f - m.number("Tr", 0)) < 1.0f && material.ior <= 1.0f)
        warn(fmt::format("{}: {} is partly transparent (d {:.3g}); it is taken as clear, tinted", place,
                         show_word(m.name), m.number("d", 1.0f - m.number("Tr", 0))));
    if (is_glass && m.has_map("map_Kd"))
        warn(fmt::format("{}: {} is transparent; its texture is not used", place, show_word(m.name)));

    std::string maps;
    for (const auto& [keyword, map] : m.maps) {
        if (!noted_options_ && !map.ignored.empty()) {
            noted_options_ = true;
            note(scene_, Note::Kind::info,
                 fmt::format("{}:{}: the option {} of textures is not used", m.file, map.line, map.ignored));
        }
        bool is_used = false;
        for (const char* used : {"map_Kd", "map_Ka", "map_Ke", "map_d", "map_bump", "norm"})
            is_used = is_used || keyword == used;
        for (const char* used : {"map_Pr", "map_Pm", "map_Ps", "map_Pc", "map_Pcr"})
            is_used = is_used || (keyword == used && material.kind == material_principled);
        if (!is_used) maps += (maps.empty() ? "" : ", ") + keyword.substr(0, 40);
    }
    if (!maps.empty() && !noted_maps_) {
        noted_maps_ = true;
        note(scene_, Note::Kind::info,
             fmt::format("{}: maps that are not used: {} has {}", place, show_word(m.name), maps));
    }
}

TextureRef MaterialLibrary::texture(const MtlMaterial& m, const char* keyword, Use use)
{
    TextureRef ref;
    const MtlMap* const map = m.map(keyword);
    if (!map) return ref;
    ref.image = image(m, *map, use);
    if (!ref.valid()) return ref;
    if (map->clamps) ref.wrap_u = ref.wrap_v = wrap_clamp;
    ref.row_u = vec3(map->scale.x, 0, map->offset.x);
    ref.row_v = vec3(0, map->scale.y, map->offset.y);
    // Luminance is what grey pictures have in every channel.
    const std::string_view channels = "rgbm";
    const std::size_t channel = channels.find(map->channel);
    if (channel != std::string_view::npos) ref.channel = static_cast<uint>(channel);
    return ref;
}

Index<Image> MaterialLibrary::image(const MtlMaterial& m, const MtlMap& map, Use use)
{
    constexpr const char* uses[] = {"color", "number", "normal"};
    const auto [entry, is_new] = images_.try_emplace({map.file, uses[static_cast<int>(use)]}, Index<Image>{});
    if (!is_new) return entry->second;

    Image image;
    const std::string place = fmt::format("{}:{}", m.file, map.line);
    const fs::path file = locate(map.file, place); // outside the try: what the sandbox refuses is refused
    try {
        if (file.empty())
            throw Error(Place{m.file, map.line, 0}, fmt::format("the texture {} is not there", show_word(map.file)));
        image = read_texture(file, use == Use::color);
        if (use == Use::normal && is_height_map(image)) {
            note(scene_, Note::Kind::info,
                 fmt::format("{}: {} is a height map; it is turned into a normal map", place, show_word(map.file)));
            image = normal_map(image);
        }
    } catch (const Error& error) {
        const bool is_first = missing_.insert(map.file).second;
        if (is_first)
            warn(fmt::format("{}; {}", error.what(),
                             use == Use::color ? "a magenta checkerboard stands in for it" : "it is left out"));
        if (use != Use::color) return {};
        image = checkerboard(map.file);
    }
    return entry->second = add(scene_, std::move(image));
}

} // namespace snell::obj

#include "snell/io/obj/material.h"

#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/image/read.h"
#include "snell/io/text_cursor.h"

#include <tiny_obj_loader.h>

#include <cmath>
#include <sstream>

namespace fs = std::filesystem;

namespace snell::obj {
namespace {

vec3 to_vec3(const float (&v)[3])
{
    return vec3(v[0], v[1], v[2]);
}

bool is_reflecting(int illum)
{
    return illum == 3 || illum == 5 || illum == 8;
}

bool is_glass(int illum)
{
    return illum == 4 || illum == 6 || illum == 7 || illum == 9;
}

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

// 8 x 8 squares that nobody takes for the real thing.
Image checkerboard(const std::string& name)
{
    Image image;
    image.name = name;
    image.width = image.height = 8;
    for (uint y = 0; y < 8; ++y)
        for (uint x = 0; x < 8; ++x) {
            const std::uint8_t on = (x + y) % 2 == 0 ? 255 : 0;
            image.bytes.insert(image.bytes.end(), {on, 0, on, 255});
        }
    return image;
}

} // namespace

MaterialDesc to_material(const tinyobj::material_t& m, const Statements& has)
{
    const vec3 none(0.0f), all(1.0f);
    MaterialDesc out;
    out.name = m.name;
    out.emission = max(to_vec3(m.emission), none);

    vec3 diffuse = clamp(to_vec3(m.diffuse), none, all);
    const bool has_map = !m.diffuse_texname.empty();
    if (has_map && (!has.contains("Kd") || is_black(diffuse)))
        diffuse = all;
    else if (!has.contains("Kd"))
        diffuse = vec3(is_black(out.emission) ? 0.8f : 0.0f);
    vec3 specular = clamp(to_vec3(m.specular), none, all);
    const float roughness = clamp(m.roughness, 0.0f, 1.0f);

    const float opacity = clamp(m.dissolve, 0.0f, 1.0f);
    if (is_glass(m.illum) || opacity < 1.0f) {
        const vec3 filter = max(to_vec3(m.transmittance), none);
        vec3 tint = max3(filter) > 0.0f ? filter / max3(filter) : all;
        if (!is_glass(m.illum)) tint *= mix(all, diffuse, opacity);
        out.kind = material_dielectric;
        out.base_color = sqrt(tint);
        out.ior = m.ior > 0.0f ? m.ior : 1.0f;
        if (is_glass(m.illum) && !(m.ior > 1.0f)) out.ior = 1.5f;
        return out;
    }
    if (m.metallic > 0.0f) {
        const float metallic = min(m.metallic, 1.0f);
        if (is_black(specular)) specular = vec3(0.04f);
        out.kind = material_mix;
        out.base_color = (1.0f - metallic) * diffuse;
        out.texture_tints_specular = true;
        out.specular = mix(specular, diffuse, metallic);
        out.alpha = roughness * roughness;
    } else if (is_reflecting(m.illum) && max3(specular) > 0.0f && max3(diffuse) < 0.1f * max3(specular)) {
        out.kind = material_mirror;
        out.base_color = specular;
        return out;
    } else if (max3(specular) > 0.0f && m.illum != 1) {
        out.kind = material_mix;
        out.base_color = diffuse;
        out.specular = specular;
        if (is_reflecting(m.illum))
            out.alpha = 0.0f;
        else if (has.contains("Pr"))
            out.alpha = roughness * roughness;
        else
            out.alpha = std::sqrt(2.0f / (max(m.shininess, 0.0f) + 2.0f));
    } else {
        out.base_color = diffuse;
    }
    const float sum = max3(out.base_color + out.specular);
    if (sum > 1.0f) out.base_color /= sum, out.specular /= sum;
    return out;
}

void MaterialLibrary::warn(std::string text)
{
    note(scene_, Note::Kind::warning, std::move(text));
}

// The file that a name in an OBJ or MTL file means: relative to the OBJ file's folder, with Windows' separators and
// letter case forgiven; a path from somebody else's disk may have its last part here. Empty if there is none.
fs::path MaterialLibrary::locate(const std::string& name)
{
    std::string path = name;
    if (path.size() >= 2 && path.front() == '"' && path.back() == '"') path = path.substr(1, path.size() - 2);
    std::replace(path.begin(), path.end(), '\\', '/');
    const std::string last = path.substr(path.rfind('/') + 1);
    if (last.empty() || path.find('\0') != std::string::npos) return {};

    std::error_code error;
    for (const fs::path& candidate : {folder_ / path, folder_ / last})
        if (fs::is_regular_file(candidate, error)) return candidate;

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
    if (const fs::path whole = locate(std::string(names)); !whole.empty()) {
        load_file(whole);
        return;
    }
    std::string missing;
    for (auto [name, rest] = split_keyword(names); !name.empty(); std::tie(name, rest) = split_keyword(rest)) {
        const fs::path file = locate(std::string(name));
        if (!file.empty())
            load_file(file);
        else if (loaded_.insert(fs::path(name)).second)
            missing += (missing.empty() ? "" : ", ") + show_word(name);
    }
    if (missing.empty()) return;
    misses_library_ = true;
    warn(fmt::format("{}: the material library {} is not there; its materials become grey", place, missing));
}

bool MaterialLibrary::load_file(const fs::path& file)
{
    std::error_code error;
    const fs::path canonical = fs::weakly_canonical(file, error);
    if (!loaded_.insert(error ? file : canonical).second) return false;

    const std::string text = read_file(file);
    Source* source = nullptr;
    for_each_line(text, [&](std::string_view line, int number) {
        const auto [keyword, rest] = split_keyword(line);
        if (keyword == "newmtl") {
            // The first of two materials of one name counts.
            const auto [entry, is_new] = sources_.try_emplace(std::string(rest));
            source = is_new ? &entry->second : nullptr;
            if (is_new) *source = {file.string(), number, ""};
        } else if (source) {
            source->text.append(line).push_back('\n');
        }
    });
    return true;
}

// The statements as tinyobjloader reads them rightly: it takes a damaged number for 0, `Kd 0.5` for red, and
// `d -halo 0.5` for invisible. Names those that are left in `has`.
std::string MaterialLibrary::sanitize(const Source& source, Statements& has)
{
    std::string out;
    for_each_line(source.text, [&](std::string_view line, int number) {
        auto [keyword, rest] = split_keyword(line);
        if (keyword.empty() || keyword.front() == '#') return;
        std::size_t wanted = 0;
        for (const std::string_view color : {"Ka", "Kd", "Ks", "Ke", "Kt", "Tf"})
            if (keyword == color) wanted = 3;
        for (const std::string_view scalar : {"Ns", "Ni", "d", "Tr", "Pr", "Pm", "illum"})
            if (keyword == scalar) wanted = 1;
        if (wanted == 0) {
            has.emplace(keyword);
            out.append(line).push_back('\n');
            return;
        }
        if (rest.starts_with("-halo")) rest.remove_prefix(5);
        std::vector<float> numbers;
        const char* p = rest.data();
        const char* const end = p + rest.size();
        for (float value; numbers.size() < wanted; numbers.push_back(value)) {
            while (p < end && is_space(*p)) ++p;
            if (!read_float(p, end, value) || !std::isfinite(value) || (p < end && !is_space(*p))) break;
        }
        if (wanted == 3 && numbers.size() == 1 && trim({p, static_cast<std::size_t>(end - p)}).empty())
            numbers.resize(3, numbers[0]);
        if (numbers.size() < wanted) {
            warn(fmt::format("{}:{}: '{}' wants {} number{}, but there is {}; the line is ignored", source.file,
                             source.line + number, keyword, wanted, wanted == 1 ? "" : "s", show_word(rest)));
            return;
        }
        has.emplace(keyword);
        constexpr float huge = 1e9f; // more means nothing, and tinyobjloader converts illum by atoi
        out += keyword;
        for (const float value : numbers) out += fmt::format(" {:.9g}", clamp(value, -huge, huge));
        out += '\n';
    });
    return out;
}

Index<MaterialDesc> MaterialLibrary::find(const std::string& name, const std::string& obj_file)
{
    const auto found = sources_.find(name);
    if (found == sources_.end()) {
        // Missing libraries have been noted; one note more for each of their materials would bury the rest.
        if (!name.empty() && !misses_library_)
            warn(fmt::format("{}: no library has the material {}; it becomes grey", obj_file, show_word(name)));
        MaterialDesc grey;
        grey.name = name.empty() ? "default" : name;
        return add(scene_, grey);
    }
    const Source& source = found->second;

    Statements has;
    std::istringstream stream("newmtl material\n" + sanitize(source, has));
    std::map<std::string, int> numbers;
    std::vector<tinyobj::material_t> materials;
    std::string warnings, errors;
    tinyobj::LoadMtl(&numbers, &materials, &stream, &warnings, &errors);
    tinyobj::material_t& m = materials.at(0);
    m.name = name;

    MaterialDesc material = to_material(m, has);
    const std::string place = fmt::format("{}:{}", source.file, source.line);
    if (material.kind == material_dielectric && !is_glass(m.illum))
        warn(fmt::format("{}: {} is partly transparent (d {:.3g}); it is taken as clear, tinted", place,
                         show_word(name), m.dissolve));
    if (!m.diffuse_texname.empty() && material.kind == material_dielectric)
        warn(fmt::format("{}: {} is transparent; its texture is not used", place, show_word(name)));
    const bool is_textured = material.kind == material_diffuse || material.kind == material_mix;
    if (!m.diffuse_texname.empty() && is_textured) {
        const tinyobj::texture_option_t& o = m.diffuse_texopt;
        material.base_texture = texture(m.diffuse_texname, o.clamp, source);
        if (o.scale[0] != 1 || o.scale[1] != 1 || o.origin_offset[0] != 0 || o.origin_offset[1] != 0)
            warn(fmt::format("{}: {} scales or moves its texture, which is not supported yet", place, show_word(name)));
    }
    if (!noted_maps_) {
        std::string maps;
        for (const std::string& statement : has)
            if ((statement.starts_with("map_") && statement != "map_Kd" && statement != "map_Ka") ||
                statement == "bump" || statement == "norm" || statement == "disp" || statement == "refl")
                maps += (maps.empty() ? "" : ", ") + statement;
        if (!maps.empty()) {
            noted_maps_ = true;
            note(scene_, Note::Kind::info,
                 fmt::format("{}: of the maps only map_Kd is used; {} has {}, too", place, show_word(name), maps));
        }
    }
    return add(scene_, material);
}

Index<Image> MaterialLibrary::texture(std::string name, bool clamps, const Source& source)
{
    name = std::string(trim(name));
    const auto known = textures_.find({name, clamps});
    if (known != textures_.end()) return known->second;

    Image image;
    const fs::path file = locate(name);
    try {
        if (file.empty())
            throw Error(Place{source.file, source.line, 0},
                        fmt::format("the texture {} is not there", show_word(name)));
        image = read_texture(file, true);
    } catch (const Error& error) {
        warn(fmt::format("{}; a magenta checkerboard stands in for it", error.what()));
        image = checkerboard(name);
    }
    if (clamps) image.wrap = wrap_clamp;
    const Index<Image> index = add(scene_, std::move(image));
    textures_[{name, clamps}] = index;
    return index;
}

} // namespace snell::obj

#include "snell/io/gltf/document.h"

#include "snell/io/file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace snell::gltf {
namespace {

using nlohmann::json;

// Every level of nesting costs the readers stack, and no scene needs as many.
constexpr int most_levels = 128;

std::uint32_t word_at(std::string_view bytes, std::size_t at)
{
    std::uint32_t word;
    std::memcpy(&word, bytes.data() + at, 4);
    return word;
}

// The JSON chunk of a GLB; its binary chunk goes to the document.
std::string_view open_container(Document& document)
{
    const std::string_view bytes = document.bytes;
    const std::string file = document.file.string();
    const auto fail = [&](const std::string& what) { throw Error({file}, what, "write the file again"); };
    if (bytes.size() < 20) fail("the GLB file is cut off in its header");
    const std::uint32_t version = word_at(bytes, 4);
    if (version != 2)
        throw Error({file}, fmt::format("a GLB file of version {}; only 2 is read", version), "convert it to glTF 2.0");
    const std::size_t length = word_at(bytes, 8);
    if (length > bytes.size())
        fail(fmt::format("the GLB file is cut off: it should have {} bytes and has {}", length, bytes.size()));

    std::string_view text;
    std::size_t at = 12;
    for (int chunk = 0; at + 8 <= length; ++chunk) {
        const std::size_t size = word_at(bytes, at);
        const std::uint32_t kind = word_at(bytes, at + 4);
        if (size > length - at - 8) fail(fmt::format("chunk {} of the GLB file ends after its end", chunk));
        const std::string_view body = bytes.substr(at + 8, size);
        constexpr std::uint32_t json_kind = 0x4e4f534a, binary_kind = 0x004e4942;
        if (chunk == 0 && kind != json_kind) fail("the first chunk of the GLB file is not JSON");
        if (chunk == 0) text = body;
        if (chunk == 1 && kind == binary_kind) document.has_binary = true, document.binary = body;
        at += 8 + size + (4 - size % 4) % 4;
    }
    return text;
}

// Where in the text a byte is.
Place place_of(const Document& document, std::string_view text, std::size_t byte)
{
    const std::string_view before = text.substr(0, std::min(byte, text.size()));
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t begin = before.rfind('\n') + 1; // 0 if there is none
    return {document.file.string(), static_cast<int>(line), static_cast<int>(before.size() - begin + 1)};
}

// Refuses what is nested too deep, before anything is built of it.
void check_levels(const Document& document, std::string_view text)
{
    int level = 0;
    bool is_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (is_string) {
            if (c == '\\') ++i;
            if (c == '"') is_string = false;
        } else if (c == '"') {
            is_string = true;
        } else if (c == '[' || c == '{') {
            if (++level > most_levels)
                throw Error(place_of(document, text, i), fmt::format("nested more than {} levels deep", most_levels),
                            "no scene needs that, write the file again");
        } else if (c == ']' || c == '}') {
            --level;
        }
    }
}

json parse(const Document& document, std::string_view text)
{
    check_levels(document, text);
    try {
        json root = json::parse(text.begin(), text.end());
        if (!root.is_object()) throw Error(place_of(document, text, 0), "the JSON is no object", "is this glTF?");
        return root;
    } catch (const json::parse_error& error) {
        // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error ...": only what it is.
        std::string what = error.what();
        const std::size_t colon = what.find(": ");
        if (colon != std::string::npos) what = what.substr(colon + 2);
        throw Error(place_of(document, text, error.byte == 0 ? 0 : error.byte - 1), "not good JSON: " + what,
                    "the file is broken or cut off, write it again");
    } catch (const json::exception& error) {
        throw Error({document.file.string()}, fmt::format("not good JSON: {}", error.what()), "write the file again");
    }
}

// Leaves `extras` out, which nobody reads and which cost memory. Integers beyond 32 bits, which would be cut to some
// other number, become floating point.
void simplify(json& value)
{
    if (value.is_object()) {
        value.erase("extras");
        for (auto& member : value) simplify(member);
    } else if (value.is_array()) {
        for (auto& item : value) simplify(item);
    } else if (value.is_number_integer()) {
        const double number = value.get<double>();
        if (number < -2147483648.0 || number > 2147483647.0) value = number;
    }
}

std::string text_of(const json& object, const char* key)
{
    const auto it = object.find(key);
    return it != object.end() && it->is_string() ? it->get<std::string>() : std::string();
}

// The array of that name, or null.
json* array_of(json& object, const char* key)
{
    if (!object.is_object()) return nullptr;
    const auto it = object.find(key);
    return it != object.end() && it->is_array() ? &*it : nullptr;
}

// A count or offset that is there must be a whole number; some writers put it down as 12.0.
std::size_t check_size(json& object, const char* key, const std::string& who)
{
    const auto it = object.find(key);
    if (it == object.end()) return 0;
    const double number = it->is_number() ? it->get<double>() : -1.0;
    constexpr double most = 9007199254740992.0; // 2^53
    if (!(number >= 0.0 && number < most) || number != std::floor(number))
        throw Error(
            fmt::format("{}: {} is no size: {}", who, key, it->dump(-1, ' ', true, json::error_handler_t::replace)),
            "write the file again");
    *it = static_cast<std::uint64_t>(number);
    return static_cast<std::size_t>(number);
}

void check_sizes(json& root, const char* array, const char* what, std::initializer_list<const char*> keys)
{
    json* const all = array_of(root, array);
    if (!all) return;
    for (std::size_t i = 0; i < all->size(); ++i) {
        json& item = (*all)[i];
        if (!item.is_object()) continue; // tinygltf refuses it
        for (const char* key : keys) check_size(item, key, label(what, i, text_of(item, "name")));
    }
}

// tinygltf takes these offsets for 0 where they are no 32-bit integers.
void check_sparse(json& root)
{
    json* const accessors = array_of(root, "accessors");
    if (!accessors) return;
    for (std::size_t i = 0; i < accessors->size(); ++i) {
        json& accessor = (*accessors)[i];
        if (!accessor.is_object() || !accessor.contains("sparse")) continue;
        json& sparse = accessor["sparse"];
        const std::string who = label("accessor", i, text_of(accessor, "name"));
        for (const char* part : {"indices", "values"}) {
            if (!sparse.is_object() || !sparse.contains(part) || !sparse[part].is_object())
                throw Error(fmt::format("{}: its sparse part has no {}", who, part), "write the file again");
            if (check_size(sparse[part], "byteOffset", who) > 0x7fffffff)
                throw Error(fmt::format("{}: sparse data more than 2 GiB into a view", who), "use more buffer views");
        }
    }
}

// Buffers and images are taken out: tinygltf would read and copy them.
void take_sources(Document& document, json& root)
{
    if (json* const buffers = array_of(root, "buffers")) {
        for (std::size_t i = 0; i < buffers->size(); ++i) {
            json& item = (*buffers)[i];
            BufferSource source;
            if (item.is_object()) {
                source.name = text_of(item, "name");
                source.size = check_size(item, "byteLength", label("buffer", i, source.name));
                if (item.contains("uri") && item["uri"].is_string())
                    source.uri = std::move(item["uri"].get_ref<std::string&>());
            }
            document.buffers.push_back(std::move(source));
        }
    }
    if (json* const images = array_of(root, "images")) {
        for (json& item : *images) {
            ImageSource source;
            if (item.is_object()) {
                source.name = text_of(item, "name");
                source.mime = text_of(item, "mimeType");
                if (item.contains("bufferView") && item["bufferView"].is_number_integer())
                    source.view = item["bufferView"].get<int>();
                if (item.contains("uri") && item["uri"].is_string())
                    source.uri = std::move(item["uri"].get_ref<std::string&>());
            }
            document.images.push_back(std::move(source));
        }
    }
    root.erase("buffers");
    root.erase("images");
}

// tinygltf refuses a primitive whose index accessor has no buffer view, as Draco's have none.
void hide_empty_indices(json& root)
{
    const json* const accessors = array_of(root, "accessors");
    json* const meshes = array_of(root, "meshes");
    if (!meshes) return;
    for (json& mesh : *meshes) {
        json* const primitives = array_of(mesh, "primitives");
        if (!primitives) continue;
        for (json& primitive : *primitives) {
            if (!primitive.is_object() || !primitive.contains("extensions")) continue;
            const json& extensions = primitive["extensions"];
            if (!extensions.is_object() || !extensions.contains("KHR_draco_mesh_compression")) continue;
            const auto indices = primitive.find("indices");
            if (indices == primitive.end() || !indices->is_number_unsigned() || !accessors) continue;
            const std::size_t index = indices->get<std::size_t>();
            if (index >= accessors->size()) continue;
            const json& accessor = (*accessors)[index];
            if (accessor.is_object() && !accessor.contains("bufferView")) primitive.erase(indices);
        }
    }
}

// What tinygltf would drop without a word that a user sees.
void drop_pointer_channels(json& root, Remarks& remarks)
{
    json* const animations = array_of(root, "animations");
    if (!animations) return;
    for (std::size_t i = 0; i < animations->size(); ++i) {
        json* const channels = array_of((*animations)[i], "channels");
        if (!channels) continue;
        std::erase_if(channels->get_ref<json::array_t&>(), [&](const json& channel) {
            const auto has_node = [&] {
                if (!channel.is_object() || !channel.contains("target")) return false;
                const json& target = channel["target"];
                return target.is_object() && target.contains("node") && target["node"].is_number_integer() &&
                       target.contains("path") && target["path"].is_string() && channel.contains("sampler");
            };
            if (has_node()) return false;
            remarks.warn("channel", fmt::format("{}: a channel that moves no node is ignored",
                                                label("animation", i, text_of((*animations)[i], "name"))));
            return true;
        });
    }
}

void check_version(const Document& document, const json& root)
{
    const auto asset = root.find("asset");
    const std::string version = asset != root.end() && asset->is_object() ? text_of(*asset, "version") : "";
    const std::string least = asset != root.end() && asset->is_object() ? text_of(*asset, "minVersion") : "";
    const std::string file = document.file.string();
    if (version.empty()) throw Error({file}, "there is no asset.version: not a glTF file", "give a glTF 2.0 file");
    if (!version.starts_with("2."))
        throw Error({file}, fmt::format("glTF of version {}; only 2.0 is read", version), "convert it to glTF 2.0");
    if (!least.empty() && least != "2.0")
        throw Error({file}, fmt::format("needs a reader of glTF {}", least), "export it as glTF 2.0");
}

} // namespace

std::string label(const char* what, std::size_t number, const std::string& name)
{
    return name.empty() ? fmt::format("{} {}", what, number) : fmt::format("{} {} '{}'", what, number, name);
}

void read_document(Document& document, const std::filesystem::path& file, Remarks& remarks)
{
    document.file = file;
    document.bytes = read_file(file);
    std::string_view text = document.bytes;
    if (text.starts_with("glTF")) text = open_container(document);
    std::string core;
    {
        json root = parse(document, text);
        check_version(document, root);
        simplify(root);
        take_sources(document, root);
        hide_empty_indices(root);
        drop_pointer_channels(root, remarks);
        check_sparse(root);
        check_sizes(root, "bufferViews", "buffer view", {"byteOffset", "byteLength", "byteStride"});
        check_sizes(root, "accessors", "accessor", {"byteOffset", "count"});
        core = root.dump(-1, ' ', false, json::error_handler_t::replace);
    }
    if (core.size() > std::numeric_limits<unsigned>::max())
        throw Error({file.string()}, "the JSON has more than 4 GB", "keep the geometry in a buffer");

    tinygltf::TinyGLTF reader;
    std::string errors, warnings;
    bool is_good = false;
    try {
        is_good = reader.LoadASCIIFromString(&document.model, &errors, &warnings, core.data(),
                                             static_cast<unsigned>(core.size()), "");
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        errors = error.what();
    }
    std::replace(errors.begin(), errors.end(), '\n', ' ');
    while (errors.ends_with(' ')) errors.pop_back();
    if (!is_good) throw Error({file.string()}, errors.empty() ? "not good glTF" : errors, "write the file again");
    // That matrices are missing from a skin is no mistake, though tinygltf says so.
    constexpr std::string_view no_mistake = "'inverseBindMatrices' property is missing in Skin.";
    for (std::size_t at; (at = errors.find(no_mistake)) != std::string::npos;) errors.erase(at, no_mistake.size());
    if (errors.find_first_not_of(' ') != std::string::npos) remarks.warn("structure", errors);
}

} // namespace snell::gltf

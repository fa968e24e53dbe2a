#include "snell/io/ply/ply.h"

#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/image/read.h"
#include "snell/io/ply/body.h"
#include "snell/io/progress.h"
#include "snell/io/reference.h"
#include "snell/io/stand_in.h"

namespace snell {
namespace {

using namespace ply;

Header read_whole_header(ByteWindow& window)
{
    for (;;) {
        if (std::optional<Header> header = read_header(window.name(), window.view(), window.at_end())) {
            window.take(header->body);
            check_counts(window.name(), *header, window.most_left());
            return std::move(*header);
        }
        window.more();
    }
}

template <class Reader>
Mesh read_body(ByteWindow& window, const Header& header, const std::function<void(double)>& progress, Rest& rest)
{
    const auto tell = [&] {
        if (window.disk_size() > 0)
            progress(static_cast<double>(window.disk_done()) / static_cast<double>(window.disk_size()));
    };
    Body<Reader> body(header, Reader(window, header.lines + 1), tell, header.textures.size());
    Mesh mesh = body.read(rest);
    tell();
    return mesh;
}

void say(Scene& scene, const std::string& name, const Rest& rest)
{
    if (!rest.unused.empty()) note(scene, Note::Kind::info, fmt::format("{}: not used: {}", name, rest.unused));
    if (rest.degenerate > 0)
        note(scene, Note::Kind::warning,
             fmt::format("{}: {} faces have less than three vertices and are dropped", name, rest.degenerate));
    if (rest.leftover)
        note(scene, Note::Kind::warning, fmt::format("{}: there is more in the file than its header announces", name));
}

Index<Image> read_image(Scene& scene, References& references, const std::string& texture, const std::string& name)
{
    const std::filesystem::path file = references.resolve(texture, name + ": ");
    try {
        return add(scene, read_texture(file, true));
    } catch (const Error& error) {
        note(scene, Note::Kind::warning, fmt::format("{}; a magenta checkerboard stands in for it", error.what()));
        return add(scene, checkerboard(texture));
    }
}

// One material for each texture that the header names, or a single one.
void add_materials(Scene& scene, Mesh& mesh, const Header& header, const Rest& rest, const std::filesystem::path& file,
                   bool sandbox)
{
    MaterialDesc material;
    material.name = "default";
    if (!mesh.colors.empty()) material.base_color = vec3(1.0f); // the vertices' colours multiply it
    if (header.textures.empty() || mesh.uvs.empty()) {
        mesh.material = add(scene, material);
        return;
    }
    material.base_color = vec3(1.0f);
    References references(file, sandbox, scene);
    const std::size_t used = rest.triangle_textures.empty() ? 1 : header.textures.size();
    for (std::size_t i = 0; i < used; ++i) {
        material.name = header.textures[i];
        material.base_texture.image = read_image(scene, references, header.textures[i], file.string());
        const Index<MaterialDesc> index = add(scene, material);
        if (i == 0) mesh.material = index;
    }
    for (const uint texture : rest.triangle_textures)
        mesh.triangle_materials.push_back({mesh.material.value + texture});
}

} // namespace

Scene load_ply(const std::filesystem::path& file, const LoadOptions& options)
{
    ByteWindow window(file);
    const std::string& name = window.name();
    const Header header = read_whole_header(window);
    const std::function<void(double)> progress = reading_progress(options, file);

    Scene scene;
    scene.name = inner_stem(file);
    Mesh mesh;
    Rest rest;
    switch (header.format) {
    case Format::ascii:
        mesh = read_body<AsciiReader>(window, header, progress, rest);
        break;
    case Format::little_endian:
        mesh = read_body<BinaryReader<false>>(window, header, progress, rest);
        break;
    case Format::big_endian:
        mesh = read_body<BinaryReader<true>>(window, header, progress, rest);
        break;
    }
    if (mesh.triangles.empty())
        throw Error({name},
                    mesh.positions.empty() ? "contains no vertices"
                                           : fmt::format("contains {} points, but no faces", mesh.positions.size()),
                    "choose a file with a surface in it");
    say(scene, name, rest);
    mesh.name = scene.name;
    add_materials(scene, mesh, header, rest, file, options.sandbox);
    place(scene, std::move(mesh));
    return scene;
}

} // namespace snell
